#pragma once
/// How a real camera is to be set: `--set KEY=VALUE` of `pickcell camera` and the table [camera.settings] of CELL.toml.

#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "pickcell/core/result.hpp"

namespace pickcell::frames {

/// What is unset stays as the camera has it.
struct CameraSettings {
  std::optional<double> exposure_us;
  std::optional<double> gain;                ///< dB, or the camera's own number where it has no other
  std::optional<double> fps;                 ///< of free running
  std::string pixel_format;                  ///< PFNC name ("Mono8"), for V4L2 "GREY", "YUYV", "MJPG"
  std::optional<std::array<int, 4>> roi_px;  ///< x, y, w, h on the sensor
  std::optional<int> binning;                ///< both directions
  std::string trigger = "off";               ///< "off": free running; "software"; else the name of an input line
  std::optional<int> packet_bytes;  ///< of GigE Vision; unset: the largest that gets through, or the camera's own
  std::optional<int> packet_delay_us;
  std::optional<int> socket_kib;  ///< receive buffer; unset: four frames
  bool resend = true;             ///< ask for lost packets again, where the camera can
  bool packet_socket = false;     ///< read frames past the network stack; needs CAP_NET_RAW
  std::string chunks;             ///< chunk data to switch on, names with commas between: "ExposureTime,EncoderValue"
  std::optional<double> readout_us;  ///< from the end of exposure until the frame begins to leave the camera
  std::vector<std::pair<std::string, std::string>> features;  ///< every other key, in order: the camera's own names

  [[nodiscard]] bool free_running() const { return trigger == "off"; }
  [[nodiscard]] bool software_triggered() const { return trigger == "software"; }
};

/// Notes one KEY and its value. Keys that are none of the above become features. Errors: usage (a value that is none
/// for its key, an empty key).
[[nodiscard]] core::Status set(CameraSettings& settings, std::string_view key, std::string_view value);

/// "did you mean '...'?" for a key that is neither a setting nor a feature, or what else to do.
[[nodiscard]] std::string remedy_for_unknown(std::string_view key);

/// From `KEY=VALUE` words.
[[nodiscard]] core::Result<CameraSettings> parse_camera_settings(const std::vector<std::string>& words);

}  // namespace pickcell::frames
