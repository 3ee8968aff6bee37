#include "pickcell/sim/kinematics.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "pickcell/core/units.hpp"

namespace pickcell::sim {

namespace {

using Eigen::AngleAxisd;
using Eigen::Matrix3d;
using Eigen::Vector3d;

/// Below this sine of the wrist's bend R and T are taken as one axis.
constexpr double kWristInLine = 1e-9;
/// How far outside the reach rounding may put a pose, metres.
constexpr double kReachSlack_m = 1e-9;

Matrix3d rx(double a) { return AngleAxisd(a, Vector3d::UnitX()).toRotationMatrix(); }
Matrix3d ry(double a) { return AngleAxisd(a, Vector3d::UnitY()).toRotationMatrix(); }

/// The flange at zero wrist angles: Z forward along the forearm, X up.
Matrix3d flange_zero() {
  Matrix3d r;
  r << 0, 0, 1, 0, -1, 0, 1, 0, 0;
  return r;
}

double forearm_m(const Arm& arm) { return std::hypot(arm.u_to_b_x_m, arm.u_to_b_z_m); }

/// U at which upper arm and wrist centre are in line.
double stretched_u(const Arm& arm) { return std::atan2(arm.u_to_b_x_m, arm.u_to_b_z_m); }

Matrix3d forearm_rotation(const Joints& q) { return core::rotation_z(q[0]) * ry(q[1] - q[2]); }

Vector3d wrist_centre(const Arm& arm, const Joints& q) {
  const Vector3d in_arm_plane = Vector3d(arm.s_to_l_m, 0, 0) + ry(q[1]) * Vector3d(0, 0, arm.l_to_u_m) +
                                ry(q[1] - q[2]) * Vector3d(arm.u_to_b_x_m, 0, arm.u_to_b_z_m);
  return core::rotation_z(q[0]) * in_arm_plane;
}

double nearest_turn(double angle, double near) { return near + core::wrap_rad(angle - near); }

/// The wrist angles for a rotation forearm -> flange, both ways.
std::array<Vector3d, 2> wrist_angles(const Matrix3d& forearm_flange, double r_near) {
  // Rx(-R) * Ry(-B) * Rx(-T) = m
  const Matrix3d m = forearm_flange * flange_zero().transpose();
  const double sine = std::hypot(m(0, 1), m(0, 2));
  if (sine < kWristInLine) {
    const double b = m(0, 0) > 0 ? 0.0 : core::kPi;
    const double turn = std::atan2(m(2, 1), m(1, 1));  // a + c in line, a - c folded back
    const double c = m(0, 0) > 0 ? turn + r_near : -r_near - turn;
    return {Vector3d(r_near, -b, -c), Vector3d(r_near + core::kPi, b, -c + core::kPi)};
  }
  const double b = std::atan2(sine, m(0, 0));
  const double c = std::atan2(m(0, 1), m(0, 2));
  const double a = std::atan2(m(1, 0), -m(2, 0));
  return {Vector3d(-a, -b, -c), Vector3d(-a + core::kPi, b, -c + core::kPi)};
}

struct Planar {
  double l, u;
};

/// L and U for a wrist centre at (r, z) seen from the L axis.
std::optional<Planar> reach(const Arm& arm, double r, double z, bool elbow_below) {
  const double upper = arm.l_to_u_m, fore = forearm_m(arm);
  const double distance = std::hypot(r, z);
  if (distance > upper + fore + kReachSlack_m || distance < std::abs(upper - fore) - kReachSlack_m) return std::nullopt;
  const double cosine = (distance * distance - upper * upper - fore * fore) / (2 * upper * fore);
  const double bend = std::acos(std::clamp(cosine, -1.0, 1.0)) * (elbow_below ? -1 : 1);
  const double l = std::atan2(r, z) - std::atan2(fore * std::sin(bend), upper + fore * std::cos(bend));
  return Planar{l, stretched_u(arm) - bend};
}

bool same_way(const Form& a, const Form& b) {
  return a.no_flip == b.no_flip && a.elbow_below == b.elbow_below && a.back == b.back;
}

bool half_turn_beyond(double angle) {
  // A hair of tolerance: 180 itself and its rounding belong to the inner range on the upper side.
  constexpr double kHair = 1e-9;
  return angle > core::kPi + kHair || angle <= -core::kPi - kHair;
}

/// Equivalents of an angle a whole turn apart that are inside the limits and in the asked-for range, nearest first.
std::optional<double> turn_in_form(double angle, bool beyond, double lower, double upper, double near) {
  std::optional<double> best;
  for (int k = -2; k <= 2; ++k) {
    const double candidate = core::wrap_rad(angle) + 2 * core::kPi * k;
    if (candidate < lower - 1e-9 || candidate > upper + 1e-9 || half_turn_beyond(candidate) != beyond) continue;
    if (!best || std::abs(candidate - near) < std::abs(*best - near)) best = candidate;
  }
  return best;
}

}  // namespace

int Form::bits() const {
  return (no_flip ? 1 : 0) | (elbow_below ? 2 : 0) | (back ? 4 : 0) | (r_180 ? 8 : 0) | (t_180 ? 16 : 0) |
         (s_180 ? 32 : 0);
}

Form Form::from_bits(int bits) {
  const auto bit = [bits](int n) { return ((bits >> n) & 1) != 0; };
  return {bit(0), bit(1), bit(2), bit(3), bit(4), bit(5)};
}

FlangePose forward(const Arm& arm, const Joints& q) {
  const Matrix3d rotation = forearm_rotation(q) * rx(-q[3]) * ry(-(q[4] + arm.b_zero_rad)) * rx(-q[5]) * flange_zero();
  return FlangePose(rotation, wrist_centre(arm, q) + rotation.col(2) * arm.b_to_flange_m);
}

Form form_of(const Arm& arm, const Joints& q) {
  Form form;
  form.no_flip = std::cos(q[3]) < 0;
  form.elbow_below = core::wrap_rad(q[2] - stretched_u(arm)) > 0;
  form.back = (core::rotation_z(-q[0]) * wrist_centre(arm, q)).x() < 0;
  form.r_180 = half_turn_beyond(q[3]);
  form.t_180 = half_turn_beyond(q[5]);
  form.s_180 = half_turn_beyond(q[0]);
  return form;
}

std::vector<Joints> inverse(const Arm& arm, const FlangePose& T_base_flange, const Joints& near) {
  const Matrix3d rotation = T_base_flange.rotation();
  const Vector3d wrist = T_base_flange.translation_m() - rotation.col(2) * arm.b_to_flange_m;
  const double away = std::hypot(wrist.x(), wrist.y());
  // On the S axis itself S is free: keep it.
  const double azimuth = away > kReachSlack_m ? std::atan2(wrist.y(), wrist.x()) : near[0];
  std::vector<Joints> ways;
  for (const bool back : {false, true})
    for (const bool elbow_below : {false, true}) {
      const auto planar = reach(arm, (back ? -away : away) - arm.s_to_l_m, wrist.z(), elbow_below);
      if (!planar) continue;
      Joints q = Joints::Zero();
      q[0] = azimuth + (back ? core::kPi : 0);
      q[1] = planar->l;
      q[2] = planar->u;
      for (const Vector3d& rbt : wrist_angles(forearm_rotation(q).transpose() * rotation, near[3])) {
        q.tail<3>() = rbt - Vector3d(0, arm.b_zero_rad, 0);
        Joints turned;
        for (int i = 0; i < 6; ++i) turned[i] = nearest_turn(q[i], near[i]);
        ways.push_back(turned);
      }
    }
  return ways;
}

std::optional<Joints> inverse_in_form(const Arm& arm, const FlangePose& T_base_flange, Form form, const Joints& near) {
  for (const Joints& way : inverse(arm, T_base_flange, near)) {
    if (!same_way(form_of(arm, way), form)) continue;
    Joints q;
    const std::array<std::optional<bool>, 6> beyond{form.s_180, false, {}, form.r_180, {}, form.t_180};
    bool fits = true;
    for (int i = 0; fits && i < 6; ++i) {
      // U and B reach beyond 180 on some arms without a form bit for it: any turn inside the limits will do.
      std::optional<double> angle;
      for (const bool range : {false, true})
        if (!angle && beyond[static_cast<std::size_t>(i)].value_or(range) == range)
          angle = turn_in_form(way[i], range, arm.lower[i], arm.upper[i], near[i]);
      fits = angle.has_value();
      q[i] = angle.value_or(0);
    }
    if (fits) return q;
  }
  return std::nullopt;
}

std::optional<Joints> inverse_continuing(const Arm& arm, const FlangePose& T_base_flange, const Joints& near) {
  const Form wanted = form_of(arm, near);
  std::optional<Joints> best;
  for (const Joints& way : inverse(arm, T_base_flange, near)) {
    const Form form = form_of(arm, way);
    if (form.elbow_below != wanted.elbow_below || form.back != wanted.back) continue;
    // R may wander over +-90 on the way: the nearer of the two wrist solutions is the continuous one.
    if (!best || (way - near).norm() < (*best - near).norm()) best = way;
  }
  return best;
}

}  // namespace pickcell::sim
