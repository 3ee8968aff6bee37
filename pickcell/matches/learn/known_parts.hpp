#pragma once
/// Parts whose symmetry is known by their formula, photographed: for the tests of what teaching says of it.

#include <functional>
#include <random>
#include <string>

#include "pickcell/image/image.hpp"

namespace pickcell::matches::testing {

/// A part about (0, 0) that reaches to radius 1: 0 is the ground, 1 its surface, other values what is on it.
struct KnownPart {
  std::string name;
  std::function<double(double x, double y)> grey;
  int order = 1;  ///< kAnyAngle: the same at every angle
  /// Width of what breaks the rotation: pitch of teeth, a mark; of corners 2.5 times what stands out from a circle.
  double finest = 1;
  int order_but_for_mark = 1;  ///< what the order would be without its mark
};

[[nodiscard]] KnownPart polygon_part(int corners, double bore = 0.25);
[[nodiscard]] KnownPart gear_part(int teeth, double depth = 0.15, double bore = 0.3);
[[nodiscard]] KnownPart annulus_part(double bore);
[[nodiscard]] KnownPart star_part(int points);
[[nodiscard]] KnownPart rectangle_part(double aspect);
[[nodiscard]] KnownPart ellipse_part(double aspect);
[[nodiscard]] KnownPart s_part();
[[nodiscard]] KnownPart l_part();
[[nodiscard]] KnownPart spoked_part(int spokes);

/// With something that only one place has: a slot in the bore, a notch in the outline, a dot on the surface.
[[nodiscard]] KnownPart with_keyway(KnownPart part, double bore, double width, double depth);
[[nodiscard]] KnownPart with_notch(KnownPart part, double width, double depth);
[[nodiscard]] KnownPart with_dot(KnownPart part, double at_radius, double radius, double grey);

enum class MaskKind { none, outline, generous };

struct Shot {
  double radius_px = 60;
  double off_x_px = 0, off_y_px = 0;  ///< of the part's middle from the picture's
  double turn_deg = 0;
  double noise_grey = 0;
  double blur_px = 0;
  double ground_grey = 50, part_grey = 180;
  double light = 0;  ///< the light changes by this share from the middle to the picture's edge
  MaskKind mask = MaskKind::none;
  unsigned seed = 1;
};

struct Photo {
  image::Image picture, mask;  ///< mask: empty, the outline, or 3 px beyond it
};
/// 4 x 4 samples a pixel, then blur, then noise.
[[nodiscard]] Photo photograph(const KnownPart& part, const Shot& shot);

/// For messages of tests.
[[nodiscard]] std::string words(const KnownPart& part, const Shot& shot);

/// Whether what breaks the rotation is about 5 px wide or more, and more where it is blurred.
[[nodiscard]] bool resolvable(const KnownPart& part, const Shot& shot);

/// Any of the above, seen anyhow.
[[nodiscard]] KnownPart random_part(std::mt19937& random);
[[nodiscard]] Shot random_shot(std::mt19937& random, double least_radius_px, double most_radius_px);

}  // namespace pickcell::matches::testing
