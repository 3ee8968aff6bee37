#pragma once
/// Flat shapes in millimetres as signed distances, from which parts and their markings are built.

#include <Eigen/Core>
#include <functional>
#include <string_view>
#include <vector>

namespace pickcell::sim {

using Point2 = Eigen::Vector2d;  ///< mm; x right, y up

struct Box2 {
  Point2 lo = Point2::Zero();
  Point2 hi = Point2::Zero();
  [[nodiscard]] Point2 center() const { return (lo + hi) / 2; }
  [[nodiscard]] Point2 size() const { return hi - lo; }
};

/// A region of the plane. Immutable; cheap to copy; thread-safe.
class Shape {
 public:
  using Distance = std::function<double(const Point2&)>;
  Shape(Box2 bounds, Distance distance) : bounds_(bounds), distance_(std::move(distance)) {}

  /// mm to the outline, negative inside. Exact near the outline of one primitive; a lower bound elsewhere.
  [[nodiscard]] double distance(const Point2& p) const { return distance_(p); }
  /// Encloses the region.
  [[nodiscard]] const Box2& bounds() const { return bounds_; }

  [[nodiscard]] Shape moved(double x, double y, double angle_deg = 0) const;
  /// Corners rounded outwards by r mm.
  [[nodiscard]] Shape grown(double r) const;

 private:
  Box2 bounds_;
  Distance distance_;
};

[[nodiscard]] Shape circle(double r);
/// Centred rectangle with corners rounded by r.
[[nodiscard]] Shape rectangle(double w, double h, double r = 0);
/// A slot: all points within r of the segment from a to b.
[[nodiscard]] Shape capsule(Point2 a, Point2 b, double r);
/// Simple polygon, either sense.
[[nodiscard]] Shape polygon(std::vector<Point2> corners);
/// Spur gear: trapezoid teeth between root and tip radius.
[[nodiscard]] Shape gear(int teeth, double root_r, double tip_r);
/// Capitals, digits, blank and - . / in strokes, cap height h, line width `stroke`; centred on the origin. Other
/// characters throw std::invalid_argument.
[[nodiscard]] Shape lettering(std::string_view text, double h, double stroke);

[[nodiscard]] Shape join(std::vector<Shape> shapes);
[[nodiscard]] Shape cut(Shape from, std::vector<Shape> holes);

/// mm^2, by the midpoint rule on a grid of `step_mm`.
[[nodiscard]] double area_mm2(const Shape& shape, double step_mm = 0.1);

}  // namespace pickcell::sim
