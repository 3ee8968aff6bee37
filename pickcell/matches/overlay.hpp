#pragma once
/// A picture for people: what was found, where, how sure, and what was turned down.

#include <span>

#include "pickcell/image/image.hpp"
#include "pickcell/image/rgb_image.hpp"
#include "pickcell/matches/engine.hpp"
#include "pickcell/matches/model.hpp"

namespace pickcell::matches {

/// For every match: the template's rotated outline (with a mask the part's contour strong and the rectangle faint), the
/// reference point, the template's x axis as an arrow, the model's name and the score. FindResult::rejected is drawn
/// dimmed with its reason, the best few only. models: the list that was searched for; Match::model_index must lie in
/// it.
[[nodiscard]] image::RgbImage draw_overlay(image::ImageView scene, const FindResult& found,
                                           std::span<const Model* const> models);

/// Where a template point lies in the scene (the convention of Pose2d).
struct ScenePoint {
  double x_px, y_px;
};
[[nodiscard]] ScenePoint to_scene(const Model& model, const Pose2d& pose, double template_x_px, double template_y_px);

}  // namespace pickcell::matches
