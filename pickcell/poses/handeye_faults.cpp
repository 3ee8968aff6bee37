#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <functional>
#include <tuple>

#include "pickcell/core/statistics.hpp"
#include "pickcell/core/units.hpp"
#include "pickcell/poses/board_pose.hpp"
#include "pickcell/poses/handeye_problem.hpp"
#include "pickcell/poses/verdicts.hpp"

namespace pickcell::poses::detail {

namespace {

using Moves = std::vector<Eigen::Isometry3d>;

/// A way to read the input otherwise: changes the stations' moves and board poses; false when it does not apply.
struct Reading {
  std::string fault;
  std::function<bool(const HandeyeInput&, Stations&)> apply;
};

/// A reading that changes every pose by itself.
Reading of_poses(std::string fault, std::function<bool(const HandeyeInput&)> applies,
                 std::function<Eigen::Isometry3d(const ArmPose&)> pose) {
  return {std::move(fault), [applies, pose](const HandeyeInput& input, Stations& stations) {
            if (!applies(input) || stations.size() != input.views.size()) return false;
            for (std::size_t i = 0; i < stations.size(); ++i)
              stations[i].move = move_of(input, pose(input.views[i].arm));
            return true;
          }};
}

bool euler(const HandeyeInput& input) { return input.views.front().arm.euler; }
bool quaternion(const HandeyeInput& input) { return !euler(input); }
bool always(const HandeyeInput&) { return true; }

std::function<Eigen::Isometry3d(const ArmPose&)> with_angles(double factor) {
  return [factor](const ArmPose& arm) {
    ArmPose other = arm;
    other.angles_deg *= factor;
    return other.pose();
  };
}

std::function<Eigen::Isometry3d(const ArmPose&)> with_position(double factor) {
  return [factor](const ArmPose& arm) {
    Eigen::Isometry3d T = arm.pose();
    T.translation() *= factor;
    return T;
  };
}

Eigen::Isometry3d with_rotation(const ArmPose& arm, const Eigen::Matrix3d& R) {
  Eigen::Isometry3d T = arm.pose();
  T.linear() = R;
  return T;
}

/// Rotations about fixed axes in another order than Rz * Ry * Rx.
Eigen::Isometry3d rotations_reversed(const ArmPose& arm) {
  const Eigen::Vector3d& a = arm.angles_deg;
  return with_rotation(arm, rotation_zyx({a[0], 0, 0}) * rotation_zyx({0, a[1], 0}) * rotation_zyx({0, 0, a[2]}));
}

Eigen::Isometry3d angles_backwards(const ArmPose& arm) {
  return with_rotation(arm, rotation_zyx({arm.angles_deg[2], arm.angles_deg[1], arm.angles_deg[0]}));
}

/// unit_rad: of the numbers that were read as degrees.
std::function<Eigen::Isometry3d(const ArmPose&)> rotation_vector(double unit_rad) {
  return [unit_rad](const ArmPose& arm) {
    const double angle = unit_rad * arm.angles_deg.norm();
    if (angle == 0) return with_rotation(arm, Eigen::Matrix3d::Identity());
    return with_rotation(arm, Eigen::AngleAxisd(angle, arm.angles_deg.normalized()).toRotationMatrix());
  };
}

/// O, A, T of some makers: R = Rz(O) * Ry(A) * Rz(T).
Eigen::Isometry3d angles_zyz(const ArmPose& arm) {
  const Eigen::Vector3d& a = arm.angles_deg;
  return with_rotation(arm, rotation_zyx({0, 0, a[0]}) * rotation_zyx({0, a[1], 0}) * rotation_zyx({0, 0, a[2]}));
}

Eigen::Isometry3d rotation_inverted(const ArmPose& arm) { return with_rotation(arm, arm.pose().linear().transpose()); }

Eigen::Isometry3d scalar_first(const ArmPose& arm) {
  const Eigen::Quaterniond& q = arm.quaternion;  // the file's order was w, x, y, z
  return with_rotation(arm, Eigen::Quaterniond(q.x(), q.y(), q.z(), q.w()).toRotationMatrix());
}

bool invert_moves(const HandeyeInput&, Stations& stations) {
  for (Station& s : stations) s.move = s.move.inverse();
  return true;
}

/// The pictures as they were before somebody mirrored them: columns of pixels reversed, and the board's columns with
/// them, because its numbering is right-handed in any picture.
bool mirror_pictures(const HandeyeInput& input, Stations& stations) {
  const int cols = input.board.point_cols(), rows = input.board.point_rows();
  std::vector<int> reversed;
  for (int row = 0; row < rows; ++row)
    for (int col = 0; col < cols; ++col) reversed.push_back(row * cols + (cols - 1 - col));
  for (Station& s : stations) {
    s.view = renumbered(s.view, reversed);
    for (auto& p : s.view.pixels) p.x() = s.view.width_px - 1 - p.x();
    const auto pose = board_pose(input.lens, input.board, s.view);
    if (!pose) return false;
    s.T_camera_board = pose->T_camera_board.iso();
  }
  return input.board.kind != BoardKind::charuco;  // whose markers are not found in a mirror
}

std::function<bool(const HandeyeInput&, Stations&)> shifted(std::size_t by) {
  return [by](const HandeyeInput&, Stations& stations) {
    Moves moves;
    for (const Station& s : stations) moves.push_back(s.move);
    for (std::size_t i = 0; i < stations.size(); ++i) stations[i].move = moves[(i + by) % stations.size()];
    return stations.size() > 4;
  };
}

/// Poses and pictures were counted in two orders of the same names: as numbers (1, 2, 10) and as text (1, 10, 2).
std::function<bool(const HandeyeInput&, Stations&)> sorted_otherwise(bool poses_as_numbers) {
  return [poses_as_numbers](const HandeyeInput& input, Stations& stations) {
    const std::size_t n = stations.size();
    if (n != input.views.size()) return false;
    std::vector<std::size_t> as_text(n);
    for (std::size_t i = 0; i < n; ++i) as_text[i] = i;
    std::vector<std::size_t> as_numbers = as_text;
    const auto name = [&](std::size_t i) -> const std::string& { return input.views[i].arm.image; };
    std::sort(as_text.begin(), as_text.end(), [&](std::size_t a, std::size_t b) { return name(a) < name(b); });
    std::sort(as_numbers.begin(), as_numbers.end(), [&](std::size_t a, std::size_t b) {
      return name(a).size() != name(b).size() ? name(a).size() < name(b).size() : name(a) < name(b);
    });
    const auto& from = poses_as_numbers ? as_text : as_numbers;
    const auto& to = poses_as_numbers ? as_numbers : as_text;
    Moves moves(n);
    for (std::size_t k = 0; k < n; ++k) moves[to[k]] = stations[from[k]].move;
    for (std::size_t i = 0; i < n; ++i) stations[i].move = moves[i];
    return as_text != as_numbers;
  };
}

/// For every station the angles to all others, sorted: a mark that arm and camera share whatever X is.
std::vector<std::vector<double>> angle_marks(const std::vector<Eigen::Matrix3d>& rotations) {
  std::vector<std::vector<double>> out;
  for (const auto& a : rotations) {
    out.emplace_back();
    for (const auto& b : rotations) out.back().push_back(angle_deg(a.transpose() * b));
    std::sort(out.back().begin(), out.back().end());
  }
  return out;
}

/// Gives every picture the pose whose mark is most like its own, the likest pairs first.
bool matched_by_marks(const HandeyeInput& input, Stations& stations) {
  const std::size_t n = stations.size();
  constexpr std::size_t kMost = 200;
  if (n < 6 || n > kMost || board_symmetries(input.board).size() > 1) return false;
  std::vector<Eigen::Matrix3d> arm, camera;
  for (const Station& s : stations) {
    arm.push_back(s.move.linear());
    camera.push_back(s.T_camera_board.linear().transpose());
  }
  const auto of_arm = angle_marks(arm), of_camera = angle_marks(camera);
  std::vector<std::tuple<double, std::size_t, std::size_t>> pairs;
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = 0; j < n; ++j) {
      double sum = 0;
      for (std::size_t k = 0; k < n; ++k) sum += std::abs(of_camera[i][k] - of_arm[j][k]);
      pairs.emplace_back(sum, i, j);
    }
  std::sort(pairs.begin(), pairs.end());
  Moves moves;
  for (const Station& s : stations) moves.push_back(s.move);
  std::vector<bool> has(n), taken(n);
  for (const auto& [unlike, i, j] : pairs) {
    if (has[i] || taken[j]) continue;
    has[i] = taken[j] = true;
    stations[i].move = moves[j];
  }
  return true;
}

bool reversed_rows(const HandeyeInput&, Stations& stations) {
  Moves moves;
  for (const Station& s : stations) moves.push_back(s.move);
  for (std::size_t i = 0; i < stations.size(); ++i) stations[i].move = moves[stations.size() - 1 - i];
  return true;
}

/// The board's poses with all lengths multiplied.
std::function<bool(const HandeyeInput&, Stations&)> scaled_board(double factor) {
  return [factor](const HandeyeInput&, Stations& stations) {
    for (Station& s : stations) s.T_camera_board.translation() *= factor;
    return true;
  };
}

std::vector<Reading> readings(std::size_t views) {
  std::vector<Reading> out{
      of_poses("angles are in radians where degrees are expected", euler, with_angles(core::deg_from_rad(1))),
      of_poses("angles: degrees were read as radians (they are 57.3 times too large)", euler,
               with_angles(core::rad_from_deg(1))),
      of_poses("positions: millimetres were given as metres (1000 times too large)", always, with_position(1e-3)),
      of_poses("positions: metres were given as millimetres (1000 times too small)", always, with_position(1e3)),
      of_poses("positions are in centimetres", always, with_position(10)),
      of_poses("positions are in inches", always, with_position(25.4)),
      of_poses("the order of the rotations is Rx*Ry*Rz instead of Rz*Ry*Rx", euler, rotations_reversed),
      of_poses("the columns rx and rz are swapped", euler, angles_backwards),
      of_poses("the angles are a rotation vector, not rx, ry, rz", euler, rotation_vector(core::rad_from_deg(1))),
      of_poses("the angles are a rotation vector in radians, not rx, ry, rz in degrees", euler, rotation_vector(1)),
      of_poses("the angles are those of Rz*Ry*Rz instead of Rz*Ry*Rx", euler, angles_zyz),
      of_poses("the rotations are inverted, the positions are not", always, rotation_inverted),
      of_poses("the quaternion's order is w, x, y, z instead of x, y, z, w", quaternion, scalar_first),
      {"the poses are inverted (T_flange_base), or the mounting is the other one (--eye-in-hand, --eye-to-hand)",
       invert_moves},
      {"the board or the pictures are mirrored", mirror_pictures},
      {"rows are mixed up: the poses are in the order 1, 2, 10, the pictures in that of their names: 1, 10, 2",
       sorted_otherwise(true)},
      {"rows are mixed up: the poses are in the order of the names 1, 10, 2, the pictures in the order 1, 2, 10",
       sorted_otherwise(false)},
      {"rows are reversed: the last pose belongs to the first picture", reversed_rows},
      {"rows are shifted by one: each pose belongs to the picture before", shifted(1)},
      {"rows are shifted by one: each pose belongs to the picture after", shifted(views - 1)},
      {"rows are mixed up: many poses belong to other pictures", matched_by_marks},
  };
  return out;
}

/// Of the true square over the stated one.
std::vector<double> likely_scales() { return {0.5, 0.7, 0.8, 0.9, 0.95, 1.05, 1.1, 1.2, 1.4, 2.0}; }

double median_error_px(const HandeyeInput& input, const Board& board, Stations stations) {
  constexpr int kSubsets = 12;  // another reading is right for all poses but a few, or for none
  const auto solved = solve_robustly(input.lens, board, stations, kSubsets);
  if (!solved) return 1e9;
  return *core::median(station_rms_px(input.lens, board_points_m(board), stations, *solved));
}

/// A board of another square size explains the pictures: the error is smallest at one scale of it.
std::optional<Explanation> other_square(const HandeyeInput& input, const Stations& stations) {
  const auto error_at = [&](double scale) {
    Stations scaled = stations;
    if (!scaled_board(scale)(input, scaled)) return 1e9;
    Board board = input.board;
    board.spacing_m *= scale;
    return median_error_px(input, board, std::move(scaled));
  };
  double best = 1, least = 1e9;
  for (const double s : likely_scales())
    if (const double e = error_at(s); e < least) {
      least = e;
      best = s;
    }
  for (double step = 0.04; step > 0.002; step /= 2)
    for (const double s : {best - step, best + step})
      if (const double e = error_at(s); e < least) {
        least = e;
        best = s;
      }
  const bool dots = input.board.kind == BoardKind::circles || input.board.kind == BoardKind::asymmetric_circles;
  const std::string what = dots ? "the board's circles stand apart by " : "the board's squares are ";
  return Explanation{what + figure(core::mm_from_m(input.board.spacing_m) * best, 2) + " mm, not " +
                         figure(core::mm_from_m(input.board.spacing_m), 2) + " mm",
                     least};
}

}  // namespace

