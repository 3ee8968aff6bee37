#include "pickcell/sim/shape.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>

#include "pickcell/core/units.hpp"

namespace pickcell::sim {

namespace {

constexpr double kFar = std::numeric_limits<double>::infinity();

Box2 box_around(const std::vector<Point2>& points) {
  Box2 box{points.front(), points.front()};
  for (const Point2& p : points) {
    box.lo = box.lo.cwiseMin(p);
    box.hi = box.hi.cwiseMax(p);
  }
  return box;
}

double to_segment(const Point2& p, const Point2& a, const Point2& b) {
  const Point2 ab = b - a;
  const double along = ab.squaredNorm() > 0 ? std::clamp((p - a).dot(ab) / ab.squaredNorm(), 0.0, 1.0) : 0.0;
  return (p - a - along * ab).norm();
}

/// Distance to a box from outside; 0 inside.
double outside(const Box2& box, const Point2& p) {
  return (box.lo - p).cwiseMax(p - box.hi).cwiseMax(Point2::Zero()).norm();
}

}  // namespace

Shape Shape::moved(double x, double y, double angle_deg) const {
  const Eigen::Rotation2Dd turn(core::rad_from_deg(angle_deg));
  const Point2 shift(x, y);
  const Box2& b = bounds_;
  std::vector<Point2> corners{b.lo, {b.hi.x(), b.lo.y()}, b.hi, {b.lo.x(), b.hi.y()}};
  for (Point2& c : corners) c = turn * c + shift;
  const Eigen::Matrix2d back = turn.inverse().toRotationMatrix();
  return {box_around(corners), [d = distance_, back, shift](const Point2& p) { return d(back * (p - shift)); }};
}

Shape Shape::grown(double r) const {
  const Point2 margin(r, r);
  return {{bounds_.lo - margin, bounds_.hi + margin}, [d = distance_, r](const Point2& p) { return d(p) - r; }};
}

Shape circle(double r) {
  return {{{-r, -r}, {r, r}}, [r](const Point2& p) { return p.norm() - r; }};
}

Shape rectangle(double w, double h, double r) {
  const Point2 half(w / 2 - r, h / 2 - r);
  const Point2 corner(w / 2, h / 2);
  return {{-corner, corner}, [half, r](const Point2& p) {
            const Point2 q = p.cwiseAbs() - half;
            return q.cwiseMax(0.0).norm() + std::min(q.maxCoeff(), 0.0) - r;
          }};
}

Shape capsule(Point2 a, Point2 b, double r) {
  Box2 box = box_around({a, b});
  box.lo.array() -= r;
  box.hi.array() += r;
  return {box, [a, b, r](const Point2& p) { return to_segment(p, a, b) - r; }};
}

Shape polygon(std::vector<Point2> corners) {
  const Box2 box = box_around(corners);
  return {box, [c = std::make_shared<const std::vector<Point2>>(std::move(corners))](const Point2& p) {
            double nearest2 = kFar;
            bool inside = false;
            for (std::size_t i = 0, j = c->size() - 1; i < c->size(); j = i++) {
              const Point2 &a = (*c)[i], &b = (*c)[j];
              const Point2 ab = b - a, ap = p - a;
              const double along = std::clamp(ap.dot(ab) / ab.squaredNorm(), 0.0, 1.0);
              nearest2 = std::min(nearest2, (ap - along * ab).squaredNorm());
              if ((a.y() > p.y()) != (b.y() > p.y()) && ap.x() < ap.y() * ab.x() / ab.y()) inside = !inside;
            }
            return inside ? -std::sqrt(nearest2) : std::sqrt(nearest2);
          }};
}

Shape gear(int teeth, double root_r, double tip_r) {
  // Fractions of the pitch at which the flank leaves the root, reaches the tip and so on: narrower at the tip.
  constexpr double kFlank[] = {0.10, 0.30, 0.54, 0.74};
  std::vector<Point2> corners;
  for (int i = 0; i < teeth; ++i)
    for (int k = 0; k < 4; ++k) {
      const double a = 2 * core::kPi * (i + kFlank[k] - 0.42) / teeth;
      const double r = k == 1 || k == 2 ? tip_r : root_r;
      corners.emplace_back(r * std::cos(a), r * std::sin(a));
    }
  return polygon(std::move(corners));
}

Shape join(std::vector<Shape> shapes) {
  Box2 box = shapes.at(0).bounds();
  for (const Shape& s : shapes) {
    box.lo = box.lo.cwiseMin(s.bounds().lo);
    box.hi = box.hi.cwiseMax(s.bounds().hi);
  }
  return {box, [all = std::make_shared<const std::vector<Shape>>(std::move(shapes))](const Point2& p) {
            double d = kFar;
            for (const Shape& s : *all)
              if (outside(s.bounds(), p) < d) d = std::min(d, s.distance(p));
            return d;
          }};
}

Shape cut(Shape from, std::vector<Shape> holes) {
  const Box2 box = from.bounds();
  const Shape all = join(std::move(holes));
  return {box, [from = std::move(from), all](const Point2& p) {
            const double d = from.distance(p);
            // Far outside a hole its distance cannot matter.
            return d > 0 && outside(all.bounds(), p) > 0 ? d : std::max(d, -all.distance(p));
          }};
}

double area_mm2(const Shape& shape, double step_mm) {
  const Box2& b = shape.bounds();
  double area = 0;
  for (double y = b.lo.y() + step_mm / 2; y < b.hi.y(); y += step_mm)
    for (double x = b.lo.x() + step_mm / 2; x < b.hi.x(); x += step_mm)
      area += std::clamp(0.5 - shape.distance({x, y}) / step_mm, 0.0, 1.0) * step_mm * step_mm;
  return area;
}

}  // namespace pickcell::sim
