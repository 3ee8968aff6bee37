#include "pickcell/robot/hses_variable_codec.hpp"

#include <algorithm>
#include <stdexcept>
#include <utility>

namespace pickcell::robot {

namespace {

auto malformed(const std::string& what, HsesView payload) {
  return core::failure(core::ErrorCode::link, "answer to " + what,
                       "not understood: " + std::to_string(payload.size()) + " bytes",
                       "check that the address is a controller's High Speed Ethernet Server");
}

struct Plural {
  std::uint16_t command;
  std::size_t element_bytes;
  std::uint32_t most;
  std::uint32_t step;  ///< counts are multiples of it
};
constexpr std::array<Plural, 10> kPlurals = {{{kHsesPluralIo, 1, 474, 2},
                                              {kHsesPluralRegister, 2, 237, 1},
                                              {kHsesPluralB, 1, 474, 2},
                                              {kHsesPluralI, 2, 237, 1},
                                              {kHsesPluralD, 4, 118, 1},
                                              {kHsesPluralR, 4, 118, 1},
                                              {kHsesPluralS, 16, 29, 1},
                                              {kHsesPluralP, 52, 9, 1},
                                              {kHsesPluralBp, 36, 13, 1},
                                              {kHsesPluralEx, 36, 13, 1}}};

const Plural* plural(std::uint16_t command) {
  const auto* found =
      std::find_if(kPlurals.begin(), kPlurals.end(), [&](const Plural& p) { return p.command == command; });
  return found == kPlurals.end() ? nullptr : found;
}

void check_plural(std::uint16_t command, std::uint32_t count) {
  const Plural* p = plural(command);
  if (!p || count == 0 || count > p->most || count % p->step != 0)
    throw std::invalid_argument("HSES: not a count for this plural command");
}

HsesRequest plural_request(std::uint16_t command, std::uint16_t first, HsesService service, HsesBytes payload) {
  HsesRequest r;
  r.command = command;
  r.instance = first;
  r.service = service;
  r.payload = std::move(payload);
  return r;
}

}  // namespace

HsesRequest hses_read_plural(std::uint16_t command, std::uint16_t first, std::uint32_t count) {
  check_plural(command, count);
  return plural_request(command, first, HsesService::read_plural, HsesWriter().u32(count).take());
}

HsesRequest hses_write_plural(std::uint16_t command, std::uint16_t first, std::uint32_t count, HsesBytes elements) {
  check_plural(command, count);
  if (elements.size() != count * hses_element_bytes(command))
    throw std::invalid_argument("HSES: elements and their count differ");
  return plural_request(command, first, HsesService::write_plural, HsesWriter().u32(count).bytes(elements).take());
}

std::size_t hses_element_bytes(std::uint16_t plural_command) {
  const Plural* p = plural(plural_command);
  return p ? p->element_bytes : 0;
}

std::uint32_t hses_most_elements(std::uint16_t plural_command) {
  const Plural* p = plural(plural_command);
  return p ? p->most : 0;
}

core::Result<HsesBytes> parse_hses_plural(HsesView payload, std::uint16_t plural_command, std::uint32_t count) {
  const std::size_t element = hses_element_bytes(plural_command);
  if (element == 0 || payload.size() < 4 || count > kHsesMostPayload) return malformed("plural read", payload);
  HsesReader in(payload);
  if (in.u32() != count || in.rest().size() != count * element) return malformed("plural read", payload);
  return HsesBytes(in.rest().begin(), in.rest().end());
}

core::Result<HsesAxesPosition> parse_hses_axes_position(HsesView payload) {
  if (payload.size() != kHsesAxesPositionBytes) return malformed("base or station position", payload);
  HsesReader in(payload);
  HsesAxesPosition p;
  p.type = in.u32();
  for (std::int32_t& axis : p.axes) axis = in.i32();
  return p;
}

HsesBytes hses_payload(const HsesAxesPosition& p) {
  HsesWriter out;
  out.u32(p.type);
  for (const std::int32_t axis : p.axes) out.i32(axis);
  return out.take();
}

core::Result<std::string> parse_hses_string(HsesView payload) {
  if (payload.size() != kHsesShortString && payload.size() != kHsesLongString) return malformed("string", payload);
  return HsesReader(payload).text(payload.size());
}

HsesBytes hses_string(std::string_view text, std::size_t size) {
  if (text.size() > size) throw std::invalid_argument("HSES: a string is longer than its variable");
  return HsesWriter().text(text, size).take();
}

}  // namespace pickcell::robot
