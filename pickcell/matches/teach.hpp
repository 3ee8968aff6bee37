#pragma once
/// Makes a Model from a picture of one part.

#include <optional>
#include <string>
#include <vector>

#include "pickcell/core/result.hpp"
#include "pickcell/image/image.hpp"
#include "pickcell/matches/engine.hpp"
#include "pickcell/matches/model.hpp"

namespace pickcell::matches {

/// What the user says about the part. All places in pixels of the whole picture, before the ROI is cut.
struct TeachInput {
  struct Point {
    double x_px, y_px;
  };

  std::string name;
  std::string date;                       ///< ISO 8601, UTC; kept as it is
  image::ImageView picture;               ///< of the whole TEMPLATE.png
  std::optional<image::ImageView> mask;   ///< of the picture's size or the ROI's; >= 128 is part
  std::optional<SearchOptions::Roi> roi;  ///< must lie inside the picture
  std::optional<Point> ref_px;            ///< default: centre of the ROI
  std::vector<Grasp> grasps;
  Range angle_deg{-180, 180};
  Range scale{1, 1};
  double height_m = 0;
};

/// Something the user should know about a part that can be taught all the same.
struct TeachWarning {
  std::string code;  ///< small, thin, low_contrast, one_direction, symmetric, ambiguous
  std::string text;
};

struct Taught {
  Model model;
  std::vector<TeachWarning> warnings;
  double teach_ms = 0;
};

/// Refuses, as usage errors: a ROI outside the picture, a mask of another size or without any part, ranges that are
/// reversed, not finite or absurd, a template without features (inside its mask) or with fewer than kMinPartPixels.
/// Thread-safe.
[[nodiscard]] core::Result<Taught> teach(const TeachInput& input);

constexpr int kMinPartPixels = 64;

}  // namespace pickcell::matches
