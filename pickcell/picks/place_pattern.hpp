#pragma once
/// Where parts go: a grid of places in the base frame.

#include "pickcell/core/transform.hpp"

namespace pickcell::picks {

/// rows x cols places; slot i is row i / cols, column i % cols. Columns run along the pattern's x axis, rows along its
/// y axis.
struct PlacePattern {
  Eigen::Vector3d origin_m = Eigen::Vector3d::Zero();  ///< first place of the part's top face, base frame
  double angle_rad = 0;                                ///< of the pattern and of each part in it, about base z
  int rows = 1;
  int cols = 1;
  double pitch_x_m = 0;
  double pitch_y_m = 0;

  [[nodiscard]] int size() const { return rows * cols; }
  /// Wanted pose of the part in slot 0 <= slot < size(); throws std::out_of_range otherwise.
  [[nodiscard]] core::Transform<core::Base, core::Part> slot(int slot) const;
};

}  // namespace pickcell::picks
