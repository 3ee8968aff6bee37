#pragma once
/// Convex polygons in the plane, metres: outlines of parts and of the gripper.

#include <Eigen/Core>
#include <vector>

namespace pickcell::picks {

using Polygon = std::vector<Eigen::Vector2d>;

[[nodiscard]] double area(const Polygon& polygon);
/// Common part of two convex polygons of either orientation (Sutherland and Hodgman); empty when they do not meet.
[[nodiscard]] Polygon intersection(const Polygon& a, const Polygon& b);
/// Shared area over the smaller area; 0 when either has none.
[[nodiscard]] double overlap(const Polygon& a, const Polygon& b);

}  // namespace pickcell::picks
