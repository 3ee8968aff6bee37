#include "pickcell/poses/plane_calibration.hpp"

#include <Eigen/Geometry>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <limits>

#include "pickcell/core/units.hpp"
#include "pickcell/poses/board_pose.hpp"
#include "pickcell/poses/verdicts.hpp"

namespace pickcell::poses {

namespace {

using core::ErrorCode;
using core::failure;

constexpr Bounds kPlaneMm{0.2, 0.6, 2.5};
constexpr Bounds kPicturePx{0.3, 0.6, 1.5};
constexpr std::size_t kFewestPoints = 4, kFewestTouched = 3, kLeaveOneOut = 5;

/// A seen and touched place.
struct Pair {
  Eigen::Vector2d pixel;
  Eigen::Vector3d touched_m;
};

struct FittedPlane {
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();
  Eigen::Vector3d reach_m = Eigen::Vector3d::Zero();  ///< RMS along the plane's axes and across it
};

FittedPlane fit_plane(const std::vector<Pair>& pairs) {
  FittedPlane out;
  Eigen::Matrix3Xd centred(3, static_cast<Eigen::Index>(pairs.size()));
  for (const Pair& p : pairs) out.centre += p.touched_m / static_cast<double>(pairs.size());
  for (Eigen::Index i = 0; i < centred.cols(); ++i)
    centred.col(i) = pairs[static_cast<std::size_t>(i)].touched_m - out.centre;
  const Eigen::JacobiSVD<Eigen::Matrix3Xd> svd(centred, Eigen::ComputeFullU);
  for (Eigen::Index i = 0; i < std::min<Eigen::Index>(3, svd.singularValues().size()); ++i)
    out.reach_m[i] = svd.singularValues()[i] / std::sqrt(static_cast<double>(pairs.size()));
  out.normal = svd.matrixU().col(2);
  return out;
}

/// z along the normal towards the camera, x along the base's x as far as it lies in the plane.
core::Transform<core::Base, core::Plane> plane_frame(const Eigen::Vector3d& at, Eigen::Vector3d normal,
                                                     const Eigen::Vector3d& camera, double height_m) {
  if (normal.dot(camera - at) < 0) normal = -normal;
  const Eigen::Vector3d along = std::abs(normal.x()) < 0.9 ? Eigen::Vector3d::UnitX() : Eigen::Vector3d::UnitY();
  Eigen::Matrix3d R;
  R.col(2) = normal;
  R.col(0) = (along - normal * normal.dot(along)).normalized();
  R.col(1) = R.col(2).cross(R.col(0));
  return {R, at - height_m * normal};
}

/// Distance between a touched place and its pixel cast onto the plane through that place.
double cast_error_mm(const Lens& lens, const core::Transform<core::Base, core::Camera>& T_base_camera,
                     const Eigen::Vector3d& normal, const Pair& pair) {
  const auto ray = undistort(lens, pair.pixel);
  if (!ray) return std::numeric_limits<double>::infinity();
  const Eigen::Vector3d from = T_base_camera.translation_m();
  const Eigen::Vector3d along = T_base_camera.rotation() * Eigen::Vector3d(ray->x(), ray->y(), 1);
  const double t = normal.dot(pair.touched_m - from) / normal.dot(along);
  return core::mm_from_m((from + t * along - pair.touched_m).norm());
}

Eigen::Vector2d residual_px(const Lens& lens, const core::Transform<core::Base, core::Camera>& T_base_camera,
                            const Pair& pair) {
  const Eigen::Vector3d p = (T_base_camera.inverse() * core::Point<core::Base>{pair.touched_m}).m;
  return pair.pixel - project(lens, {p.x() / p.z(), p.y() / p.z()});
}

double rms(const std::vector<double>& values) {
  double sum = 0;
  for (const double v : values) sum += v * v;
  return std::sqrt(sum / static_cast<double>(std::max<std::size_t>(1, values.size())));
}

/// From the misfit of the points, `taken` of whose coordinates the fit has taken up. With a camera placed by few points
/// the prediction is worse than the misfit says: then it is how badly the others predict a point, less the point's own
/// error.
PickSigma sigma_of(const PlaneFit& fit, const std::vector<Pair>& pairs, double taken) {
  const double n = static_cast<double>(pairs.size());
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  for (const Pair& p : pairs) centre += p.touched_m / n;
  double misfit_mm2 = 0, reach_m2 = 0;
  for (const double e : fit.error_mm) misfit_mm2 += e * e;
  for (const Pair& p : pairs) reach_m2 += (p.touched_m - centre).squaredNorm();
  const double point_mm2 = misfit_mm2 / std::max(1.0, 2 * n - taken);
  double place_mm2 = point_mm2 / n;
  if (fit.loo_mm) place_mm2 = std::max(place_mm2, *fit.loo_mm * *fit.loo_mm / 2 - point_mm2);
  return {std::sqrt(place_mm2), core::deg_from_rad(core::m_from_mm(std::sqrt(point_mm2 / reach_m2)))};
}

/// Fills the errors; refit(i) gives T_base_camera without point i.
template <class Refit>
void measure(PlaneFit& out, const Lens& lens, const std::vector<Pair>& pairs, const Eigen::Vector3d& normal,
             Refit refit) {
  for (const Pair& p : pairs) {
    out.error_mm.push_back(cast_error_mm(lens, out.calibration.T_base_camera, normal, p));
    out.pixels.push_back(p.pixel);
    out.residual_px.push_back(residual_px(lens, out.calibration.T_base_camera, p));
  }
  out.rms_mm = rms(out.error_mm);
  out.worst_mm = *std::max_element(out.error_mm.begin(), out.error_mm.end());
  if (pairs.size() < kLeaveOneOut) return;
  std::vector<double> left_out;
  for (std::size_t i = 0; i < pairs.size(); ++i)
    if (const auto camera = refit(i)) left_out.push_back(cast_error_mm(lens, *camera, normal, pairs[i]));
  if (!left_out.empty()) out.loo_mm = rms(left_out);
}

void judge_fit(PlaneFit& out, std::size_t points, const std::string& fault) {
  Judgement verdict;
  const double error = out.loo_mm.value_or(out.rms_mm);
  verdict.add(judge(error, kPlaneMm), (out.loo_mm ? "leave-one-out error " : "error ") + figure(error, 2) +
                                          " mm over " + std::to_string(points) + " points");
  if (!out.loo_mm)
    verdict.add(Verdict::usable, std::to_string(points) + " points leave nothing to check the result with: touch five");
  if (out.picture_rms_px > 0)
    verdict.add(judge(out.picture_rms_px, kPicturePx),
                "the board's picture fits the lens to " + figure(out.picture_rms_px, 2) + " px");
  if (!fault.empty()) verdict.add(Verdict::reject, fault);
  out.calibration.rms_mm = out.rms_mm;
  out.calibration.verdict = verdict.verdict();
  out.why = verdict.why();
}

core::Status in_picture(const Lens& lens, const std::vector<TouchedPixel>& points) {
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Eigen::Vector2d& p = points[i].pixel;
    if (p.x() < -0.5 || p.y() < -0.5 || p.x() > lens.width_px - 0.5 || p.y() > lens.height_px - 0.5)
      return failure(ErrorCode::unreadable, "point " + std::to_string(i + 1),
                     "its pixel " + figure(p.x(), 1) + "," + figure(p.y(), 1) + " lies outside the picture of " +
                         std::to_string(lens.width_px) + "x" + std::to_string(lens.height_px),
                     "check the columns u_px,v_px");
  }
  return {};
}

std::optional<core::Transform<core::Base, core::Camera>> camera_from(const Lens& lens, const std::vector<Pair>& pairs,
                                                                     std::size_t without) {
  std::vector<Eigen::Vector3d> touched;
  std::vector<Eigen::Vector2d> pixels;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    if (i == without) continue;
    touched.push_back(pairs[i].touched_m);
    pixels.push_back(pairs[i].pixel);
  }
  const auto pose = points_pose(lens, touched, pixels);
  if (!pose) return std::nullopt;
  return core::Transform<core::Base, core::Camera>(pose->T_camera_points.inverse(Eigen::Isometry));
}

