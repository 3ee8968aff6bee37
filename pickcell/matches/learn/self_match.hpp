#pragma once
/// How much a template looks like itself when it is turned: its symmetry, and the angles a matcher may take for the
/// true one.

#include <optional>
#include <vector>

#include "pickcell/image/image.hpp"
#include "pickcell/matches/learn/symmetry.hpp"

namespace pickcell::matches {

/// A shift by which the part looks the same, pixels of the template; likeness: NCC of what lies on the part.
struct Repeat {
  double dx_px = 0, dy_px = 0;
  double likeness = 0;
};

/// Angles are offsets from the taught one, degrees in (0, 360), counter-clockwise.
struct SelfMatch {
  /// Turning by 360/order gives the same picture; 1: none, kAnyAngle: a disc, no angle can be told.
  int symmetry_order = 1;
  /// Offsets at which the part looks nearly the same, the symmetry's included (for a disc: every 30 degrees).
  std::vector<double> ambiguous_deg;
  /// Best likeness elsewhere, 0..1: turned by an angle that is neither near 0 nor one of the symmetry's, or moved.
  double second_best = 0;
  std::optional<Repeat> repeat;  ///< the part repeats within itself
};

/// Likeness of the template and itself turned by angle_deg: masked NCC at best position, less where the outlines
/// differ. mask: same size, >= 128 is part; empty: everything. 0..1.
struct TurnedLikeness {
  double angle_deg = 0;
  double likeness = 0;
};
/// At even steps over (0, 360).
[[nodiscard]] std::vector<TurnedLikeness> turned_likeness(image::ImageView picture, image::ImageView mask);

[[nodiscard]] SelfMatch self_match(image::ImageView picture, image::ImageView mask);

}  // namespace pickcell::matches
