#pragma once
/// One exposure of one camera.

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "pickcell/core/clock.hpp"
#include "pickcell/core/transform.hpp"
#include "pickcell/frames/camera_id.hpp"
#include "pickcell/image/image.hpp"

namespace pickcell::frames {

/// How the camera was set when it exposed. What the camera does not tell is unset.
struct ExposureSettings {
  std::optional<double> exposure_us;
  std::optional<double> gain;  ///< dB, or the camera's own number where it has no other
  std::string pixel_format;    ///< as it came over the wire: "Mono8", "BayerRG8", "YUYV", ...
  int offset_x_px = 0;         ///< of the picture's corner on the sensor
  int offset_y_px = 0;
};

/// The picture with everything that belonged to it at mid-exposure. Cheap to copy; the pixels are shared and never
/// changed.
struct Frame {
  std::shared_ptr<const image::Image> picture;
  std::uint64_t sequence = 0;                        ///< counts exposures of the source from 1; gaps mean lost frames
  core::TimePoint exposed{};                         ///< mid-exposure, on the cell's clock
  std::int64_t exposed_unix_us = 0;                  ///< the same as wall time
  std::optional<std::int64_t> device_ns;             ///< the camera's own time stamp, on its own clock
  std::shared_ptr<const ExposureSettings> settings;  ///< null for pictures that no camera took
  std::optional<std::int64_t> encoder;               ///< belt encoder count at mid-exposure, where there is one
  std::optional<core::Transform<core::Base, core::Flange>> T_base_flange;  ///< for a camera on the arm
  CameraId camera_id;
  bool simulated = false;
};

}  // namespace pickcell::frames
