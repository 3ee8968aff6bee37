#pragma once
/// A small reader of capture files for tests: the TCP payloads of an Ethernet capture in pcapng, little-endian blocks.

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace pickcell {

struct CapturedSegment {
  double time_s = 0;  ///< since the first packet
  int from_port = 0, to_port = 0;
  std::string payload;
};

/// Segments with a payload, in the order of the file. What is no TCP over IPv4 is left out; a damaged file ends the
/// list.
inline std::vector<CapturedSegment> tcp_segments(std::string_view file) {
  const auto little = [&](std::size_t at, int bytes) {
    std::uint64_t v = 0;
    for (int i = 0; i < bytes; ++i) v |= static_cast<std::uint64_t>(static_cast<std::uint8_t>(file[at + i])) << 8 * i;
    return v;
  };
  const auto big16 = [](std::string_view p, std::size_t at) {
    return static_cast<std::uint8_t>(p[at]) << 8 | static_cast<std::uint8_t>(p[at + 1]);
  };
  std::vector<CapturedSegment> out;
  double first_s = -1;
  for (std::size_t at = 0; at + 12 <= file.size();) {
    const std::uint64_t type = little(at, 4), length = little(at + 4, 4);
    if (length < 12 || at + length > file.size()) break;
    constexpr std::uint64_t kEnhancedPacket = 6;
    if (type == kEnhancedPacket && length >= 32) {
      const std::uint64_t captured = little(at + 20, 4);
      if (28 + captured > length) break;
      const double t_s = 1e-6 * static_cast<double>(little(at + 12, 4) << 32 | little(at + 16, 4));
      if (first_s < 0) first_s = t_s;
      const std::string_view packet = file.substr(at + 28, captured);
      if (packet.size() >= 54 && big16(packet, 12) == 0x0800 && packet[23] == 6) {
        const std::string_view ip = packet.substr(14);
        const std::size_t header = static_cast<std::size_t>(ip[0] & 15) * 4;
        const std::string_view tcp = ip.substr(header, static_cast<std::size_t>(big16(ip, 2)) - header);
        const std::size_t offset = static_cast<std::size_t>(static_cast<std::uint8_t>(tcp[12]) >> 4) * 4;
        if (tcp.size() > offset)
          out.push_back({t_s - first_s, big16(tcp, 0), big16(tcp, 2), std::string(tcp.substr(offset))});
      }
    }
    at += length;
  }
  return out;
}

}  // namespace pickcell
