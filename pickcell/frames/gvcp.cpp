#include "pickcell/frames/gvcp.hpp"

#include <cstdio>

namespace pickcell::frames::gvcp {

namespace {

constexpr std::byte kKey{0x42};
constexpr std::byte kWantsAnswer{0x01};
constexpr std::uint16_t kDiscovery = 0x0002, kReadRegister = 0x0080;
constexpr std::size_t kHeader = 8;
constexpr std::size_t kDiscoveryData = 0xf8;

void put16(std::byte* at, std::uint32_t v) {
  at[0] = static_cast<std::byte>(v >> 8);
  at[1] = static_cast<std::byte>(v);
}
void put32(std::byte* at, std::uint32_t v) {
  put16(at, v >> 16);
  put16(at + 2, v);
}
std::uint32_t get16(std::span<const std::byte> d, std::size_t at) {
  return static_cast<std::uint32_t>(d[at]) << 8 | static_cast<std::uint32_t>(d[at + 1]);
}
std::uint32_t get32(std::span<const std::byte> d, std::size_t at) { return get16(d, at) << 16 | get16(d, at + 2); }

void put_header(std::byte* at, std::uint16_t command, std::uint16_t length, std::uint16_t id) {
  at[0] = kKey;
  at[1] = kWantsAnswer;
  put16(at + 2, command);
  put16(at + 4, length);
  put16(at + 6, id);
}

/// Header: status, command + 1, length of what follows, id.
bool answers(std::span<const std::byte> d, std::uint16_t command, std::uint16_t id, std::size_t length) {
  return d.size() >= kHeader + length && get16(d, 2) == command + 1U && get16(d, 4) >= length && get16(d, 6) == id;
}

std::string text(std::span<const std::byte> d, std::size_t at, std::size_t size) {
  std::string out;
  for (std::size_t i = 0; i < size; ++i) {
    const auto c = static_cast<unsigned char>(d[at + i]);
    if (c == 0) break;
    out += c < 0x20 || c > 0x7e ? '?' : static_cast<char>(c);
  }
  return out;
}

}  // namespace

std::array<std::byte, 12> read_register(std::uint32_t address, std::uint16_t request_id) {
  std::array<std::byte, 12> out{};
  put_header(out.data(), kReadRegister, 4, request_id);
  put32(out.data() + kHeader, address);
  return out;
}

std::array<std::byte, 8> discovery(std::uint16_t request_id) {
  std::array<std::byte, 8> out{};
  put_header(out.data(), kDiscovery, 0, request_id);
  return out;
}

std::optional<RegisterAnswer> parse_register(std::span<const std::byte> d, std::uint16_t request_id) {
  if (d.size() >= kHeader && get16(d, 0) != 0 && answers(d, kReadRegister, request_id, 0))
    return RegisterAnswer{static_cast<std::uint16_t>(get16(d, 0)), 0};
  if (!answers(d, kReadRegister, request_id, 4)) return std::nullopt;
  return RegisterAnswer{0, get32(d, kHeader)};
}

std::optional<Identity> parse_discovery(std::span<const std::byte> datagram, std::uint16_t request_id) {
  if (!answers(datagram, kDiscovery, request_id, kDiscoveryData) || get16(datagram, 0) != 0) return std::nullopt;
  const auto d = datagram.subspan(kHeader);
  Identity out;
  char mac[20];
  std::snprintf(mac, sizeof mac, "%02x:%02x:%02x:%02x:%02x:%02x", static_cast<unsigned>(d[10]),
                static_cast<unsigned>(d[11]), static_cast<unsigned>(d[12]), static_cast<unsigned>(d[13]),
                static_cast<unsigned>(d[14]), static_cast<unsigned>(d[15]));
  out.mac = mac;
  out.address = get32(d, 0x24);
  out.vendor = text(d, 0x48, 32);
  out.model = text(d, 0x68, 32);
  out.version = text(d, 0x88, 32);
  out.serial = text(d, 0xd8, 16);
  out.user_name = text(d, 0xe8, 16);
  if (out.serial.empty()) out.serial = out.mac;
  return out;
}

std::string dotted(std::uint32_t a) {
  char out[16];
  std::snprintf(out, sizeof out, "%u.%u.%u.%u", a >> 24, a >> 16 & 255, a >> 8 & 255, a & 255);
  return out;
}

}  // namespace pickcell::frames::gvcp
