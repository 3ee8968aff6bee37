#pragma once
/// A taught part: everything that a PART.pcm holds. What an engine derives from it is cached by the engine, not stored
/// here.

#include <optional>
#include <string>
#include <vector>

#include "pickcell/image/image.hpp"

namespace pickcell::matches {

/// Closed range; angles in degrees may cross 180 (lo 170, hi 190).
struct Range {
  double lo = 0;
  double hi = 0;
};

/// Where a gripper may take the part, in template pixels; angle: direction of the tool's X axis, counter-clockwise.
struct Grasp {
  double x_px = 0;
  double y_px = 0;
  double angle_deg = 0;
  bool sym180 = false;  ///< two-finger gripper: angle + 180 is the same grasp
};

/// What teaching found out about the template (docs/interfaces.md, teach --json).
struct Learnt {
  int symmetry_order = 1;
  std::vector<double> ambiguous_deg;  ///< offsets at which the part looks nearly the same
  double second_best_self_match = 0;  ///< best score of the model against itself elsewhere
  double suggested_min_score = 0.5;
};

struct Model {
  std::string name;
  std::string date;      ///< ISO 8601, UTC
  image::Image picture;  ///< cut to the ROI
  image::Image mask;     ///< same size; >= 128 is part; empty: everything
  double ref_x_px = 0;   ///< reference point in pixels of picture (after the cut)
  double ref_y_px = 0;
  double roi_x_px = 0;  ///< place of picture in TEMPLATE.png
  double roi_y_px = 0;
  Range angle_deg{-180, 180};
  Range scale{1, 1};
  double height_m = 0;        ///< of the matched surface above the work plane
  std::vector<Grasp> grasps;  ///< in pixels of picture (after the cut)
  Learnt learnt;
};

}  // namespace pickcell::matches
