#pragma once
/// GigE Vision and USB3 Vision cameras, through Aravis.

#include <string>
#include <vector>

#include "pickcell/core/result.hpp"
#include "pickcell/frames/camera_device.hpp"
#include "pickcell/frames/camera_list.hpp"
#include "pickcell/frames/camera_settings.hpp"

namespace pickcell::frames {

/// Cameras on every network interface and USB port. Takes about half a second.
[[nodiscard]] std::vector<ListedCamera> find_aravis_cameras();

/// name: address or host name, serial number, name given by the user, MAC, or vendor-model-serial; empty: the only
/// camera there is. Errors: device: nobody answers there (within about a second), several or none match, another
/// program holds it, a setting that the camera refuses; usage: a setting that it does not have.
[[nodiscard]] core::Result<std::unique_ptr<CameraDevice>> connect_aravis(const std::string& name,
                                                                         const CameraSettings& settings);

/// The camera's features by name, as "NAME = VALUE [unit]", in the order of its categories. Of a camera that nobody
/// else holds.
[[nodiscard]] core::Result<std::vector<std::pair<std::string, std::string>>> aravis_features(const std::string& name);

}  // namespace pickcell::frames
