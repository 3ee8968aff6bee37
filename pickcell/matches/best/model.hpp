#pragma once
/// Everything that engine best derives from a model, once.

#include <array>
#include <vector>

#include "pickcell/matches/best/settings.hpp"
#include "pickcell/matches/coarse/template.hpp"
#include "pickcell/matches/fields/template_pyramid.hpp"
#include "pickcell/matches/fit/final_fit.hpp"
#include "pickcell/matches/fit/refine.hpp"
#include "pickcell/matches/rotated_rect.hpp"

namespace pickcell::matches {

struct BestModel {
  const Model* model = nullptr;
  Range scale{1, 1};
  TemplatePyramid pyramid;
  std::vector<LevelModel> levels;  ///< 0 .. the coarsest level that refinement starts from
  FinalPoints final_points;
  std::vector<CoarseTemplates> quick;     ///< per band of the scale range
  std::vector<CoarseTemplates> wide;      ///< built when first needed: empty before
  std::vector<CoarseTemplates> thorough;  ///< the same
  double side_px = 0;                     ///< sqrt of the mask's area
  /// Box of the mask relative to the anchor, pixels: its outer edges.
  double x_lo = 0, x_hi = 0, y_lo = 0, y_hi = 0;
  double ref_dx = 0, ref_dy = 0;  ///< the model's reference point relative to the anchor

  [[nodiscard]] RotatedRect outline(const Similarity& place) const;
};

[[nodiscard]] BestModel prepare_model(const Model& model, Range scale, const BestSettings& settings);

/// The pyramid level at which candidates of this top level are first refined.
[[nodiscard]] int start_level(const CoarseTemplates& t);

}  // namespace pickcell::matches
