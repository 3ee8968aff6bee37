#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <random>

#include "pickcell/core/statistics.hpp"
#include "pickcell/core/units.hpp"
#include "pickcell/poses/handeye_problem.hpp"

namespace pickcell::poses::detail {

namespace {

constexpr std::size_t kSubsetSize = 5;

/// What a symmetry does to a pose: the same board, numbered otherwise, is T_camera_board * T_board_turned.
std::vector<Eigen::Isometry3d> turned_frames(const Board& board, const std::vector<std::vector<int>>& symmetries) {
  const auto nominal = board_points_m(board);
  std::vector<Eigen::Isometry3d> out;
  for (const auto& new_index : symmetries) {
    // The place that point k of the turned numbering has in the old frame.
    std::vector<std::size_t> old_of(new_index.size());
    for (std::size_t i = 0; i < new_index.size(); ++i) old_of[static_cast<std::size_t>(new_index[i])] = i;
    const Eigen::Vector2d origin = nominal[old_of[0]];
    const Eigen::Vector2d x_new = nominal[old_of[1]] - origin, x_old = nominal[1] - nominal[0];
    const double turn = std::atan2(x_new.y(), x_new.x()) - std::atan2(x_old.y(), x_old.x());
    Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
    T.linear() = core::rotation_z(turn);
    T.translation() = Eigen::Vector3d(origin.x(), origin.y(), 0);
    out.push_back(T);
  }
  return out;
}

void turn_board(Station& station, const std::vector<int>& new_index, const Eigen::Isometry3d& turned) {
  station.view = renumbered(station.view, new_index);
  station.T_camera_board = station.T_camera_board * turned;
}

/// A relative motion turns arm and camera by the same angle, whatever X is: numbers every board so that its angle to a
/// reference station fits best, for the reference that all agree with best.
void number_by_angles(Stations& stations, const std::vector<std::vector<int>>& symmetries,
                      const std::vector<Eigen::Isometry3d>& turned) {
  double best_total = std::numeric_limits<double>::max();
  std::vector<std::size_t> best_choice;
  for (const Station& reference : stations) {
    double total = 0;
    std::vector<std::size_t> choice;
    for (const Station& s : stations) {
      const double arm = angle_deg(reference.move.linear().transpose() * s.move.linear());
      double least = std::numeric_limits<double>::max();
      std::size_t chosen = 0;
      for (std::size_t k = 0; k < turned.size(); ++k) {
        const double camera =
            angle_deg(reference.T_camera_board.linear() * (s.T_camera_board * turned[k]).linear().transpose());
        if (std::abs(arm - camera) < least - 0.5) {
          least = std::abs(arm - camera);
          chosen = k;
        }
      }
      total += std::min(least, 20.0);
      choice.push_back(chosen);
    }
    if (total >= best_total) continue;
    best_total = total;
    best_choice = std::move(choice);
  }
  for (std::size_t i = 0; i < stations.size(); ++i)
    turn_board(stations[i], symmetries[best_choice[i]], turned[best_choice[i]]);
}

/// Numbers every board so that it lies nearest to where the result expects it; true when one changed.
bool number_by_result(Stations& stations, const HandEye& result, const std::vector<std::vector<int>>& symmetries,
                      const std::vector<Eigen::Isometry3d>& turned) {
  bool changed = false;
  for (Station& s : stations) {
    const Eigen::Matrix3d expected = ((s.move * result.X).inverse() * result.Y).linear();
    std::size_t chosen = 0;
    double least = angle_deg(expected.transpose() * s.T_camera_board.linear()) - 1;
    for (std::size_t k = 1; k < turned.size(); ++k) {
      const double off = angle_deg(expected.transpose() * (s.T_camera_board * turned[k]).linear());
      if (off < least) {
        least = off;
        chosen = k;
      }
    }
    if (chosen == 0) continue;
    turn_board(s, symmetries[chosen], turned[chosen]);
    changed = true;
  }
  return changed;
}

std::optional<HandEye> best_of_subsets(const Lens& lens, const std::vector<Eigen::Vector2d>& board_m,
                                       const Stations& stations, int subsets) {
  std::mt19937 random(1);  // NOLINT: the same result every time
  std::optional<HandEye> best;
  double best_median = std::numeric_limits<double>::max();
  std::vector<std::size_t> order(stations.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  for (int round = 0; round <= subsets; ++round) {
    Stations subset = stations;  // the first round takes all
    if (round > 0) {
      std::shuffle(order.begin(), order.end(), random);
      subset.clear();
      for (std::size_t i = 0; i < std::min(kSubsetSize, order.size()); ++i) subset.push_back(stations[order[i]]);
    }
    const auto solved = solve(subset, Solver::park);
    if (!solved) continue;
    const double median = *core::median(station_rms_px(lens, board_m, stations, *solved));
    if (median >= best_median) continue;
    best_median = median;
    best = solved;
  }
  return best;
}

/// Refines over the better half (at least four), twice: what is wrong has no say.
HandEye refine_on_good_half(const Lens& lens, const std::vector<Eigen::Vector2d>& board_m, const Stations& stations,
                            HandEye result) {
  for (int round = 0; round < 2; ++round) {
    const auto error = station_rms_px(lens, board_m, stations, result);
    std::vector<std::size_t> order(stations.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return error[a] < error[b]; });
    Stations half;
    const std::size_t n = std::min(stations.size(), std::max<std::size_t>(4, (2 * stations.size() + 2) / 3));
    for (std::size_t i = 0; i < n; ++i) half.push_back(stations[order[i]]);
    result = refine(lens, board_m, half, result);
  }
  return result;
}

}  // namespace

std::optional<HandEye> solve_robustly(const Lens& lens, const Board& board, Stations& stations, int subsets) {
  const auto board_m = board_points_m(board);
  const auto symmetries = board_symmetries(board);
  const auto turned = turned_frames(board, symmetries);
  if (symmetries.size() > 1) number_by_angles(stations, symmetries, turned);
  std::optional<HandEye> result;
  for (int round = 0; round < 4; ++round) {
    result = best_of_subsets(lens, board_m, stations, subsets);
    if (!result || symmetries.size() == 1 || !number_by_result(stations, *result, symmetries, turned)) break;
  }
  if (result) result = refine_on_good_half(lens, board_m, stations, *result);
  return result;
}

std::string unsolvable(const Stations& stations) {
  constexpr double kTurnsDeg = 5;
  constexpr double kOneAxis = 0.1;  // sine of the angle within which all axes lie, about 6 degrees
  double largest = 0;
  Eigen::Matrix3d axes = Eigen::Matrix3d::Zero();
  for (std::size_t i = 0; i < stations.size(); ++i)
    for (std::size_t j = i + 1; j < stations.size(); ++j) {
      const Eigen::Matrix3d R = stations[i].move.linear().transpose() * stations[j].move.linear();
      const double angle = angle_deg(R);
      largest = std::max(largest, angle);
      if (angle < kTurnsDeg) continue;
      // By the rotation's size, so that small ones with noisy axes count little; the axis is in the arm's own frame.
      const Eigen::AngleAxisd turn(R);
      const double weight = std::sin(core::rad_from_deg(std::min(angle, 90.0)));
      axes += weight * weight * turn.axis() * turn.axis().transpose();
    }
  if (largest < kTurnsDeg)
    return "the arm hardly turns between the pictures (at most " + std::to_string(static_cast<int>(largest)) +
           " degrees)";
  const Eigen::Vector3d strength = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(axes).eigenvalues();
  if (std::sqrt(std::max(0.0, strength[1]) / strength[2]) < kOneAxis) return "the arm turns about one axis only";
  return {};
}

}  // namespace pickcell::poses::detail
