#pragma once
/// The template's orientation field at the top level, turned and scaled: what the coarse search correlates with.

#include <cstdint>
#include <vector>

#include "pickcell/matches/coarse/kernel.hpp"
#include "pickcell/matches/fields/template_pyramid.hpp"
#include "pickcell/matches/model.hpp"

namespace pickcell::matches {

/// Four neighbouring angles at one scale.
struct CoarseTile {
  int scale_index = 0;
  int first_angle = 0;
  std::vector<std::int16_t> dx;  ///< cells from the anchor's cell, per tap (a cell and its right neighbour)
  std::vector<std::int16_t> dy;
  std::vector<std::int8_t> weights;  ///< 16 per tap, see FourTemplates
  std::int32_t bias[4] = {};
  float norm[4] = {};  ///< 1 / (127 sum |weight|): the score of a perfect edge picture is 1
  /// A position x sees at least a share of the template when -left <= x <= width - 1 - right (same for y).
  struct Sides {
    int left = 0, right = 0, top = 0, bottom = 0;
  };
  Sides found;  ///< the share that a match must show
  Sides named;  ///< the share from which a part at the border is still told
  /// Share of the weight left of and above each line of cells, from -reach on: 0 to 1.
  std::vector<float> left_of, above;
};

struct CoarseTemplates {
  double factor = 1;  ///< pixels per cell
  int angles = 4;     ///< of the full circle, a multiple of 4; angle k is 2 pi k / angles
  std::vector<double> scales;
  int reach = 0;                  ///< furthest tap from the anchor, cells
  std::vector<CoarseTile> tiles;  ///< tile s * (angles / 4) + j: scale s, angles 4j..4j+3
  int side = 0;                   ///< sqrt of the mask's area in cells, about

  /// Million dot products of four bytes for a picture of 640 x 480.
  [[nodiscard]] double work() const;
};

/// How fine the top level is: pixels per cell is the smallest of these, at least 1.
struct CoarseDetail {
  double side_cells = 12;   ///< sqrt(width * height) of the template
  double short_cells = 8;   ///< its shorter side
  double mask_cells = 6;    ///< sqrt(mask area), masked templates only: thin parts need a finer level
  double angle_step = 1.2;  ///< cells at the rim of a square of the same rms radius
  double scale_step = 1.8;  ///< cells at that rim
  double min_visible = 0.7;
  /// Limit on the work in a picture of 640 x 480, million dot products of four bytes: where it would be more (long
  /// parts, thin ones), the cells are made larger. The work goes with about the fifth power of their number.
  double most_work = 150;
};

[[nodiscard]] double choose_factor(const TemplatePyramid& t, const CoarseDetail& detail);
/// The detail is that of the scale nearest to the taught one.
[[nodiscard]] CoarseTemplates build_coarse_templates(const TemplatePyramid& t, const CoarseDetail& detail, Range scale);

/// A wide range cut into bands of the same ratio, each with a top level of its own: cells that suit the largest scale
/// would leave too few on a part of the smallest.
[[nodiscard]] std::vector<CoarseTemplates> build_coarse_bands(const TemplatePyramid& t, const CoarseDetail& detail,
                                                              Range scale);

}  // namespace pickcell::matches