Eigen::Isometry3d move_of(const HandeyeInput& input, const Eigen::Isometry3d& pose) {
  const Eigen::Isometry3d T_base_flange = pose * input.T_flange_tool.inverse();
  return input.mounting == Mounting::eye_in_hand ? T_base_flange : T_base_flange.inverse();
}

std::optional<Explanation> explain(const HandeyeInput& input, const Stations& stations, double median_px) {
  constexpr double kFarBetter = 0.4;
  constexpr double kFitsPx = 3;  // what still leaves this much explains only part of the error
  std::optional<Explanation> best;
  const auto consider = [&](Explanation e) {
    const bool fits = e.median_px < kFitsPx || e.median_px < 0.1 * median_px;
    if (fits && e.median_px < kFarBetter * median_px && (!best || e.median_px < best->median_px)) best = std::move(e);
  };
  for (const Reading& reading : readings(stations.size())) {
    Stations other = stations;
    if (!reading.apply(input, other) || !unsolvable(other).empty()) continue;
    consider({reading.fault, median_error_px(input, input.board, std::move(other))});
  }
  if (unsolvable(stations).empty() && !best)
    if (auto square = other_square(input, stations)) consider(std::move(*square));
  return best;
}

std::string suspicious_units(const std::vector<ArmView>& views) {
  double farthest_m = 0, largest_deg = 0, largest_turn = 0;
  bool angles = true;
  for (const ArmView& v : views) {
    farthest_m = std::max(farthest_m, v.arm.position_m.norm());
    largest_deg = std::max(largest_deg, v.arm.angles_deg.cwiseAbs().maxCoeff());
    largest_turn =
        std::max(largest_turn, angle_deg(views.front().arm.pose().linear().transpose() * v.arm.pose().linear()));
    angles = angles && v.arm.euler;
  }
  std::string out;
  if (farthest_m < 0.02)
    out = "positions: metres were given as millimetres (the arm never leaves 20 mm around its base)";
  if (farthest_m > 20)
    out = "positions: millimetres were given as metres (the arm stands " + figure(farthest_m, 0) + " m from its base)";
  if (angles && largest_deg <= 2 * core::kPi && largest_turn < 8)
    out +=
        std::string(out.empty() ? "" : "; ") + "angles are in radians where degrees are expected (none exceeds 2 pi)";
  if (angles && largest_deg > 720)
    out += std::string(out.empty() ? "" : "; ") + "angles: degrees were read as radians (they reach " +
           figure(largest_deg, 0) + ")";
  return out;
}

}  // namespace pickcell::poses::detail
