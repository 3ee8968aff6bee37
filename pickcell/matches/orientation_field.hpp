#pragma once
/// Gradient orientation as a vector of the doubled angle: (gx^2 - gy^2, 2 gx gy). It is blind to polarity, so that a
/// part keeps its outline on bright and on dark ground, and it can be averaged without opposite edges cancelling. When
/// the picture turns by a (counter-clockwise on the screen), the vector turns by -2a in the mathematical sense: v' = v
/// * exp(-2 i a).

#include <cstdint>

#include "pickcell/image/image.hpp"

namespace pickcell::matches {

/// Gradient energy that counts as an edge of full weight: the field is v / (|g|^2 + kEdgeGrey^2), grey values per
/// pixel.
constexpr float kEdgeGrey = 8.f;

/// Unnormalised field of a picture by central differences; border pixels take the difference to themselves as zero.
struct OrientationTensor {
  image::Plane<float> c2;      ///< gx^2 - gy^2
  image::Plane<float> s2;      ///< 2 gx gy
  image::Plane<float> energy;  ///< gx^2 + gy^2
};

void orientation_tensor(image::ImageView picture, OrientationTensor& out);

/// Normalised field, smoothed by 1-2-1 in both directions, as pairs (c2, s2) of bytes: +-127 is +-1. Width of the plane
/// is twice the picture's.
using OrientationField = image::Plane<std::int8_t>;

void orientation_field(image::ImageView picture, OrientationField& out);

/// One row of the tensor into arrays of the picture's width.
struct TensorRow {
  float* c2;
  float* s2;
  float* energy;
};
void orientation_tensor_row(image::ImageView picture, int y, const TensorRow& out);

}  // namespace pickcell::matches
