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
  view.sigma_position_m = core::m_from_mm(handeye.sigma.place_mm);
  view.sigma_turn_rad = core::rad_from_deg(handeye.sigma.turn_deg);
  const auto turns_about_middle = [&view] {
    view.turns_about_m = plane_point(view, {view.lens.cx_px, view.lens.cy_px}, 0).value_or(Eigen::Vector2d::Zero());
    return view;
  };
  if (handeye.T_base_camera) {
    view.T_base_camera = *handeye.T_base_camera;
    return turns_about_middle();
  }
  if (!handeye.T_flange_camera) throw std::invalid_argument("a hand-eye calibration without its transform");
  if (!T_base_flange)
    return core::failure(core::ErrorCode::negative, "frame", "the arm's pose at its exposure is not known",
                         "a camera on the arm needs it with every picture");
  view.T_base_camera = *T_base_flange * *handeye.T_flange_camera;
  return turns_about_middle();
}

core::Result<core::Transform<core::Base, core::Plane>> work_plane(const HandeyeCalibration& handeye,
                                                                  std::optional<double> plane_z_m) {
  constexpr double kLevel = 0.9986;  // cosine of 3 degrees
  const auto refuse = [](std::string why) {
    return core::failure(core::ErrorCode::unreadable, "hand-eye calibration", std::move(why),
                         "say in [calibration] plane_z_mm how high the work plane lies in the robot's frame");
  };
  if (plane_z_m)
    return core::Transform<core::Base, core::Plane>(Eigen::Matrix3d::Identity(), Eigen::Vector3d(0, 0, *plane_z_m));
  if (!handeye.T_base_board) return refuse("it does not say where the work plane is");
  // The board's z axis points into the board.
  if (-handeye.T_base_board->rotation()(2, 2) < kLevel) return refuse("its board did not lie level on a work plane");
  const Eigen::Matrix3d face_up = Eigen::Vector3d(1, -1, -1).asDiagonal();
  const core::Transform<core::Board, core::Plane> T_board_plane(face_up, Eigen::Vector3d::Zero());
  return *handeye.T_base_board * T_board_plane;
}

}  // namespace pickcell::poses
