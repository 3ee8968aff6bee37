#pragma once
/// The picture at the top level of the search: its orientation field, averaged over cells of any real size.

#include <cstdint>
#include <vector>

#include "pickcell/image/pyramid.hpp"
#include "pickcell/matches/work.hpp"

namespace pickcell::matches {

/// Cells of factor x factor pixels; cell (X, Y) has its centre at ((X + 0.5) factor - 0.5, ...). Every cell carries its
/// own field and its right neighbour's, as the kernel wants them: bytes c2, s2, c2, s2, each 128 + 127 v; zeros (128)
/// all around, so that a template may hang over the border.
struct CoarseScene {
  double factor = 0;
  int width = 0;
  int height = 0;
  int margin = 0;
  image::Plane<std::uint32_t> cells;  ///< with the margin

  /// Which source pixels make a cell along one axis: whole ones between two partial ones.
  struct Share {
    int first, last;
    float first_share, last_share;
  };
  /// Work space of build_coarse_scene, kept for the next picture.
  std::vector<Share> columns, rows;
  std::vector<float> sums;

  /// A cell, which may lie up to margin cells outside.
  [[nodiscard]] const std::uint32_t* at(int x, int y) const { return cells.row(y + margin) + (x + margin); }
  [[nodiscard]] int stride() const { return static_cast<int>(cells.stride()); }
};

/// The pyramid level that the field is taken from: two to four pixels per cell, or level 0.
[[nodiscard]] int field_level(double factor);

/// v = mean(c2, s2) / (mean energy + kEdgeGrey^2) over each cell. margin: how far outside a position's taps may reach.
/// False when the budget was spent before the end: then there is no field.
[[nodiscard]] bool build_coarse_scene(const image::Pyramid& scene, double factor, int margin, WorkBudget& budget,
                                      CoarseScene& out);

}  // namespace pickcell::matches
