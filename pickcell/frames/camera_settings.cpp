#include "pickcell/frames/camera_settings.hpp"

#include <charconv>
#include <cmath>
#include <cstdint>

#include "pickcell/core/config.hpp"

namespace pickcell::frames {

using core::ErrorCode;
using core::failure;

namespace {

/// The whole text as a number; unset otherwise.
template <class T>
std::optional<T> number(std::string_view text) {
  T value{};
  const auto [end, problem] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (problem != std::errc() || end != text.data() + text.size() || text.empty()) return std::nullopt;
  return value;
}

std::optional<bool> boolean(std::string_view text) {
  if (text == "true" || text == "1" || text == "on") return true;
  if (text == "false" || text == "0" || text == "off") return false;
  return std::nullopt;
}

std::optional<std::array<int, 4>> rectangle(std::string_view text) {
  std::array<int, 4> out{};
  for (std::size_t i = 0; i < 4; ++i) {
    const std::size_t comma = i < 3 ? text.find(',') : text.size();
    const auto v = comma == std::string_view::npos ? std::nullopt : number<int>(text.substr(0, comma));
    if (!v || *v < (i < 2 ? 0 : 1)) return std::nullopt;
    out[i] = *v;
    text.remove_prefix(std::min(comma + 1, text.size()));
  }
  return out;
}

core::Status bad(std::string_view key, std::string_view value, const char* wanted) {
  return failure(ErrorCode::usage, std::string(key) + "=" + std::string(value), "is no value for this setting",
                 std::string("give ") + wanted);
}

core::Status set_number(std::optional<double>& to, std::string_view key, std::string_view value, double least) {
  const auto v = number<double>(value);
  if (!v || !std::isfinite(*v) || *v < least) return bad(key, value, least > 0 ? "a number above 0" : "a number");
  to = v;
  return {};
}

core::Status set_whole(std::optional<int>& to, std::string_view key, std::string_view value, int least, int most) {
  const auto v = number<int>(value);
  if (!v || *v < least || *v > most)
    return bad(key, value, ("a whole number from " + std::to_string(least) + " to " + std::to_string(most)).c_str());
  to = v;
  return {};
}

core::Status set_boolean(bool& to, std::string_view key, std::string_view value) {
  const auto v = boolean(value);
  if (!v) return bad(key, value, "true or false");
  to = *v;
  return {};
}

}  // namespace

core::Status set(CameraSettings& s, std::string_view key, std::string_view value) {
  if (key.empty()) return failure(ErrorCode::usage, "=" + std::string(value), "has no key", "give KEY=VALUE");
  if (key == "exposure_us") return set_number(s.exposure_us, key, value, 1e-3);
  if (key == "gain") return set_number(s.gain, key, value, -1e9);
  if (key == "fps") return set_number(s.fps, key, value, 1e-3);
  if (key == "readout_us") return set_number(s.readout_us, key, value, -1e9);
  if (key == "binning") return set_whole(s.binning, key, value, 1, 16);
  if (key == "packet_bytes") return set_whole(s.packet_bytes, key, value, 220, 16404);
  if (key == "packet_delay_us") return set_whole(s.packet_delay_us, key, value, 0, 1'000'000);
  if (key == "socket_kib") return set_whole(s.socket_kib, key, value, 16, 1 << 20);
  if (key == "resend") return set_boolean(s.resend, key, value);
  if (key == "packet_socket") return set_boolean(s.packet_socket, key, value);
  if (key == "roi_px") {
    s.roi_px = rectangle(value);
    return s.roi_px ? core::Status{} : bad(key, value, "x,y,w,h");
  }
  if (key == "pixel_format" || key == "trigger" || key == "chunks") {
    if (value.empty()) return bad(key, value, "a name");
    (key == "pixel_format" ? s.pixel_format : key == "trigger" ? s.trigger : s.chunks) = value;
    return {};
  }
  s.features.emplace_back(key, value);
  return {};
}

std::string remedy_for_unknown(std::string_view key) {
  const std::string near =
      core::nearest(key, {"exposure_us", "gain", "fps", "readout_us", "binning", "packet_bytes", "packet_delay_us",
                          "socket_kib", "resend", "packet_socket", "roi_px", "pixel_format", "trigger", "chunks"});
  return near.empty() ? "`pickcell camera info SOURCE --features` lists them" : "did you mean '" + near + "'?";
}

core::Result<CameraSettings> parse_camera_settings(const std::vector<std::string>& words) {
  CameraSettings out;
  for (const std::string& word : words) {
    const std::size_t equals = word.find('=');
    if (equals == std::string::npos)
      return failure(ErrorCode::usage, word, "is no setting", "give KEY=VALUE, for example exposure_us=5000");
    if (auto done = set(out, std::string_view(word).substr(0, equals), std::string_view(word).substr(equals + 1));
        !done)
      return core::forward(done);
  }
  return out;
}

}  // namespace pickcell::frames
