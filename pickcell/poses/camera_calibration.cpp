#include "pickcell/poses/camera_calibration.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "pickcell/core/statistics.hpp"
#include "pickcell/poses/board_pose.hpp"
#include "pickcell/poses/lens_fit.hpp"
#include "pickcell/poses/verdicts.hpp"
#include "pickcell/poses/view_coverage.hpp"

namespace pickcell::poses {

namespace {

using core::ErrorCode;
using core::failure;

constexpr std::size_t kFewestViews = 3;
constexpr double kSameViewPx = 0.5;     ///< mean distance of points below which a picture repeats another
constexpr double kBadViewFactor = 2.5;  ///< times the median RMS of the pictures
constexpr double kBadViewPx = 0.3;      ///< and at least this
constexpr double kSimplerIsBetter = 1.02;
constexpr std::size_t kFolds = 5;

constexpr Bounds kHoldoutPx{0.1, 0.2, 0.5};
constexpr Bounds kMissingCoverage{0.4, 0.6, 0.85};  ///< share of the picture that no board reaches
constexpr Bounds kSigmaFocal{0.001, 0.003, 0.01};   ///< of the focal length
constexpr Bounds kViewsShort{-12, -8, -4};          ///< minus the number of views

/// Mean distance of the points that both views have; nothing when they have less than half in common.
std::optional<double> distance_px(const BoardView& a, const BoardView& b) {
  double sum = 0;
  std::size_t n = 0;
  for (std::size_t i = 0, j = 0; i < a.ids.size() && j < b.ids.size();) {
    if (a.ids[i] == b.ids[j]) {
      sum += (a.pixels[i++] - b.pixels[j++]).norm();
      ++n;
    } else if (a.ids[i] < b.ids[j]) {
      ++i;
    } else {
      ++j;
    }
  }
  if (2 * n < std::max(a.ids.size(), b.ids.size())) return std::nullopt;
  return sum / static_cast<double>(n);
}

/// Moves pictures that repeat an earlier one to left_out.
void drop_repeated(std::vector<NamedView>& views, std::vector<LeftOut>& left_out) {
  std::vector<NamedView> kept;
  for (NamedView& v : views) {
    const auto same = std::find_if(kept.begin(), kept.end(), [&](const NamedView& k) {
      const auto d = distance_px(v.view, k.view);
      return d && *d < kSameViewPx;
    });
    if (same == kept.end())
      kept.push_back(std::move(v));
    else
      left_out.push_back({v.image, "shows the same view as " + same->image});
  }
  views = std::move(kept);
}

core::Status enough(const std::vector<NamedView>& views, const std::vector<LeftOut>& left_out) {
  if (views.size() >= kFewestViews) return {};
  const bool repeated = std::any_of(left_out.begin(), left_out.end(),
                                    [](const LeftOut& l) { return l.reason.find("same view") != std::string::npos; });
  return failure(
      ErrorCode::negative, "camera",
      std::string("too few views: ") + std::to_string(views.size()) +
          (repeated ? " different pictures show the board, the others repeat them" : " pictures show the board"),
      "take at least 3, better 12, from different directions");
}

/// RMS over views that took no part in the fit: every kFolds-th is held out in turn.
std::optional<double> holdout_rms_px(const Board& board, const std::vector<NamedView>& views, LensModel model) {
  const std::size_t folds = std::min(kFolds, views.size());
  double sum = 0;
  std::size_t count = 0;
  for (std::size_t fold = 0; fold < folds; ++fold) {
    std::vector<NamedView> training;
    for (std::size_t i = 0; i < views.size(); ++i)
      if (i % folds != fold) training.push_back(views[i]);
    const auto fit = fit_lens(board, training, model);
    if (!fit) return std::nullopt;
    for (std::size_t i = fold; i < views.size(); i += folds) {
      const auto pose = board_pose(fit->lens, board, views[i].view);
      if (!pose) return std::nullopt;
      sum += pose->rms_px * pose->rms_px * static_cast<double>(views[i].view.ids.size());
      count += views[i].view.ids.size();
    }
  }
  return std::sqrt(sum / static_cast<double>(count));
}

struct Choice {
  LensModel model = LensModel::brown5;
  double holdout_rms_px = 0;
  std::vector<ModelTrial> trials;
};

core::Result<Choice> choose_model(const Board& board, const std::vector<NamedView>& views) {
  Choice out;
  std::vector<std::pair<LensModel, double>> tried;
  for (const LensModel model : kLensModels) {
    const auto rms = holdout_rms_px(board, views, model);
    if (!rms) continue;
    tried.emplace_back(model, *rms);
    out.trials.push_back({name(model), *rms});
  }
  if (tried.empty())
    return failure(ErrorCode::negative, "camera", "no lens fits the pictures",
                   "take pictures from more directions, with the board in every part of the picture");
  const double best = std::min_element(tried.begin(), tried.end(), [](const auto& a, const auto& b) {
                        return a.second < b.second;
                      })->second;
  const auto simplest = std::find_if(tried.begin(), tried.end(),
                                     [&](const auto& t) { return t.second <= best * kSimplerIsBetter + 1e-3; });
  out.model = simplest->first;
  out.holdout_rms_px = simplest->second;
  return out;
}

/// Fits, and while one picture stands out, leaves it out and fits again. A wrong view bends the fit towards itself, so
/// a view counts as wrong by its distance from the median.
core::Result<LensFit> fit_without_bad_views(const Board& board, std::vector<NamedView>& views, LensModel model,
                                            std::vector<LeftOut>& left_out) {
  while (true) {
    auto fit = fit_lens(board, views, model);
    if (!fit || views.size() <= kFewestViews + 1) return fit;
    std::vector<double> rms;
    for (const CameraView& v : fit->views) rms.push_back(v.rms_px);
    const double usual = *core::median(rms);
    const auto worst = std::max_element(rms.begin(), rms.end());
    if (*worst <= std::max(kBadViewPx, kBadViewFactor * usual)) return fit;
    const auto index = worst - rms.begin();
    left_out.push_back(
        {views[static_cast<std::size_t>(index)].image,
         "does not fit the others: " + figure(*worst, 2) + " px RMS, the others " + figure(usual, 2) + " px"});
    views.erase(views.begin() + index);
  }
}

void judge_fit(CameraFit& out, const LensFit& fit) {
  Judgement verdict;
  const double holdout = out.calibration.holdout_rms_px;
  verdict.add(judge(holdout, kHoldoutPx), "hold-out error " + figure(holdout, 3) + " px");
  verdict.add(judge(1 - out.coverage, kMissingCoverage),
              "the boards cover " + figure(100 * out.coverage, 0) + " % of the picture");
  const double sigma = std::max(fit.sigma.fx_px / fit.lens.fx_px, fit.sigma.fy_px / fit.lens.fy_px);
  verdict.add(judge(sigma, kSigmaFocal), "focal length known to " + figure(100 * sigma, 2) + " %");
  const Verdict tilts = out.largest_tilt_deg < 5    ? Verdict::reject
                        : out.largest_tilt_deg < 10 ? Verdict::usable
                        : out.tilt_range_deg < 15   ? Verdict::good
                                                    : Verdict::excellent;
  verdict.add(tilts, "the board is inclined by at most " + figure(out.largest_tilt_deg, 0) + " degrees");
  verdict.add(judge(-static_cast<double>(out.views.size()), kViewsShort), std::to_string(out.views.size()) + " views");
  out.calibration.verdict = verdict.verdict();
  out.why = verdict.why();
  if (out.calibration.verdict != Verdict::excellent && !out.advice.empty()) out.why += "; " + out.advice.front();
}

}  // namespace

core::Result<CameraFit> calibrate_camera(const Board& board, std::vector<NamedView> views) {
  CameraFit out;
  drop_repeated(views, out.left_out);
  if (auto fine = enough(views, out.left_out); !fine) return core::forward(fine);
  // The first pass finds the bad views with a model that fits most lenses; they must not choose the model.
  auto first = fit_without_bad_views(board, views, LensModel::brown5, out.left_out);
  if (!first) return core::forward(first);
  auto choice = choose_model(board, views);
  if (!choice) return core::forward(choice);
  auto fit = fit_without_bad_views(board, views, choice->model, out.left_out);
  if (!fit) return core::forward(fit);
  if (auto fine = enough(views, out.left_out); !fine) return core::forward(fine);
  out.calibration.lens = fit->lens;
  out.calibration.model = name(choice->model);
  out.calibration.rms_px = fit->rms_px;
  out.calibration.holdout_rms_px = choice->holdout_rms_px;
  out.trials = choice->trials;
  out.sigma = fit->sigma;
  const ViewCoverage coverage = view_coverage(fit->views);
  out.coverage = coverage.area;
  out.tilt_range_deg = coverage.tilt_range_deg;
  out.largest_tilt_deg = coverage.largest_tilt_deg;
  out.advice = coverage.advice;
  out.views = fit->views;
  judge_fit(out, *fit);
  return out;
}

}  // namespace pickcell::poses
