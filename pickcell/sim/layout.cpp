#include "pickcell/sim/layout.hpp"

#include <Eigen/Geometry>
#include <algorithm>

#include "pickcell/core/units.hpp"

namespace pickcell::sim {

Point2 LaidPart::to_part(const Point2& plane_mm) const {
  return Eigen::Rotation2Dd(-core::rad_from_deg(angle_deg)) * (plane_mm - at_mm) / scale;
}

Point2 LaidPart::to_plane(const Point2& part_mm) const {
  return at_mm + Eigen::Rotation2Dd(core::rad_from_deg(angle_deg)) * part_mm * scale;
}

double gap_mm(const LaidPart& a, const LaidPart& b) {
  const double apart =
      (a.to_plane(a.part->kind().outline.bounds().center()) - b.to_plane(b.part->kind().outline.bounds().center()))
          .norm() -
      a.part->radius_mm() * a.scale - b.part->radius_mm() * b.scale;
  if (apart > 30) return apart;
  double gap = 1e9;
  for (const Point2& p : b.part->rim()) {
    const Point2 q = a.to_part(b.to_plane(p));
    gap = std::min(gap, a.scale * static_cast<double>(a.part->distance(q.x(), q.y())));
  }
  return gap;
}

double covered_fraction(const LaidPart& a, const LaidPart& b) {
  int covered = 0;
  for (const Point2& p : a.part->inside()) {
    const Point2 q = b.to_part(a.to_plane(p));
    covered += b.part->distance(q.x(), q.y()) < 0 ? 1 : 0;
  }
  return static_cast<double>(covered) / static_cast<double>(a.part->inside().size());
}

Box2 extent_mm(const LaidPart& laid) {
  Box2 box{laid.to_plane(laid.part->rim().front()), laid.to_plane(laid.part->rim().front())};
  for (const Point2& p : laid.part->rim()) {
    const Point2 q = laid.to_plane(p);
    box.lo = box.lo.cwiseMin(q);
    box.hi = box.hi.cwiseMax(q);
  }
  return box;
}

bool lay_at_random(LaidPart& laid, const Box2& inside, const std::vector<LaidPart>& others, double gap, Random& random,
                   int tries) {
  for (int i = 0; i < tries; ++i) {
    laid.angle_deg = random.uniform(-180, 180);
    laid.at_mm = {random.uniform(inside.lo.x(), inside.hi.x()), random.uniform(inside.lo.y(), inside.hi.y())};
    const Box2 box = extent_mm(laid);
    if ((box.lo.array() < inside.lo.array()).any() || (box.hi.array() > inside.hi.array()).any()) continue;
    if (std::all_of(others.begin(), others.end(), [&](const LaidPart& o) { return gap_mm(o, laid) >= gap; }))
      return true;
  }
  return false;
}

}  // namespace pickcell::sim
