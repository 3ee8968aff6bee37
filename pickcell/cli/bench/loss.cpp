#include "pickcell/cli/bench/loss.hpp"

#include <algorithm>
#include <cstdio>
#include <optional>

#include "pickcell/cli/bench/score.hpp"

namespace pickcell::cli {

core::Result<Loss> explain_loss(matches::Engine& engine, const image::Pyramid& picture, const matches::Model& model,
                                const TruthPose& truth, double symmetry_deg, matches::SearchOptions how) {
  how.explain = true;
  how.watch = matches::Pose2d{truth.x_px, truth.y_px, truth.angle_deg, truth.scale};
  const matches::Model* one[] = {&model};
  auto found = engine.find(picture, one, how);
  if (!found) return core::forward(found);
  const double side_px = std::min(model.picture.width(), model.picture.height());
  const matches::Rejected* last = nullptr;
  for (const matches::Rejected& r : found->rejected) {
    PoseError error = pose_error(r.match.pose, truth, symmetry_deg);
    // The circular filter has no angle yet; one that the radial filter turned down has none that counts.
    if (r.stage == matches::Stage::circular || r.stage == matches::Stage::radial) error.angle_deg = 0;
    const bool further =
        !last || r.stage > last->stage || (r.stage == last->stage && r.match.score > last->match.score);
    if (is_loose(error, side_px) && further) last = &r;
  }
  if (!last) return Loss{"none", "no candidate near the true pose; something else was found or nothing"};
  char score[32];
  std::snprintf(score, sizeof score, ", score %.3f", last->match.score);
  return Loss{matches::name(last->stage), matches::name(last->reason) + std::string(score)};
}

}  // namespace pickcell::cli
