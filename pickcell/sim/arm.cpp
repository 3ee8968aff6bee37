#include "pickcell/sim/arm.hpp"

#include <cmath>

#include "pickcell/core/units.hpp"

namespace pickcell::sim {

namespace {

Joints rad(double s, double l, double u, double r, double b, double t) {
  return Joints{s, l, u, r, b, t} * (core::kPi / 180.0);
}

/// The public figures of an MH24: none were found for the arms simulated here, so this row is invented for them.
Joints invented_pulses_per_rad() { return Joints{1341.4, 1341.4, 1341.4, 1000, 1000, 622} * (180.0 / core::kPi); }

Arm make_gp7() {
  return {ArmModel::gp7,
          0.330,
          0.040,
          0.445,
          0.440,
          0.040,
          0.080,
          0.0,
          rad(-170, -65, -70, -190, -135, -360.6),
          rad(170, 145, 190, 190, 135, 360.6),
          rad(375, 315, 410, 550, 550, 1000),
          invented_pulses_per_rad()};
}

Arm make_gp8() {
  return {ArmModel::gp8,
          0.330,
          0.040,
          0.345,
          0.340,
          0.040,
          0.080,
          0.0,
          rad(-170, -65, -70, -190, -135, -360.6),
          rad(170, 145, 190, 190, 135, 360.6),
          rad(455, 387, 520, 550, 550, 1000),
          invented_pulses_per_rad()};
}

/// At B = 0 the flange of the MotoMINI points down, where the others need B = -90.
Arm make_motomini() {
  return {ArmModel::motomini,
          0.103,
          0.020,
          0.165,
          0.165,
          0.0,
          0.040,
          -core::kPi / 2,
          rad(-170, -85, -50, -140, -30, -360),
          rad(170, 90, 90, 140, 210, 360),
          rad(315, 315, 420, 600, 600, 600),
          invented_pulses_per_rad()};
}

}  // namespace

std::string_view name(ArmModel model) {
  switch (model) {
    case ArmModel::gp7:
      return "gp7";
    case ArmModel::gp8:
      return "gp8";
    case ArmModel::motomini:
      return "motomini";
  }
  return "";
}

std::optional<ArmModel> arm_model(std::string_view text) {
  for (const ArmModel model : {ArmModel::gp7, ArmModel::gp8, ArmModel::motomini})
    if (name(model) == text) return model;
  return std::nullopt;
}

const Arm& arm(ArmModel model) {
  static const Arm gp7 = make_gp7(), gp8 = make_gp8(), motomini = make_motomini();
  switch (model) {
    case ArmModel::gp8:
      return gp8;
    case ArmModel::motomini:
      return motomini;
    case ArmModel::gp7:
      break;
  }
  return gp7;
}

Pulses pulses_from_joints(const Arm& arm, const Joints& q) {
  Pulses pulses{};
  for (int i = 0; i < 6; ++i)
    pulses[static_cast<std::size_t>(i)] = static_cast<std::int32_t>(std::lround(q[i] * arm.pulses_per_rad[i]));
  return pulses;
}

Joints joints_from_pulses(const Arm& arm, const Pulses& pulses) {
  Joints q;
  for (int i = 0; i < 6; ++i) q[i] = pulses[static_cast<std::size_t>(i)] / arm.pulses_per_rad[i];
  return q;
}

bool inside_limits(const Arm& arm, const Joints& q) {
  const Joints slack = arm.pulses_per_rad.cwiseInverse() * 0.5;
  return (q.array() >= (arm.lower - slack).array()).all() && (q.array() <= (arm.upper + slack).array()).all();
}

}  // namespace pickcell::sim