/// What the sizes say about units: nobody calibrates a field of a few millimetres, or of a hundred metres.
std::string suspicious_size(const FittedPlane& plane) {
  if (plane.reach_m[0] < 1.5e-3) return "the touched places lie within a few mm: metres were given as millimetres";
  if (plane.reach_m[0] > 20) return "the touched places lie many metres apart: micrometres were given as millimetres";
  return {};
}

/// Similarity between the board's nominal points and the touched places (Kabsch, Umeyama).
struct BoardFit {
  Eigen::Isometry3d T_base_board = Eigen::Isometry3d::Identity();
  double scale = 1;  ///< touched over nominal
  double rms_mm = 0;
};

BoardFit fit_board(const std::vector<Eigen::Vector3d>& nominal, const std::vector<Eigen::Vector3d>& touched) {
  const auto n = static_cast<Eigen::Index>(nominal.size());
  Eigen::Matrix3Xd a(3, n), b(3, n);
  for (Eigen::Index i = 0; i < n; ++i) {
    a.col(i) = nominal[static_cast<std::size_t>(i)];
    b.col(i) = touched[static_cast<std::size_t>(i)];
  }
  const Eigen::Vector3d mean_a = a.rowwise().mean(), mean_b = b.rowwise().mean();
  const Eigen::Matrix3Xd ca = a.colwise() - mean_a, cb = b.colwise() - mean_b;
  BoardFit out;
  out.T_base_board.matrix() = Eigen::umeyama(a, b, false);
  out.scale = cb.norm() / ca.norm();
  double sum = 0;
  for (Eigen::Index i = 0; i < n; ++i) sum += (out.T_base_board * a.col(i) - b.col(i)).squaredNorm();
  out.rms_mm = core::mm_from_m(std::sqrt(sum / static_cast<double>(n)));
  return out;
}

