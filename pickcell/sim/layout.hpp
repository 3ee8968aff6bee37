#pragma once
/// Parts laid on a plane without touching each other.

#include <vector>

#include "pickcell/sim/part_texture.hpp"
#include "pickcell/sim/random.hpp"

namespace pickcell::sim {

/// A part on the plane: its origin in mm (x right, y up), angle counter-clockwise.
struct LaidPart {
  const PartTexture* part = nullptr;
  Point2 at_mm = Point2::Zero();
  double angle_deg = 0;
  double scale = 1;

  /// A point of the plane in the part's frame, and back.
  [[nodiscard]] Point2 to_part(const Point2& plane_mm) const;
  [[nodiscard]] Point2 to_plane(const Point2& part_mm) const;
};

/// Distance between two outlines, mm: about 0.5 mm exact up to 14 mm, a lower bound beyond; negative when they overlap.
[[nodiscard]] double gap_mm(const LaidPart& a, const LaidPart& b);

/// Fraction of a's face that b covers, 0..1.
[[nodiscard]] double covered_fraction(const LaidPart& a, const LaidPart& b);

/// Smallest axis-parallel box around the part on the plane.
[[nodiscard]] Box2 extent_mm(const LaidPart& laid);

/// Turns and moves the part by chance until its extent lies inside the box and it keeps the gap to all others; false
/// when that does not succeed in the given number of tries.
bool lay_at_random(LaidPart& laid, const Box2& inside, const std::vector<LaidPart>& others, double gap, Random& random,
                   int tries = 200);

}  // namespace pickcell::sim
