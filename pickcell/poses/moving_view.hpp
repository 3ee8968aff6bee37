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

/// The work plane of a cell that has a hand-eye calibration: level at plane_z_m in the base frame where that is given,
/// with x and y of the base frame; else where the board lay (camera on the arm). Errors: unreadable: nothing says where
/// the plane is, or the board did not lie level.
[[nodiscard]] core::Result<core::Transform<core::Base, core::Plane>> work_plane(const HandeyeCalibration& handeye,
                                                                                std::optional<double> plane_z_m);

}  // namespace pickcell::poses
