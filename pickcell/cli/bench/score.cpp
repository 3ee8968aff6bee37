#include "pickcell/cli/bench/score.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numeric>

namespace pickcell::cli {

namespace {

constexpr double kCorrectPx = 3;
constexpr double kCorrectOfDiagonal = 0.03;
constexpr double kCorrectDeg = 3;
constexpr double kCorrectScalePct = 5;
constexpr double kLooseOfSide = 0.1;
constexpr double kLooseDeg = 10;
constexpr double kStrictPx = 1;
constexpr double kStrictDeg = 1;
/// A limit that is met exactly is met, although the error was computed in floating point.
constexpr double kRounding = 1e-9;

std::string describe(const PoseError& error) {
  char text[96];
  std::snprintf(text, sizeof text, "off by %.1f px, %.1f deg, %.1f %% scale", error.position_px, error.angle_deg,
                error.scale_pct);
  return text;
}

void conclude(ImageScore& score, double diagonal_px) {
  score.correct = score.hits.size() == score.truths && score.matches == score.truths;
  score.strict = score.correct && std::all_of(score.hits.begin(), score.hits.end(),
                                              [&](const Hit& hit) { return is_strict(hit.error, diagonal_px); });
}

}  // namespace

PoseError pose_error(const matches::Pose2d& found, const TruthPose& truth, double symmetry_deg) {
  return {std::hypot(found.x_px - truth.x_px, found.y_px - truth.y_px),
          std::abs(std::remainder(found.angle_deg - truth.angle_deg, symmetry_deg)),
          100 * std::abs(found.scale / truth.scale - 1)};
}

bool is_correct(const PoseError& error, double diagonal_px) {
  return error.position_px <= std::max(kCorrectPx, kCorrectOfDiagonal * diagonal_px) + kRounding &&
         error.angle_deg <= kCorrectDeg + kRounding && error.scale_pct <= kCorrectScalePct + kRounding;
}

bool is_strict(const PoseError& error, double diagonal_px) {
  return is_correct(error, diagonal_px) && error.position_px <= kStrictPx + kRounding &&
         error.angle_deg <= kStrictDeg + kRounding;
}

bool is_loose(const PoseError& error, double shorter_side_px) {
  return error.position_px <= kLooseOfSide * shorter_side_px + kRounding && error.angle_deg <= kLooseDeg + kRounding;
}

ImageScore score_one(std::span<const matches::Match> found, const TruthPose& truth, double diagonal_px,
                     double symmetry_deg) {
  ImageScore score;
  score.truths = 1;
  score.matches = std::min<std::size_t>(found.size(), 1);
  if (found.empty()) {
    score.why = "no match";
    return score;
  }
  const auto best =
      std::max_element(found.begin(), found.end(), [](const auto& a, const auto& b) { return a.score < b.score; });
  const PoseError error = pose_error(best->pose, truth, symmetry_deg);
  if (is_correct(error, diagonal_px))
    score.hits.push_back({static_cast<std::size_t>(best - found.begin()), 0, error});
  else
    score.why = describe(error);
  conclude(score, diagonal_px);
  return score;
}

ImageScore score_instances(std::span<const matches::Match> found, std::span<const TruthPose> truths, double diagonal_px,
                           double symmetry_deg) {
  ImageScore score;
  score.truths = truths.size();
  score.matches = found.size();
  std::vector<std::size_t> order(found.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](auto a, auto b) { return found[a].score > found[b].score; });
  std::vector<bool> taken(truths.size(), false);
  for (const std::size_t m : order) {
    std::optional<Hit> nearest;
    for (std::size_t t = 0; t < truths.size(); ++t) {
      const PoseError error = pose_error(found[m].pose, truths[t], symmetry_deg);
      if (taken[t] || !is_correct(error, diagonal_px)) continue;
      if (!nearest || error.position_px < nearest->error.position_px) nearest = Hit{m, t, error};
    }
    if (!nearest) continue;
    taken[nearest->truth] = true;
    score.hits.push_back(*nearest);
  }
  conclude(score, diagonal_px);
  if (!score.correct)
    score.why = std::to_string(score.truths - score.hits.size()) + " of " + std::to_string(score.truths) +
                " not found, " + std::to_string(score.matches - score.hits.size()) + " wrong";
  return score;
}

}  // namespace pickcell::cli
