#pragma once
/// UVC and other cameras of Video4Linux.

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "pickcell/core/result.hpp"
#include "pickcell/frames/camera_device.hpp"
#include "pickcell/frames/camera_list.hpp"
#include "pickcell/frames/camera_settings.hpp"

namespace pickcell::frames {

/// /dev/video* that capture pictures.
[[nodiscard]] std::vector<ListedCamera> find_v4l2_cameras();

/// path: /dev/videoN. Settings: exposure_us, gain, fps, pixel_format (GREY, YUYV, MJPG, ...), roi_px = 0,0,w,h for the
/// size, and the camera's controls by name (`info --features`). Errors: device (not there, no right, no camera, another
/// program streams from it); usage (a setting that it does not have).
[[nodiscard]] core::Result<std::unique_ptr<CameraDevice>> connect_v4l2(const std::string& path,
                                                                       const CameraSettings& settings);

/// Every control with its value.
[[nodiscard]] core::Result<std::vector<std::pair<std::string, std::string>>> v4l2_controls(const std::string& path);

}  // namespace pickcell::frames
