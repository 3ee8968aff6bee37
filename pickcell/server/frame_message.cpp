#include "pickcell/server/frame_message.hpp"

#include <cstring>
#include <stdexcept>

namespace pickcell::server {

namespace {

template <class T>
void put(std::vector<std::byte>& out, std::size_t at, T value) {
  for (std::size_t i = 0; i < sizeof(T); ++i)
    out[at + i] = static_cast<std::byte>((static_cast<std::uint64_t>(value) >> (8 * i)) & 0xFF);
}

void require(bool holds, const char* what) {
  if (!holds) throw std::invalid_argument(what);
}

}  // namespace

std::vector<std::byte> encode_frame_message(const FrameHeader& header, std::string_view overlay_json,
                                            std::span<const std::byte> jpeg) {
  require(header.width_px >= 1 && header.width_px <= kMaxShownSidePx, "frame message: width outside 1..16384");
  require(header.height_px >= 1 && header.height_px <= kMaxShownSidePx, "frame message: height outside 1..16384");
  require(header.scale_permille >= 1 && header.scale_permille <= 0xFFFF, "frame message: scale outside 0.001..65.535");
  require(overlay_json.size() <= kMaxOverlayBytes, "frame message: overlay larger than 1 MiB");
  std::vector<std::byte> out(kFrameHeaderBytes + overlay_json.size() + jpeg.size());
  put(out, 0, kFrameMagic);
  put(out, 4, kFrameVersion);
  put(out, 5, static_cast<std::uint8_t>(header.kind));
  put(out, 6, header.camera);
  put(out, 8, header.frame_id);
  put(out, 12, static_cast<std::uint32_t>(overlay_json.size()));
  put(out, 16, header.exposed_unix_us);
  put(out, 24, static_cast<std::uint16_t>(header.width_px));
  put(out, 26, static_cast<std::uint16_t>(header.height_px));
  put(out, 28, static_cast<std::uint16_t>(header.scale_permille));
  put(out, 30, header.flags);
  std::memcpy(out.data() + kFrameHeaderBytes, overlay_json.data(), overlay_json.size());
  if (!jpeg.empty()) std::memcpy(out.data() + kFrameHeaderBytes + overlay_json.size(), jpeg.data(), jpeg.size());
  return out;
}

}  // namespace pickcell::server