/// Why the touched places are no picture of the board, or "".
std::string touched_fault(const Board& board, const BoardFit& fit, bool camera_below) {
  if (camera_below)
    return "the touched corners are numbered in a mirror: seen by the camera, columns run right and rows down (or the "
           "board is mirrored)";
  if (fit.scale < 0.01) return "the touched places are 1000 times too close: metres were given as millimetres";
  if (fit.scale > 100) return "the touched places are 1000 times too far apart: check their unit";
  if (std::abs(fit.scale - 1) > 0.01 && fit.rms_mm > 1)
    return "the board's squares are " + figure(core::mm_from_m(board.spacing_m) * fit.scale, 2) +
           " mm by the touched "
           "places, not " +
           figure(core::mm_from_m(board.spacing_m), 2) + " mm";
  return {};
}

core::Status check_touched(const Board& board, const std::vector<TouchedCorner>& touched) {
  for (const TouchedCorner& t : touched)
    if (t.col < 0 || t.row < 0 || t.col >= board.point_cols() || t.row >= board.point_rows())
      return failure(ErrorCode::unreadable, "touched corner " + std::to_string(t.col) + "," + std::to_string(t.row),
                     "is not on " + board.text, "count columns and rows from 0");
  if (touched.size() < kFewestTouched)
    return failure(ErrorCode::negative, "touched corners", std::to_string(touched.size()) + " are too few",
                   "touch at least three, better five, not in a line");
  return {};
}

}  // namespace

core::Result<PlaneFit> plane_from_points(const Lens& lens, const std::vector<TouchedPixel>& points, double height_m) {
  if (points.size() < kFewestPoints)
    return failure(ErrorCode::negative, "points", std::to_string(points.size()) + " are too few",
                   "touch at least four, better five and more, spread over the picture");
  if (auto fine = in_picture(lens, points); !fine) return core::forward(fine);
  std::vector<Pair> pairs;
  for (const TouchedPixel& p : points) pairs.push_back({p.pixel, p.touched_m});
  const FittedPlane plane = fit_plane(pairs);
  if (plane.reach_m[1] < 0.05 * plane.reach_m[0])
    return failure(ErrorCode::negative, "points", "they lie in one line", "spread them over the picture");
  const auto camera = camera_from(lens, pairs, pairs.size());
  if (!camera)
    return failure(ErrorCode::negative, "points", "no place of the camera fits them",
                   "check that pixels and touched places belong together");
  PlaneFit out;
  out.calibration.T_base_camera = *camera;
  out.calibration.T_base_plane = plane_frame(plane.centre, plane.normal, camera->translation_m(), height_m);
  // Points at several heights are cast at their own, parallel to the plane.
  measure(out, lens, pairs, plane.normal, [&](std::size_t i) { return camera_from(lens, pairs, i); });
  out.calibration.sigma = sigma_of(out, pairs, 6);
  std::string fault = suspicious_size(plane);
  if (fault.empty() && plane.reach_m[2] > 0.2 * plane.reach_m[1])
    fault =
        "the touched places are no plane: they stand off it by " + figure(core::mm_from_m(plane.reach_m[2]), 1) + " mm";
  judge_fit(out, points.size(), fault);
  return out;
}

