#include "pickcell/matches/rotated_rect.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace pickcell::matches {
namespace {

using Point = std::array<double, 2>;

double cross(const Point& o, const Point& a, const Point& b) {
  return (a[0] - o[0]) * (b[1] - o[1]) - (a[1] - o[1]) * (b[0] - o[0]);
}

double signed_area(const Point* p, std::size_t n) {
  double sum = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const Point& a = p[i];
    const Point& b = p[(i + 1) % n];
    sum += a[0] * b[1] - b[0] * a[1];
  }
  return sum / 2;
}

/// A convex polygon; a rectangle clipped by four lines has eight corners at most.
struct Polygon {
  std::array<Point, 8> corner;
  std::size_t n = 0;
  void add(const Point& p) {
    if (n < corner.size()) corner[n++] = p;
  }
};

/// The part on the inner side of the line a-b (inner: where sign * cross >= 0).
Polygon clipped(const Polygon& polygon, const Point& a, const Point& b, double sign) {
  Polygon out;
  for (std::size_t i = 0; i < polygon.n; ++i) {
    const Point& p = polygon.corner[i];
    const Point& q = polygon.corner[(i + 1) % polygon.n];
    const double dp = sign * cross(a, b, p);
    const double dq = sign * cross(a, b, q);
    if (dp >= 0) out.add(p);
    if ((dp > 0 && dq < 0) || (dp < 0 && dq > 0)) {
      const double t = dp / (dp - dq);
      out.add({p[0] + t * (q[0] - p[0]), p[1] + t * (q[1] - p[1])});
    }
  }
  return out;
}

}  // namespace

double area(const RotatedRect& r) { return std::abs(signed_area(r.corner.data(), 4)); }

double intersection_area(const RotatedRect& a, const RotatedRect& b) {
  Polygon polygon;
  for (const Point& p : a.corner) polygon.add(p);
  const double sign = signed_area(b.corner.data(), 4) >= 0 ? 1.0 : -1.0;
  for (std::size_t i = 0; i < 4 && polygon.n > 0; ++i)
    polygon = clipped(polygon, b.corner[i], b.corner[(i + 1) % 4], sign);
  return polygon.n < 3 ? 0.0 : std::abs(signed_area(polygon.corner.data(), polygon.n));
}

double overlap(const RotatedRect& a, const RotatedRect& b) {
  const double smaller = std::min(area(a), area(b));
  return smaller > 0 ? std::min(1.0, intersection_area(a, b) / smaller) : 0.0;
}

}  // namespace pickcell::matches
