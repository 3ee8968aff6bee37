#include "pickcell/matches/best/turns.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

#include "pickcell/matches/best/follow.hpp"
#include "pickcell/matches/limits.hpp"

namespace pickcell::matches {
namespace {

constexpr double kSide_px = 40;       // of the part at the level of the sweep, at least
constexpr double kBeyond_deg = 6;     // a maximum at the end of the allowed range is one
constexpr double kFew_deg = 4;        // angles this near are the same
constexpr std::size_t kClimbed = 24;  // maxima of the sweep: a gear has one at each tooth
constexpr std::size_t kFollowed = 4;  // of those, to full resolution
constexpr int kSteps = 3;
constexpr double kOffCentre_px = 0.25;  // at the level of the sweep: turns about this are found without looking again
constexpr double kHopeless = 0.25;      // of the score below what the sweep saw at the found angle
constexpr double kWorse = 0.1;          // the same, once a turn has been refined there

int sweep_level(const BestModel& model, const BestScene& scene) {
  int level = 0;
  while (level + 1 < static_cast<int>(model.levels.size()) && level + 1 < scene.levels() &&
         model.side_px / (2 << level) >= kSide_px)
    ++level;
  return level;
}

using Offset = std::complex<double>;  ///< x + iy, pixels of level 0

/// How far the anchor moves, in parts of the offset from it to the centre, when the part turns about that centre.
Offset swing(double by_rad) { return 1.0 - std::polar(1.0, -by_rad); }

Similarity turned(Similarity s, double by_rad, Offset centre) {
  const Offset moved = swing(by_rad) * centre;
  s.angle_rad = wrap_rad(s.angle_rad + by_rad);
  s.x_px += moved.real();
  s.y_px += moved.imag();
  return s;
}

/// The centre of a part that looks alike when turned, as those turns say: least squares over where they settled.
Offset centre_of(const Hypothesis& found, std::span<const Hypothesis> turns, double least_score) {
  Offset sum = 0;
  double weight = 0;
  for (const Hypothesis& t : turns) {
    if (t.score < least_score) continue;
    const Offset s = swing(t.place.angle_rad - found.place.angle_rad);
    sum += std::conj(s) * Offset(t.place.x_px - found.place.x_px, t.place.y_px - found.place.y_px);
    weight += std::norm(s);
  }
  return weight > 0 ? sum / weight : 0;
}

/// Local maxima of the score over the circle about a centre, best first, the found angle left out.
std::pmr::vector<Hypothesis> sweep(const Hypothesis& found, Offset centre, const SceneLevel& level,
                                   const LevelModel& model, Range allowed_deg, RefineScratch& scratch,
                                   WorkBudget& budget, std::pmr::memory_resource* memory) {
  const int n = std::clamp(static_cast<int>(2 * std::numbers::pi * static_cast<double>(model.grey.radius)), 24, 360);
  std::pmr::vector<Hypothesis> circle(memory), peaks(memory);
  circle.reserve(static_cast<std::size_t>(n));
  for (int i = 0; i < n; ++i) {
    if (budget.spent()) return peaks;
    const Similarity place = turned(found.place, 2 * std::numbers::pi * i / n, centre);
    const bool allowed = i == 0 || angle_in_range(place.angle_rad * kDegPerRad, allowed_deg, kBeyond_deg);
    circle.push_back(allowed ? evaluate(level, model, place, scratch) : Hypothesis{});
  }
  const double least = circle[0].score - kHopeless;
  for (int i = 0; i < n; ++i) {
    const Hypothesis& h = circle[static_cast<std::size_t>(i)];
    const double before = circle[static_cast<std::size_t>((i + n - 1) % n)].score;
    const double after = circle[static_cast<std::size_t>((i + 1) % n)].score;
    const double from_found = 360.0 * std::min(i, n - i) / n;
    if (h.score >= before && h.score > after && h.score > least && from_found > kFew_deg) peaks.push_back(h);
  }
  sort_best_first(peaks);
  if (peaks.size() > kClimbed) peaks.resize(kClimbed);
  return peaks;
}

}  // namespace

std::pmr::vector<Hypothesis> settled_turns(const Hypothesis& found, const BestModel& model, Range allowed_deg,
                                           BestScene& scene, RefineScratch& scratch, WorkBudget& budget,
                                           std::pmr::memory_resource* memory) {
  const int l = sweep_level(model, scene);
  const SceneLevel level = scene.level(l);
  const LevelModel& at_level = model.levels[static_cast<std::size_t>(l)];
  std::pmr::vector<Hypothesis> out({found}, memory);
  const Hypothesis here = evaluate(level, at_level, found.place, scratch);
  const auto climbed = [&](Offset centre) {
    auto turns = sweep(found, centre, level, at_level, allowed_deg, scratch, budget, memory);
    for (Hypothesis& turn : turns)
      if (!budget.spent()) turn = climb(level, at_level, turn.place, model.scale, kSteps, scratch);
    return turns;
  };
  std::pmr::vector<Hypothesis> turns = climbed(0);
  // A part without symmetry has its anchor elsewhere than its near-symmetric outline its centre: a gear with a notch,
  // turned by half about the anchor, lies beside its teeth, and the sweep sees nothing there.
  const Offset centre = centre_of(found, turns, here.score - kWorse);
  if (std::abs(centre) > std::ldexp(kOffCentre_px, l)) turns = climbed(centre);
  sort_best_first(turns);
  if (turns.size() > kFollowed) turns.resize(kFollowed);
  for (const Hypothesis& near : turns) {
    if (budget.spent()) break;
    if (near.score < here.score - kWorse) continue;
    const Hypothesis exact = settle(scene.level(0), model.levels[0], near.place, model.scale, scratch);
    out.push_back(polish(scene.level(0), model.levels[0], exact, model.scale, scratch));
  }
  sort_best_first(out);
  return out;
}

}  // namespace pickcell::matches