core::Result<PlaneFit> plane_from_touched_board(const Lens& lens, const Board& board, const BoardView& view,
                                                const std::vector<TouchedCorner>& touched, double height_m) {
  if (auto fine = check_touched(board, touched); !fine) return core::forward(fine);
  auto pose = board_pose(lens, board, view);
  if (!pose) return core::forward(pose);
  const auto all = board_points_m(board);
  std::vector<Eigen::Vector3d> nominal, places;
  std::vector<Pair> pairs;
  for (const TouchedCorner& t : touched) {
    const int id = t.row * board.point_cols() + t.col;
    const Eigen::Vector2d& p = all[static_cast<std::size_t>(id)];
    nominal.emplace_back(p.x(), p.y(), 0);
    places.push_back(t.touched_m);
    const auto seen = std::find(view.ids.begin(), view.ids.end(), id);
    const auto pixel = seen != view.ids.end() ? view.pixels[static_cast<std::size_t>(seen - view.ids.begin())]
                                              : predicted_pixels(lens, board, {id}, pose->T_camera_board)[0];
    pairs.push_back({pixel, t.touched_m});
  }
  const FittedPlane spread = fit_plane(pairs);
  if (spread.reach_m[1] < 0.05 * spread.reach_m[0])
    return failure(ErrorCode::negative, "touched corners", "they lie in one line", "touch some beside it");
  const auto camera_by = [&](const BoardFit& fit) {
    return core::Transform<core::Base, core::Camera>(fit.T_base_board *
                                                     pose->T_camera_board.iso().inverse(Eigen::Isometry));
  };
  const BoardFit fit = fit_board(nominal, places);
  PlaneFit out;
  out.picture_rms_px = pose->rms_px;
  out.calibration.T_base_camera = camera_by(fit);
  out.calibration.T_base_plane = plane_frame(spread.centre, fit.T_base_board.linear().col(2),
                                             out.calibration.T_base_camera.translation_m(), height_m);
  out.calibration.board = board.text;
  out.calibration.T_camera_board = pose->T_camera_board;
  measure(out, lens, pairs, fit.T_base_board.linear().col(2), [&](std::size_t without) {
    auto some_nominal = nominal;
    auto some_places = places;
    some_nominal.erase(some_nominal.begin() + static_cast<std::ptrdiff_t>(without));
    some_places.erase(some_places.begin() + static_cast<std::ptrdiff_t>(without));
    return std::optional(camera_by(fit_board(some_nominal, some_places)));
  });
  out.calibration.sigma = sigma_of(out, pairs, 3);
  // The rigid fit's own misfit counts as well: across the plane the cast does not see it.
  out.rms_mm = std::max(out.rms_mm, fit.rms_mm);
  // Above the board, seen from the camera, z of the base and the way to the camera agree for a camera over a table.
  const bool mirrored = out.calibration.T_base_camera.translation_m().z() < fit.T_base_board.translation().z() &&
                        std::abs(fit.T_base_board.linear()(2, 2)) > 0.7;
  judge_fit(out, touched.size(), touched_fault(board, fit, mirrored));
  if (board_symmetries(board).size() > 1)
    out.why += "; the board looks the same when turned: its corner 0,0 was taken as the detector numbers it";
  return out;
}

core::Result<PlaneFit> plane_from_board(const Lens& lens, const Board& board, const BoardView& view, double height_m) {
  auto pose = board_pose(lens, board, view);
  if (!pose) return core::forward(pose);
  PlaneFit out;
  // z of the board points away from the camera; the frame given out has z towards it, x along the board's x.
  const Eigen::Matrix3d up = Eigen::Vector3d(1, -1, -1).asDiagonal();
  const core::Transform<core::Base, core::Board> T_base_board(up, Eigen::Vector3d::Zero());
  out.calibration.T_base_camera = T_base_board * pose->T_camera_board.inverse();
  out.calibration.T_base_plane = {Eigen::Matrix3d::Identity(), {0, 0, -height_m}};
  out.calibration.board_frame_only = true;
  out.calibration.board = board.text;
  out.calibration.T_camera_board = pose->T_camera_board;
  out.picture_rms_px = pose->rms_px;
  const auto all = board_points_m(board);
  std::vector<Pair> pairs;
  for (std::size_t i = 0; i < view.ids.size(); ++i) {
    const Eigen::Vector2d& p = all[static_cast<std::size_t>(view.ids[i])];
    pairs.push_back({view.pixels[i], (T_base_board * core::Point<core::Board>{{p.x(), p.y(), 0}}).m});
  }
  measure(out, lens, pairs, Eigen::Vector3d::UnitZ(), [&](std::size_t i) {
    BoardView others = view;
    others.ids.erase(others.ids.begin() + static_cast<std::ptrdiff_t>(i));
    others.pixels.erase(others.pixels.begin() + static_cast<std::ptrdiff_t>(i));
    std::optional<core::Transform<core::Base, core::Camera>> camera;
    if (const auto other = board_pose(lens, board, others)) camera = T_base_board * other->T_camera_board.inverse();
    return camera;
  });
  judge_fit(out, pairs.size(), "");
  out.why = "the frame is the board's, not the robot's: no corner was touched; " + out.why;
  return out;
}

}  // namespace pickcell::poses
