#include "pickcell/sim/hses_element_commands.hpp"

#include <algorithm>
#include <utility>
#include <variant>

#include "pickcell/sim/hses_commands.hpp"
#include "pickcell/sim/hses_elements.hpp"

namespace pickcell::sim {

namespace {

using hses_elements::Refused;
using robot::HsesAnswer;
using robot::HsesBytes;
using robot::HsesReader;
using robot::HsesRequest;
using robot::HsesService;
using robot::HsesWriter;

constexpr Refused kAnswerTooLarge = 0xA100;

HsesAnswer read_many(const ControllerState& s, const HsesRequest& r, std::uint16_t one, std::uint32_t count) {
  if (r.payload.size() != 4) return hses_refusal(r, hses_elements::kBadLength);
  HsesWriter out;
  out.u32(count);
  for (std::uint32_t i = 0; i < count; ++i) {
    const auto value = hses_elements::read(s, one, static_cast<int>(r.instance + i));
    if (const auto* refused = std::get_if<Refused>(&value)) return hses_refusal(r, *refused);
    out.bytes(std::get<HsesBytes>(value));
  }
  return hses_done(r, out.take());
}

/// All or nothing: tried on a copy first.
HsesAnswer write_many(ControllerState& s, const HsesRequest& r, std::uint16_t one, std::uint32_t count) {
  const std::size_t size = robot::hses_element_bytes(r.command);
  if (r.payload.size() != 4 + count * size) return hses_refusal(r, hses_elements::kBadLength);
  ControllerState changed = s;
  for (std::uint32_t i = 0; i < count; ++i) {
    const robot::HsesView bytes = robot::HsesView(r.payload).subspan(4 + i * size, size);
    const Refused refused = hses_elements::write(changed, one, static_cast<int>(r.instance + i), bytes);
    if (refused != 0) return hses_refusal(r, refused);
  }
  s = std::move(changed);
  return hses_done(r);
}

}  // namespace

HsesAnswer hses_element_command(ControllerState& s, const HsesRequest& r) {
  const bool words = r.command >= robot::kHsesP && r.command <= robot::kHsesEx;
  const std::uint8_t most = r.command == robot::kHsesP ? 13 : words ? 9 : 1;
  if ((!reads(r) && !writes(r)) || r.attribute > most) return hses_refusal(r, hses_elements::kBadAttribute);
  const bool one_word = words && r.attribute > 0;
  if (writes(r) && !one_word) return settle(r, hses_elements::write(s, r.command, r.instance, r.payload));
  const auto value = hses_elements::read(s, r.command, r.instance);
  if (const auto* refused = std::get_if<Refused>(&value)) return hses_refusal(r, *refused);
  HsesBytes bytes = std::get<HsesBytes>(value);
  if (!one_word) return hses_done(r, std::move(bytes));
  const auto at = bytes.begin() + 4 * (r.attribute - 1);
  if (reads(r)) return hses_done(r, HsesBytes(at, at + 4));
  if (r.payload.size() != 4) return hses_refusal(r, hses_elements::kBadLength);
  std::copy(r.payload.begin(), r.payload.end(), at);
  return settle(r, hses_elements::write(s, r.command, r.instance, bytes));
}

HsesAnswer hses_plural_command(ControllerState& s, const HsesRequest& r) {
  const std::uint16_t one = hses_elements::element_of(r.command);
  const bool reading = r.service == HsesService::read_plural;
  if (one == 0) return hses_refusal(r, hses_elements::kBadCommand);
  if ((!reading && r.service != HsesService::write_plural) || r.attribute != 0)
    return hses_refusal(r, hses_elements::kBadAttribute);
  if (r.payload.size() < 4) return hses_refusal(r, hses_elements::kBadLength);
  const std::uint32_t count = HsesReader(r.payload).u32();
  const bool in_twos = r.command == robot::kHsesPluralIo || r.command == robot::kHsesPluralB;
  if (count > robot::hses_most_elements(r.command)) return hses_refusal(r, kAnswerTooLarge);
  if (count == 0 || (in_twos && count % 2 != 0)) return hses_refusal(r, hses_elements::kBadValue);
  return reading ? read_many(s, r, one, count) : write_many(s, r, one, count);
}

}  // namespace pickcell::sim
