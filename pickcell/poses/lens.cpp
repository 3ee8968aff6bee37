#include "pickcell/poses/lens.hpp"

#include <Eigen/LU>

namespace pickcell::poses {

namespace {

struct Distorted {
  Eigen::Vector2d at;
  Eigen::Matrix2d jacobian;
};

Distorted distort(const std::array<double, 8>& d, const Eigen::Vector2d& n) {
  const auto [k1, k2, p1, p2, k3, k4, k5, k6] = d;
  const double x = n.x(), y = n.y(), r2 = n.squaredNorm();
  const double top = 1 + r2 * (k1 + r2 * (k2 + r2 * k3));
  const double bottom = 1 + r2 * (k4 + r2 * (k5 + r2 * k6));
  const double radial = top / bottom;
  const double d_top = k1 + r2 * (2 * k2 + r2 * 3 * k3);
  const double d_bottom = k4 + r2 * (2 * k5 + r2 * 3 * k6);
  const double d_radial = (d_top - radial * d_bottom) / bottom;  // d radial / d r2
  Distorted out;
  out.at = {x * radial + 2 * p1 * x * y + p2 * (r2 + 2 * x * x), y * radial + p1 * (r2 + 2 * y * y) + 2 * p2 * x * y};
  out.jacobian << radial + 2 * x * x * d_radial + 2 * p1 * y + 6 * p2 * x,
      2 * x * y * d_radial + 2 * p1 * x + 2 * p2 * y, 2 * x * y * d_radial + 2 * p1 * x + 2 * p2 * y,
      radial + 2 * y * y * d_radial + 6 * p1 * y + 2 * p2 * x;
  return out;
}

}  // namespace

Eigen::Vector2d project(const Lens& lens, const Eigen::Vector2d& direction) {
  const Eigen::Vector2d d = distort(lens.distortion, direction).at;
  return {lens.fx_px * d.x() + lens.cx_px, lens.fy_px * d.y() + lens.cy_px};
}

std::optional<Eigen::Vector2d> undistort(const Lens& lens, const Eigen::Vector2d& pixel) {
  constexpr int kMaxSteps = 30;
  constexpr double kGoal = 1e-12;
  const Eigen::Vector2d seen((pixel.x() - lens.cx_px) / lens.fx_px, (pixel.y() - lens.cy_px) / lens.fy_px);
  Eigen::Vector2d n = seen;
  for (int step = 0; step < kMaxSteps; ++step) {
    const Distorted d = distort(lens.distortion, n);
    // A determinant that is no longer positive: beyond the radius where the model turns back on itself.
    if (!(d.jacobian.determinant() > 1e-6)) return std::nullopt;
    const Eigen::Vector2d error = seen - d.at;
    if (error.norm() < kGoal) return n;
    n += d.jacobian.inverse() * error;
    if (!n.allFinite() || n.norm() > 100) return std::nullopt;
  }
  return std::nullopt;
}

}  // namespace pickcell::poses
