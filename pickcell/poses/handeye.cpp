#include "pickcell/poses/handeye.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "pickcell/core/statistics.hpp"
#include "pickcell/core/units.hpp"
#include "pickcell/poses/board_pose.hpp"
#include "pickcell/poses/handeye_problem.hpp"
#include "pickcell/poses/verdicts.hpp"

namespace pickcell::poses {

namespace {

using core::ErrorCode;
using core::failure;
using detail::HandEye;
using detail::Station;
using detail::Stations;

constexpr std::size_t kFewest = 3;
constexpr Bounds kJointPx{0.5, 1, 2};
constexpr Bounds kSpreadMm{0.3, 1, 2};
constexpr Bounds kSpreadDeg{0.02, 0.1, 0.2};
constexpr Bounds kPlaneMm{0.2, 0.6, 2.5};
constexpr Bounds kPicturePx{0.5, 1, 2};
constexpr double kBadPoseFactor = 4;  ///< times the usual share of the arm in a picture's error
constexpr double kLeastShare = 0.4;   ///< of the pictures' own error, below which the arm's share means nothing
constexpr double kMostLeftOut = 0.4;  ///< of the pictures

/// The work in progress: stations[i] belongs to input.views[index[i]].
struct Work {
  const HandeyeInput& input;
  std::vector<Eigen::Vector2d> board_m;
  Stations stations;
  std::vector<std::size_t> index;
  std::vector<LeftOut> left_out;

