#include "pickcell/cli/cell/calibration.hpp"

#include <utility>

#include "pickcell/core/units.hpp"
#include "pickcell/poses/moving_view.hpp"
#include "pickcell/poses/pose_files.hpp"
#ifdef PICKCELL_WITH_CALIBRATION
#include "pickcell/poses/board_detect.hpp"
#include "pickcell/poses/verify.hpp"
#endif

namespace pickcell::cli {

using core::ErrorCode;
using core::failure;

core::Result<cell::Vision::Settings> load_calibration(const cell::CalibrationConfig& config) {
  cell::Vision::Settings out;
  out.max_age_days = config.max_age_days;
  auto camera = poses::load_camera(config.camera);
  if (!camera) return core::forward(camera);
  out.camera = std::move(*camera);
  if (config.handeye.empty()) {
    auto plane = poses::load_plane(config.plane);
    if (!plane) return core::forward(plane);
    out.plane = std::move(*plane);
    return out;
  }
  auto handeye = poses::load_handeye(config.handeye);
  if (!handeye) return core::forward(handeye);
  std::optional<double> plane_z_m;
  if (config.plane_z_mm) plane_z_m = core::m_from_mm(*config.plane_z_mm);
  auto plane = poses::work_plane(*handeye, plane_z_m);
  if (!plane) return core::forward(plane);
  out.plane.T_base_plane = *plane;
  out.handeye = std::move(*handeye);
  return out;
}

core::Transform<core::Flange, core::Tool> flange_tool(const cell::CalibrationConfig& config) {
  const auto& t = config.flange_tool_mm_deg;
  return {poses::rotation_zyx({t[3], t[4], t[5]}),
          {core::m_from_mm(t[0]), core::m_from_mm(t[1]), core::m_from_mm(t[2])}};
}

#ifdef PICKCELL_WITH_CALIBRATION

namespace {

/// Where the camera of this frame should see the board.
std::optional<core::Transform<core::Camera, core::Board>> expected_board(const cell::Vision::Settings& calibration,
                                                                         const frames::Frame& frame) {
  if (!calibration.handeye) return calibration.plane.T_camera_board;
  if (!frame.T_base_flange) return std::nullopt;
  const auto T_base_camera = *frame.T_base_flange * *calibration.handeye->T_flange_camera;
  return T_base_camera.inverse() * *calibration.handeye->T_base_board;
}

core::Result<std::string> check(const cell::Vision::Settings& calibration, const poses::Board& board,
                                const frames::Frame& frame) {
  auto view = poses::detect_board(frame.picture->view(), board, "picture");
  if (!view) return core::forward(view);
  poses::PlaneCalibration reference = calibration.plane;
  reference.T_camera_board = expected_board(calibration, frame);
  auto seen = poses::verify(calibration.camera.lens, reference, board, *view);
  if (!seen) return core::forward(seen);
  if (seen->verdict == poses::Drift::ok) return seen->why;
  return failure(ErrorCode::safety, "camera", seen->why,
                 "put camera and board back in their places, or calibrate again; then press Reset");
}

}  // namespace

core::Result<cell::CameraCheck> camera_check(const cell::CalibrationConfig& config,
                                             const cell::Vision::Settings& calibration) {
  if (config.verify_at_start == cell::VerifyAtStart::never) return cell::CameraCheck{};
  const auto& handeye = calibration.handeye;
  const bool has_reference = handeye ? handeye->T_flange_camera && handeye->T_base_board && !handeye->board.empty()
                                     : calibration.plane.T_camera_board && !calibration.plane.board.empty();
  if (!has_reference)
    return failure(ErrorCode::usage, "'calibration.verify_at_start'", "the calibration has no reference board",
                   "calibrate the plane with --board-image and --touched, or the camera on the arm with handeye");
  auto board = poses::parse_board(handeye ? handeye->board : calibration.plane.board);
  if (!board) return core::forward(board);
  return cell::CameraCheck{
      [calibration, board = *board](const frames::Frame& frame) { return check(calibration, board, frame); }};
}

#else

core::Result<cell::CameraCheck> camera_check(const cell::CalibrationConfig& config, const cell::Vision::Settings&) {
  if (config.verify_at_start == cell::VerifyAtStart::never) return cell::CameraCheck{};
  return failure(ErrorCode::usage, "'calibration.verify_at_start'", "this build cannot detect boards",
                 "build with -DPICKCELL_WITH_CALIBRATION=ON");
}

#endif

}  // namespace pickcell::cli
