#include "pickcell/poses/moving_view.hpp"

#include <stdexcept>

#include "pickcell/core/units.hpp"

namespace pickcell::poses {

core::Result<View> view_at_exposure(const CameraCalibration& camera, const HandeyeCalibration& handeye,
                                    const core::Transform<core::Base, core::Plane>& T_base_plane,
                                    const std::optional<core::Transform<core::Base, core::Flange>>& T_base_flange) {
  View view;
  view.lens = camera.lens;
  view.T_base_plane = T_base_plane;
  view.sigma_position_m = core::m_from_mm(handeye.plane_error_mm);
  if (handeye.T_base_camera) {
    view.T_base_camera = *handeye.T_base_camera;
    return view;
  }
  if (!handeye.T_flange_camera) throw std::invalid_argument("a hand-eye calibration without its transform");
  if (!T_base_flange)
    return core::failure(core::ErrorCode::negative, "frame", "the arm's pose at its exposure is not known",
                         "a camera on the arm needs it with every picture");
  view.T_base_camera = *T_base_flange * *handeye.T_flange_camera;
  return view;
}

}  // namespace pickcell::poses
