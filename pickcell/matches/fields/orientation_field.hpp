#pragma once
/// Gradient orientation as a vector of the doubled angle: (gx^2 - gy^2, 2 gx gy). It is blind to polarity, so that a
/// part keeps its outline on bright and on dark ground, and it can be averaged without opposite edges cancelling. When
/// the picture turns by a (counter-clockwise on the screen), the vector turns by -2a in the mathematical sense: v' = v
/// * exp(-2 i a).

#include <cstdint>

#include "pickcell/image/image.hpp"

namespace pickcell::matches {

/// Gradient energy that counts as an edge of half weight: the field is v / (|g|^2 + kEdgeGrey^2), grey values per
/// pixel.
constexpr float kEdgeGrey = 8.f;

/// One row of the unnormalised field, by central differences; at the border a pixel's missing neighbour is the pixel
/// itself.
struct TensorRow {
  float* c2;      ///< gx^2 - gy^2
  float* s2;      ///< 2 gx gy
  float* energy;  ///< gx^2 + gy^2
};
/// Arrays must have room for kTensorSlack values beyond the picture's width. The picture must be a Plane's.
constexpr int kTensorSlack = 16;
void orientation_tensor_row(image::ImageView picture, int y, const TensorRow& out);

/// Rows first .. last, the first and the last with a share of themselves.
struct RowShares {
  int first, last;
  float first_share, last_share;
  [[nodiscard]] float of(int y) const { return y == first ? first_share : y == last ? last_share : 1.f; }
};
/// The rows' values, each times its share, summed down the columns.
void sum_tensors(image::ImageView picture, const RowShares& rows, const TensorRow& sums);

/// Normalised field, smoothed by 1-2-1 in both directions, as pairs (c2, s2) of bytes: +-127 is +-1. The plane is twice
/// as wide as the picture.
using OrientationField = image::Plane<std::int8_t>;

/// Rounds to nearest; all SIMD targets agree within one unit. The picture must be a Plane's.
void orientation_field(image::ImageView picture, OrientationField& out);

/// The same for the pixels x0 <= x < x1, y0 <= y < y1 only, at most kFieldPartWidth wide and kFieldPartHeight high.
/// With the pixels around it a part is 32 wide: whole vectors of every SIMD target. out has the picture's size.
constexpr int kFieldPartWidth = 30;
constexpr int kFieldPartHeight = 30;
struct FieldPart {
  int x0, y0, x1, y1;
};
void orientation_field_part(image::ImageView picture, const FieldPart& part, OrientationField& out);

}  // namespace pickcell::matches
