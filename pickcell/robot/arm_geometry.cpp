#include "pickcell/robot/arm_geometry.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <cmath>

#include "pickcell/core/units.hpp"

namespace pickcell::robot {

namespace {

ArmJoints rad(double s, double l, double u, double r, double b, double t) {
  return ArmJoints{s, l, u, r, b, t} * (core::kPi / 180.0);
}

const std::array<ArmGeometry, 3>& arms() {
  static const std::array<ArmGeometry, 3> all{
      {{"gp7", 0.040, 0.445, 0.440, 0.040, 0.080, 0.0, rad(-170, -65, -70, -190, -135, -360.6),
        rad(170, 145, 190, 190, 135, 360.6), rad(375, 315, 410, 550, 550, 1000)},
       {"gp8", 0.040, 0.345, 0.340, 0.040, 0.080, 0.0, rad(-170, -65, -70, -190, -135, -360.6),
        rad(170, 145, 190, 190, 135, 360.6), rad(455, 387, 520, 550, 550, 1000)},
       // At B = 0 the flange of the MotoMINI points down.
       {"motomini", 0.020, 0.165, 0.165, 0.0, 0.040, core::kPi / 2, rad(-170, -85, -50, -140, -30, -360),
        rad(170, 90, 90, 140, 210, 360), rad(315, 315, 420, 600, 600, 600)}}};
  return all;
}

/// Where each joint turns, and about what, in the base frame; then the flange.
struct Chain {
  std::array<Eigen::Vector3d, 6> axis, at;
  Eigen::Matrix3d R;
  Eigen::Vector3d p;
};

Chain chain(const ArmGeometry& arm, const ArmJoints& q) {
  const Eigen::Vector3d x = Eigen::Vector3d::UnitX(), y = Eigen::Vector3d::UnitY(), z = Eigen::Vector3d::UnitZ();
  const std::array<Eigen::Vector3d, 6> axes{z, y, -y, -x, -y, -x};
  const std::array<Eigen::Vector3d, 6> after{Eigen::Vector3d(arm.s_to_l_m, 0, 0),
                                             Eigen::Vector3d(0, 0, arm.l_to_u_m),
                                             Eigen::Vector3d(arm.u_to_b_x_m, 0, arm.u_to_b_z_m),
                                             Eigen::Vector3d::Zero(),
                                             Eigen::Vector3d::Zero(),
                                             Eigen::Vector3d(arm.b_to_flange_m, 0, 0)};
  Chain c;
  c.R.setIdentity();
  c.p.setZero();
  for (std::size_t i = 0; i < 6; ++i) {
    const double angle = q[static_cast<Eigen::Index>(i)] - (i == 4 ? arm.b_zero_rad : 0.0);
    c.axis[i] = c.R * axes[i];
    c.at[i] = c.p;
    c.R *= Eigen::AngleAxisd(angle, axes[i]).toRotationMatrix();
    c.p += c.R * after[i];
  }
  Eigen::Matrix3d flange;  // its z axis looks out of the flange
  flange << 0, 0, 1, 0, -1, 0, 1, 0, 0;
  c.R *= flange;
  return c;
}

}  // namespace

const ArmGeometry* arm_geometry(std::string_view model) {
  for (const ArmGeometry& arm : arms())
    if (arm.model == model) return &arm;
  return nullptr;
}

FlangeInBase flange_in_base(const ArmGeometry& arm, const ArmJoints& q) {
  const Chain c = chain(arm, q);
  return {c.R, c.p};
}

std::optional<ArmJoints> joints_near(const ArmGeometry& arm, const FlangeInBase& T_base_flange, const ArmJoints& near) {
  constexpr int kSteps = 200;
  constexpr double kDamping = 1e-3, kClose_m = 1e-7, kClose_rad = 1e-6, kLargest_rad = 0.2;
  ArmJoints q = near;
  for (int step = 0; step < kSteps; ++step) {
    const Chain c = chain(arm, q);
    const Eigen::AngleAxisd turn(T_base_flange.rotation() * c.R.transpose());
    Eigen::Matrix<double, 6, 1> error;
    error << T_base_flange.translation_m() - c.p, turn.angle() * turn.axis();
    if (error.head<3>().norm() < kClose_m && error.tail<3>().norm() < kClose_rad) {
      const bool inside = (q.array() >= arm.lower_rad.array()).all() && (q.array() <= arm.upper_rad.array()).all();
      return inside ? std::optional(q) : std::nullopt;
    }
    Eigen::Matrix<double, 6, 6> J;
    for (std::size_t i = 0; i < 6; ++i)
      J.col(static_cast<Eigen::Index>(i)) << c.axis[i].cross(c.p - c.at[i]), c.axis[i];
    const Eigen::Matrix<double, 6, 6> damped =
        J * J.transpose() + kDamping * kDamping * Eigen::Matrix<double, 6, 6>::Identity();
    ArmJoints dq = J.transpose() * damped.ldlt().solve(error);
    const double largest = dq.cwiseAbs().maxCoeff();
    if (!std::isfinite(largest)) return std::nullopt;
    if (largest > kLargest_rad) dq *= kLargest_rad / largest;
    q += dq;
  }
  return std::nullopt;
}

}  // namespace pickcell::robot
