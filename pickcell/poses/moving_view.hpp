#pragma once
/// The view of a camera whose place follows from a hand-eye calibration, at the moment of exposure.

#include <optional>

#include "pickcell/core/result.hpp"
#include "pickcell/core/transform.hpp"
#include "pickcell/poses/calibration.hpp"
#include "pickcell/poses/locate.hpp"

namespace pickcell::poses {

/// On the arm: T_base_camera = T_base_flange * T_flange_camera with the arm's pose at mid-exposure (Frame). Beside it:
/// as calibrated; the arm's pose is not needed. The position's sigma is the calibration's error on the plane.
/// T_base_plane: the work plane. Errors: negative, when the camera is on the arm and the arm's pose is not known.
[[nodiscard]] core::Result<View> view_at_exposure(
    const CameraCalibration& camera, const HandeyeCalibration& handeye,
    const core::Transform<core::Base, core::Plane>& T_base_plane,
    const std::optional<core::Transform<core::Base, core::Flange>>& T_base_flange);

}  // namespace pickcell::poses
