#include "pickcell/picks/polygon.hpp"

#include <algorithm>
#include <cmath>

namespace pickcell::picks {

namespace {

double cross(const Eigen::Vector2d& a, const Eigen::Vector2d& b) { return a.x() * b.y() - a.y() * b.x(); }

double signed_area(const Polygon& p) {
  double twice = 0;
  for (std::size_t i = 0; i < p.size(); ++i) twice += cross(p[i], p[(i + 1) % p.size()]);
  return twice / 2;
}

}  // namespace

double area(const Polygon& polygon) { return std::abs(signed_area(polygon)); }

Polygon intersection(const Polygon& a, const Polygon& b) {
  Polygon clipped = a;
  const double side = signed_area(b) < 0 ? -1 : 1;
  for (std::size_t i = 0; i < b.size() && !clipped.empty(); ++i) {
    const Eigen::Vector2d from = b[i], along = b[(i + 1) % b.size()] - from;
    const auto inside = [&](const Eigen::Vector2d& p) { return side * cross(along, p - from); };
    Polygon next;
    for (std::size_t k = 0; k < clipped.size(); ++k) {
      const Eigen::Vector2d p = clipped[k], q = clipped[(k + 1) % clipped.size()];
      const double dp = inside(p), dq = inside(q);
      if (dp >= 0) next.push_back(p);
      if ((dp > 0 && dq < 0) || (dp < 0 && dq > 0)) next.push_back(p + (q - p) * (dp / (dp - dq)));
    }
    clipped = std::move(next);
  }
  return clipped;
}

double overlap(const Polygon& a, const Polygon& b) {
  const double smaller = std::min(area(a), area(b));
  return smaller > 0 ? area(intersection(a, b)) / smaller : 0;
}

}  // namespace pickcell::picks