  [[nodiscard]] const std::string& image(std::size_t i) const { return input.views[index[i]].picture.image; }
  void leave_out(std::size_t i, std::string reason) {
    left_out.push_back({image(i), std::move(reason)});
    stations.erase(stations.begin() + static_cast<std::ptrdiff_t>(i));
    index.erase(index.begin() + static_cast<std::ptrdiff_t>(i));
  }
};

core::Result<Work> begin(const HandeyeInput& input) {
  Work work{input, board_points_m(input.board), {}, {}, {}};
  for (std::size_t i = 0; i < input.views.size(); ++i) {
    const ArmView& v = input.views[i];
    const auto pose = board_pose(input.lens, input.board, v.picture.view);
    if (!pose) {
      work.left_out.push_back({v.picture.image, "its points fix no pose of the board"});
      continue;
    }
    work.stations.push_back(
        {detail::move_of(input, v.arm.pose()), pose->T_camera_board.iso(), v.picture.view, pose->rms_px});
    work.index.push_back(i);
  }
  if (work.stations.size() < kFewest)
    return failure(ErrorCode::negative, "hand-eye",
                   std::to_string(work.stations.size()) + " pictures with a board and a pose are too few",
                   "take at least 3, better 15, turned about different axes");
  return work;
}

core::Status check_motions(const Work& work) {
  const std::string units = detail::suspicious_units(work.input.views);
  const std::string why = detail::unsolvable(work.stations);
  if (why.empty()) return {};
  return failure(ErrorCode::negative, "hand-eye", (units.empty() ? "" : units + "; ") + why + ": cannot be solved",
                 "turn the wrist about at least two different axes by 20 degrees and more");
}

/// The share of the arm in a picture's error: what its own board pose leaves unexplained.
double arm_share_px(double joint_px, double picture_px) {
  return std::sqrt(std::max(0.0, joint_px * joint_px - picture_px * picture_px));
}

/// The error of the pose `move` for the picture of this station.
detail::ArmError pose_error(const Work& work, Station station, const Eigen::Isometry3d& move, const HandEye& result) {
  station.move = move;
  return detail::arm_errors(work.input.lens, work.board_m, {station}, result, work.input.mounting).each.front();
}

/// "its pose is 2.1 mm and 0.02 deg off", or that its pose belongs to another picture.
std::string reason_of(const Work& work, std::size_t i, const HandEye& result, const Stations& all,
                      const std::vector<std::size_t>& all_index) {
  const detail::ArmError own = pose_error(work, work.stations[i], work.stations[i].move, result);
  for (std::size_t k = 0; k < all.size(); ++k) {
    if (all_index[k] == work.index[i]) continue;
    const detail::ArmError other = pose_error(work, work.stations[i], all[k].move, result);
    if (other.mm < 0.1 * own.mm + 0.3 && other.deg < 0.1 * own.deg + 0.1 && own.mm + own.deg > 5)
      return "rows swapped: its picture fits the pose of " + work.input.views[all_index[k]].picture.image;
  }
  return "its pose does not fit the others: " + figure(own.mm, 1) + " mm and " + figure(own.deg, 2) + " deg off";
}

HandEye leave_out_bad_poses(Work& work, HandEye result) {
  const Stations all = work.stations;
  const std::vector<std::size_t> all_index = work.index;
  const auto most = static_cast<std::size_t>(kMostLeftOut * static_cast<double>(all.size()));
  const Lens& lens = work.input.lens;
  // First against the robust start, so that no bad pose pulls at the fit; then one by one against the fit.
  for (bool fitted = false;; fitted = true) {
    while (all.size() - work.stations.size() < most && work.stations.size() > kFewest + 1) {
      const auto joint = detail::station_rms_px(lens, work.board_m, work.stations, result);
      std::vector<double> share, picture;
      for (std::size_t i = 0; i < joint.size(); ++i) {
        picture.push_back(work.stations[i].picture_rms_px);
        share.push_back(arm_share_px(joint[i], picture[i]));
      }
      const double allowed =
          (fitted ? 1 : 1.5) * kBadPoseFactor * std::max(*core::median(share), kLeastShare * *core::median(picture));
      const auto worst = std::max_element(share.begin(), share.end());
      if (*worst <= std::max(allowed, 0.15)) break;
      const auto i = static_cast<std::size_t>(worst - share.begin());
      work.leave_out(i, reason_of(work, i, result, all, all_index));
      if (fitted) result = detail::refine(lens, work.board_m, work.stations, result);
    }
    if (fitted) return result;
    result = detail::refine(lens, work.board_m, work.stations, result);
  }
}

/// Fits without a tenth of the pictures at a time.
struct Folds {
  double holdout_mm = std::numeric_limits<double>::quiet_NaN();
  std::vector<HandEye> fits;
};

Folds leave_out_in_turn(const Work& work, const HandEye& result) {
  const std::size_t n = work.stations.size(), folds = std::min<std::size_t>(n, 10);
  Folds out;
  if (n <= kFewest) return out;
  std::vector<detail::OnPlane> predicted;
  for (std::size_t fold = 0; fold < folds; ++fold) {
    Stations training, held_out;
    for (std::size_t i = 0; i < n; ++i) (i % folds != fold ? training : held_out).push_back(work.stations[i]);
    out.fits.push_back(detail::refine(work.input.lens, work.board_m, training, result));
    for (auto& p : detail::on_plane(work.input.lens, work.board_m, held_out, out.fits.back())) predicted.push_back(p);
  }
  out.holdout_mm = detail::mean_mm(predicted);
  return out;
}

/// What the camera's place is off by, as the fits without some pictures scatter (jackknife): the board, whose place is
/// fitted too, hides it from every residual. At the boards' mean place before the camera, across its axis and about it.
PickSigma sigma_of_camera(const Work& work, const HandEye& result, const std::vector<HandEye>& fits) {
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();
  const Eigen::Vector2d half = 0.5 * work.board_m.back();
  for (const Station& s : work.stations)
    middle += s.T_camera_board * Eigen::Vector3d(half.x(), half.y(), 0) / static_cast<double>(work.stations.size());
  double place2 = 0, turn2 = 0;
  for (const HandEye& fit : fits) {
    const Eigen::Isometry3d off = result.X.inverse() * fit.X;
    place2 += (off * middle - middle).head<2>().squaredNorm() / 2;
    turn2 += std::pow(std::atan2(off.linear()(1, 0), off.linear()(0, 0)), 2);
  }
  const double folds = std::max<double>(1, static_cast<double>(fits.size()));
  const double factor = (folds - 1) / folds;
  return {core::mm_from_m(std::sqrt(factor * place2)), core::deg_from_rad(std::sqrt(factor * turn2))};
}

/// The five solvers over the good poses, each refined from; the best refined one wins.
HandEye run_solvers(const Work& work, const HandEye& robust, HandeyeFit& out) {
  const auto total = [&](const HandEye& h) {
    double sum = 0;
    for (const double r : detail::station_rms_px(work.input.lens, work.board_m, work.stations, h)) sum += r * r;
    return sum;
  };
  HandEye best = robust;
  double least = total(robust);
  out.method = "PARK";  // the robust start is PARK's
  for (const detail::Solver solver : detail::kSolvers) {
    const auto solved = detail::solve(work.stations, solver);
    if (!solved) {
      out.by_method.emplace_back(name(solver), Spread{std::nan(""), std::nan("")});
      continue;
    }
    out.by_method.emplace_back(name(solver), detail::spread_of(detail::board_places(work.stations, solved->X)));
    const HandEye refined = detail::refine(work.input.lens, work.board_m, work.stations, *solved);
    if (const double t = total(refined); t < least * (1 - 1e-6)) {
      least = t;
      best = refined;
      out.method = name(solver);
    }
  }
  out.method += "+reprojection";
  return best;
}

void measure(const Work& work, const HandEye& result, HandeyeFit& out) {
  double sum_px = 0;
  std::size_t points = 0;
  std::vector<double> pictures;
  const auto on_plane = detail::on_plane(work.input.lens, work.board_m, work.stations, result);
  const auto arm = detail::arm_errors(work.input.lens, work.board_m, work.stations, result, work.input.mounting);
  for (std::size_t i = 0; i < work.stations.size(); ++i) {
    const Station& s = work.stations[i];
    HandeyeView v;
    v.image = work.image(i);
    v.view = s.view;
    v.residual_px = detail::residuals_px(work.input.lens, work.board_m, s, result);
    v.rms_px = detail::rms(v.residual_px);
    v.picture_rms_px = s.picture_rms_px;
    v.plane_error_mm = on_plane[i].mean_mm;
    v.arm_mm = arm.each[i].mm;
    v.arm_deg = arm.each[i].deg;
    sum_px += v.rms_px * v.rms_px * static_cast<double>(s.view.ids.size());
    points += s.view.ids.size();
    pictures.push_back(s.picture_rms_px);
    out.views.push_back(std::move(v));
  }
  out.rms_px = std::sqrt(sum_px / static_cast<double>(std::max<std::size_t>(1, points)));
  out.plane_error_mm = detail::mean_mm(on_plane);
  out.picture_rms_px = *core::median(pictures);
  out.spread = detail::spread_of(detail::board_places(work.stations, result.X));
  const Folds folds = leave_out_in_turn(work, result);
  out.holdout_mm = folds.holdout_mm;
  const PickSigma arm_sigma = detail::pick_sigma(on_plane), camera = sigma_of_camera(work, result, folds.fits);
  out.calibration.sigma = {std::hypot(arm_sigma.place_mm, camera.place_mm),
                           std::hypot(arm_sigma.turn_deg, camera.turn_deg)};
}

void fill_calibration(const Work& work, const HandEye& result, HandeyeFit& out) {
  HandeyeCalibration& c = out.calibration;
  if (work.input.mounting == Mounting::eye_in_hand) {
    c.T_flange_camera = core::Transform<core::Flange, core::Camera>(result.X);
    c.T_base_board = core::Transform<core::Base, core::Board>(result.Y);
  } else {
    c.T_base_camera = core::Transform<core::Base, core::Camera>(result.X);
    c.T_flange_board = core::Transform<core::Flange, core::Board>(result.Y);
  }
  c.spread_mm = out.spread.mm;
  c.plane_error_mm = out.plane_error_mm;
}

void judge_fit(HandeyeFit& out, bool poses_left_out) {
  Judgement verdict;
  if (!out.fault.empty()) verdict.add(Verdict::reject, out.fault);
  verdict.add(judge(out.rms_px, kJointPx), "joint reprojection " + figure(out.rms_px, 2) + " px");
  verdict.add(
      std::max(judge(out.spread.mm, kSpreadMm), judge(out.spread.deg, kSpreadDeg)),
      "the board's place scatters by " + figure(out.spread.mm, 2) + " mm, " + figure(out.spread.deg, 3) + " deg");
  verdict.add(judge(out.plane_error_mm, kPlaneMm), "plane error " + figure(out.plane_error_mm, 2) + " mm");
  verdict.add(judge(out.picture_rms_px, kPicturePx), "the pictures alone fit the camera calibration only to " +
                                                         figure(out.picture_rms_px, 2) +
                                                         " px (lens, board size or picture size is wrong)");
  std::string left_out;
  if (poses_left_out) {
    left_out = std::to_string(out.left_out.size()) + " left out: " + out.left_out.front().image + ": " +
               out.left_out.front().reason;
    verdict.add(Verdict::usable, left_out);
  }
  if (out.views.size() < 6) verdict.add(Verdict::usable, std::to_string(out.views.size()) + " pictures are few");
  out.calibration.verdict = verdict.verdict();
  out.why = verdict.why();
  if (poses_left_out && out.why.find(" left out: ") == std::string::npos) out.why += "; " + left_out;
}

/// Which part of the arm's poses disagrees, when nothing else explains the error.
std::string scatter_of_poses(const Work& work, const HandEye& result) {
  const auto size = detail::arm_errors(work.input.lens, work.board_m, work.stations, result, work.input.mounting).rms;
  return "pose error: the arm's poses are wrong by " + figure(size.mm, 2) + " mm and " + figure(size.deg, 3) +
         " deg (RMS)";
}

}  // namespace

core::Result<HandeyeFit> detail::fit_with_lens(const HandeyeInput& input) {
  auto started = begin(input);
  if (!started) return core::forward(started);
  Work& work = *started;
  if (auto fine = check_motions(work); !fine) return core::forward(fine);
  auto robust = detail::solve_robustly(input.lens, input.board, work.stations);
  if (!robust) return failure(ErrorCode::negative, "hand-eye", "no solver gives a result", "record the poses again");
  const Stations as_given = work.stations;
  HandeyeFit out;
  out.left_out = work.left_out;
  const std::size_t without_pose = work.left_out.size();
  const HandEye without_bad = leave_out_bad_poses(work, *robust);
  const HandEye result = run_solvers(work, without_bad, out);
  out.left_out = work.left_out;
  measure(work, result, out);
  judge_fit(out, out.left_out.size() > without_pose);
  // A fault of the whole set shows as poses that nothing fits: too many left out, or a bad result.
  if (out.calibration.verdict >= Verdict::usable) {
    const double median_px = *core::median(detail::station_rms_px(input.lens, work.board_m, as_given, *robust));
    if (auto e = detail::explain(input, as_given, std::max(median_px, out.rms_px)))
      out.fault = e->fault;
    else if (const std::string units = detail::suspicious_units(input.views); !units.empty())
      out.fault = units;
    judge_fit(out, out.left_out.size() > without_pose);
    const bool scattered =
        out.rms_px > kJointPx.good || out.spread.mm > kSpreadMm.good || out.spread.deg > kSpreadDeg.good;
    if (out.fault.empty() && scattered) out.why += "; " + scatter_of_poses(work, result);
  }
  fill_calibration(work, result, out);
  return out;
}

}  // namespace pickcell::poses
