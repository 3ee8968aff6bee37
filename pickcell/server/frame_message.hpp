#pragma once
/// One picture with its overlay as one binary WebSocket message, so that they can only be dropped together.
/// Layout (docs/hmi.md section 5), little-endian:
///   0 u32 'VMF1'  4 u8 version 1  5 u8 kind  6 u16 camera  8 u32 frame_id  12 u32 json_len  16 u64 t_us (mid-exposure,
///   UNIX)
///  24 u16 w  26 u16 h  28 u16 scale_pm (display px per sensor px, thousandths)  30 u16 flags  32 overlay JSON, then
///  JPEG

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

namespace pickcell::server {

enum class FrameKind : std::uint8_t { live = 1, still = 2, calibration = 3, thumbnail = 4 };

constexpr std::uint32_t kFrameMagic = 0x31464D56;  ///< "VMF1" as bytes
constexpr std::uint8_t kFrameVersion = 1;
constexpr std::size_t kFrameHeaderBytes = 32;
constexpr std::size_t kMaxOverlayBytes = std::size_t{1} << 20;
constexpr int kMaxShownSidePx = 16384;
constexpr std::uint16_t kFlagSimulated = 1;
constexpr std::uint16_t kFlagOverlayPending = 2;

struct FrameHeader {
  FrameKind kind = FrameKind::live;
  std::uint16_t camera = 0;
  std::uint32_t frame_id = 0;
  std::uint64_t exposed_unix_us = 0;
  int width_px = 0;  ///< of the JPEG
  int height_px = 0;
  int scale_permille = 1000;  ///< display pixels per sensor pixel, thousandths
  std::uint16_t flags = 0;
};

/// Throws std::invalid_argument when a side is not 1..16384, the scale does not fit 16 bits or the overlay exceeds 1
/// MiB.
[[nodiscard]] std::vector<std::byte> encode_frame_message(const FrameHeader& header, std::string_view overlay_json,
                                                          std::span<const std::byte> jpeg);

}  // namespace pickcell::server
