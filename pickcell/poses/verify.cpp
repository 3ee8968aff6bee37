#include "pickcell/poses/verify.hpp"

#include <Eigen/Geometry>
#include <cmath>

#include "pickcell/core/units.hpp"
#include "pickcell/poses/board_pose.hpp"
#include "pickcell/poses/verdicts.hpp"

namespace pickcell::poses {

namespace {

using core::ErrorCode;
using core::failure;

/// Where the camera of the reference would see the points on the board's plane.
std::vector<Eigen::Vector2d> cast_m(const Lens& lens, const core::Transform<core::Camera, core::Board>& T_camera_board,
                                    const std::vector<Eigen::Vector2d>& pixels) {
  const auto T_board_camera = T_camera_board.inverse();
  const Eigen::Vector3d from = T_board_camera.translation_m();
  std::vector<Eigen::Vector2d> out;
  for (const Eigen::Vector2d& p : pixels) {
    const auto ray = undistort(lens, p);
    if (!ray) {
      out.emplace_back(1e3, 1e3);
      continue;
    }
    const Eigen::Vector3d along = T_board_camera.rotation() * Eigen::Vector3d(ray->x(), ray->y(), 1);
    out.emplace_back((from - along * (from.z() / along.z())).head<2>());
  }
  return out;
}

/// RMS distance and turn between nominal points and where they are seen.
void compare(const std::vector<Eigen::Vector2d>& nominal, const std::vector<Eigen::Vector2d>& seen, VerifyResult& out) {
  Eigen::Vector2d mean_n = Eigen::Vector2d::Zero(), mean_s = Eigen::Vector2d::Zero();
  const double n = static_cast<double>(nominal.size());
  double sum = 0, dot = 0, cross = 0;
  for (std::size_t i = 0; i < nominal.size(); ++i) {
    mean_n += nominal[i] / n;
    mean_s += seen[i] / n;
    sum += (seen[i] - nominal[i]).squaredNorm();
  }
  for (std::size_t i = 0; i < nominal.size(); ++i) {
    const Eigen::Vector2d a = nominal[i] - mean_n, b = seen[i] - mean_s;
    dot += a.dot(b);
    cross += a.x() * b.y() - a.y() * b.x();
  }
  out.drift_mm = core::mm_from_m(std::sqrt(sum / n));
  out.drift_deg = std::abs(core::deg_from_rad(std::atan2(cross, dot)));
}

}  // namespace

const char* name(Drift drift) {
  switch (drift) {
    case Drift::ok:
      return "ok";
    case Drift::drifted:
      return "drifted";
    case Drift::reject:
      return "reject";
  }
  return "reject";
}

core::Result<VerifyResult> verify(const Lens& lens, const PlaneCalibration& plane, const Board& board,
                                  const BoardView& view) {
  if (!plane.T_camera_board)
    return failure(ErrorCode::unreadable, "plane calibration", "has no reference picture of a board",
                   "calibrate the plane with --board-image and --touched");
  const auto all = board_points_m(board);
  VerifyResult best;
  best.drift_mm = 1e300;
  for (const auto& new_index : board_symmetries(board)) {  // the numbering that lies nearest
    const BoardView turned = renumbered(view, new_index);
    auto pose = board_pose(lens, board, turned);
    if (!pose) return core::forward(pose);
    std::vector<Eigen::Vector2d> nominal;
    for (const int id : turned.ids) nominal.push_back(all[static_cast<std::size_t>(id)]);
    VerifyResult one;
    one.rms_px = pose->rms_px;
    compare(nominal, cast_m(lens, *plane.T_camera_board, turned.pixels), one);
    const auto expected = predicted_pixels(lens, board, turned.ids, *plane.T_camera_board);
    for (std::size_t i = 0; i < expected.size(); ++i) one.residual_px.push_back(turned.pixels[i] - expected[i]);
    one.view = turned;
    if (one.drift_mm < best.drift_mm) best = std::move(one);
  }
  const std::string words = figure(best.drift_mm, 2) + " mm and " + figure(best.drift_deg, 3) + " deg at the plane";
  if (!(best.rms_px <= kDriftPicturePx)) {
    best.verdict = Drift::reject;
    best.why = "the picture fits the lens only to " + figure(best.rms_px, 2) + " px: another lens, focus or board";
  } else if (best.drift_mm <= kDriftOkMm && best.drift_deg <= kDriftOkDeg) {
    best.verdict = Drift::ok;
    best.why = "the board is seen within " + words;
  } else {
    best.verdict = Drift::drifted;
    best.why = "camera or board moved by " + words + ": calibrate the plane again";
  }
  return best;
}

}  // namespace pickcell::poses
