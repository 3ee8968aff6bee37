#include "pickcell/robot/hses_frame_codec.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <stdexcept>
#include <string>
#include <string_view>

namespace pickcell::robot {

namespace {

constexpr std::array<std::uint8_t, 4> kIdentifier = {'Y', 'E', 'R', 'C'};
constexpr std::uint8_t kReserved = 3, kFiller = '9', kAnswerBit = 0x80;

void begin(HsesWriter& out, std::size_t payload, HsesDivision division, bool ack, std::uint8_t id,
           std::uint32_t block) {
  if (payload > kHsesMostPayload) throw std::invalid_argument("HSES: more than 479 bytes after the header");
  out.bytes(kIdentifier).u16(kHsesHeaderBytes).u16(static_cast<std::uint16_t>(payload)).u8(kReserved);
  out.u8(static_cast<std::uint8_t>(division)).u8(ack ? 1 : 0).u8(id).u32(block);
  for (int i = 0; i < 8; ++i) out.u8(kFiller);
}

bool is_service(std::uint8_t v) {
  switch (static_cast<HsesService>(v)) {
    case HsesService::get_all:
    case HsesService::set_all:
    case HsesService::file_delete:
    case HsesService::get_one:
    case HsesService::set_one:
    case HsesService::file_load:
    case HsesService::file_save:
    case HsesService::file_list:
    case HsesService::read_plural:
    case HsesService::write_plural:
      return true;
  }
  return false;
}

auto malformed(std::string why) {
  return core::failure(core::ErrorCode::link, "HSES answer", std::move(why),
                       "check that the address is a controller's High Speed Ethernet Server");
}

bool begins_like_one(HsesView datagram) {
  return datagram.size() >= kHsesHeaderBytes && std::equal(kIdentifier.begin(), kIdentifier.end(), datagram.begin());
}

}  // namespace

HsesBytes hses_bytes(const HsesRequest& r) {
  HsesWriter out;
  begin(out, r.payload.size(), r.division, r.ack, r.id, r.block);
  out.u16(r.command).u16(r.instance).u8(r.attribute).u8(static_cast<std::uint8_t>(r.service)).u16(0).bytes(r.payload);
  return out.take();
}

HsesBytes hses_bytes(const HsesAnswer& a) {
  HsesWriter out;
  begin(out, a.payload.size(), a.division, true, a.id, a.block);
  out.u8(static_cast<std::uint8_t>(static_cast<std::uint8_t>(a.service) | kAnswerBit)).u8(a.status);
  out.u8(a.added_status != 0 ? 1 : 0).u8(0).u16(a.added_status).u16(0).bytes(a.payload);
  return out.take();
}

core::Result<HsesAnswer> parse_hses_answer(HsesView datagram) {
  if (!begins_like_one(datagram)) return malformed("a datagram of " + std::to_string(datagram.size()) + " bytes");
  HsesReader in(datagram.subspan(kIdentifier.size()));
  if (in.u16() != kHsesHeaderBytes) return malformed("wrong header size");
  const std::size_t payload = in.u16();
  if (payload > kHsesMostPayload || payload != datagram.size() - kHsesHeaderBytes)
    return malformed("says " + std::to_string(payload) + " bytes of data, has " +
                     std::to_string(datagram.size() - kHsesHeaderBytes));
  HsesAnswer a;
  (void)in.u8();
  const std::uint8_t division = in.u8(), ack = in.u8();
  if (division != 1 && division != 2) return malformed("wrong division");
  a.division = static_cast<HsesDivision>(division);
  if (ack != 1) return malformed("is no answer (ACK 0)");
  a.id = in.u8();
  a.block = in.u32();
  (void)in.u32(), (void)in.u32();
  const std::uint8_t service = in.u8();
  if ((service & kAnswerBit) == 0 || !is_service(static_cast<std::uint8_t>(service & ~kAnswerBit)))
    return malformed("is no answer (service)");
  a.service = static_cast<HsesService>(service & ~kAnswerBit);
  a.status = in.u8();
  const std::uint8_t added_words = in.u8();
  (void)in.u8();
  const std::uint16_t added = in.u16();
  if (added_words > 0) a.added_status = added;
  (void)in.u16();
  a.payload.assign(in.rest().begin(), in.rest().end());
  return a;
}

tl::expected<HsesRequest, HsesBadRequest> parse_hses_request(HsesView datagram) {
  if (!begins_like_one(datagram)) return tl::unexpected(HsesBadRequest{});
  const auto bad = [&](std::uint16_t added) {
    return tl::unexpected(HsesBadRequest{added, datagram[11], datagram[29]});
  };
  HsesReader in(datagram.subspan(kIdentifier.size()));
  if (in.u16() != kHsesHeaderBytes) return bad(kHsesBadHeaderSize);
  const std::size_t payload = in.u16();
  if (payload != datagram.size() - kHsesHeaderBytes) return bad(kHsesSizesDiffer);
  if (payload > kHsesMostPayload) return bad(kHsesTooLong);
  HsesRequest r;
  (void)in.u8();  // said to be 3; one client sends 0x33 to a real controller and is answered
  const std::uint8_t division = in.u8(), ack = in.u8();
  if (division != 1 && division != 2) return bad(kHsesBadDivision);
  r.division = static_cast<HsesDivision>(division);
  if (ack > 1) return bad(kHsesBadAck);
  r.ack = ack == 1;
  r.id = in.u8();
  r.block = in.u32();
  (void)in.u32(), (void)in.u32();
  r.command = in.u16();
  r.instance = in.u16();
  r.attribute = in.u8();
  r.service = static_cast<HsesService>(in.u8());  // one that is none is refused by the command
  (void)in.u16();
  r.payload.assign(in.rest().begin(), in.rest().end());
  return r;
}

HsesWriter& HsesWriter::u8(std::uint8_t v) {
  bytes_.push_back(v);
  return *this;
}

HsesWriter& HsesWriter::u16(std::uint16_t v) {
  return u8(static_cast<std::uint8_t>(v & 0xFF)).u8(static_cast<std::uint8_t>(v >> 8));
}

HsesWriter& HsesWriter::u32(std::uint32_t v) {
  return u16(static_cast<std::uint16_t>(v & 0xFFFF)).u16(static_cast<std::uint16_t>(v >> 16));
}

HsesWriter& HsesWriter::f32(float v) { return u32(std::bit_cast<std::uint32_t>(v)); }

HsesWriter& HsesWriter::text(std::string_view text, std::size_t size) {
  for (std::size_t i = 0; i < size; ++i) u8(i < text.size() ? static_cast<std::uint8_t>(text[i]) : std::uint8_t{0});
  return *this;
}

HsesWriter& HsesWriter::bytes(HsesView more) {
  bytes_.insert(bytes_.end(), more.begin(), more.end());
  return *this;
}

HsesView HsesReader::take(std::size_t size) {
  if (left_.size() < size) {
    good_ = false;
    left_ = {};
    return {};
  }
  const HsesView taken = left_.first(size);
  left_ = left_.subspan(size);
  return taken;
}

std::uint8_t HsesReader::u8() {
  const HsesView b = take(1);
  return b.empty() ? std::uint8_t{0} : b[0];
}

std::uint16_t HsesReader::u16() {
  const HsesView b = take(2);
  return b.empty() ? std::uint16_t{0} : static_cast<std::uint16_t>(b[0] | b[1] << 8);
}

std::uint32_t HsesReader::u32() {
  const HsesView b = take(4);
  if (b.empty()) return 0;
  return std::uint32_t{b[0]} | std::uint32_t{b[1]} << 8 | std::uint32_t{b[2]} << 16 | std::uint32_t{b[3]} << 24;
}

float HsesReader::f32() { return std::bit_cast<float>(u32()); }

std::string HsesReader::text(std::size_t size) {
  const HsesView b = take(size);
  std::string out(b.begin(), std::find(b.begin(), b.end(), std::uint8_t{0}));
  while (out.ends_with(' ')) out.pop_back();
  return out;
}

}  // namespace pickcell::robot
