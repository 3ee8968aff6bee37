#include "pickcell/robot/motoros_move.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <stdexcept>
#include <string>

#include "pickcell/core/units.hpp"
#include "pickcell/robot/motoros_fault.hpp"

namespace pickcell::robot {

using core::ErrorCode;

namespace {

constexpr double kPointEvery_s = 0.1;
constexpr int kLooksBetweenPoints = 10;
constexpr core::Duration kBusyPause = std::chrono::milliseconds(5);
constexpr core::Duration kArrival = std::chrono::seconds(5);  // beyond the trajectory's own time
constexpr double kFastest = 1.875;                            // of the quintic, in lengths per duration
constexpr double kSlack = 1e-6;
constexpr const char* kAxes = "SLURBT";

auto unsafe(std::string why, std::string remedy) {
  return core::failure(ErrorCode::safety, "trajectory", std::move(why), std::move(remedy));
}

std::string number(double value, const char* unit) {
  char text[48];
  std::snprintf(text, sizeof text, "%.1f %s", value, unit);
  return text;
}

MotoTrajectoryPoint point(std::size_t sequence, double time_s, const ArmJoints& q, const ArmJoints& v) {
  MotoTrajectoryPoint p;
  p.sequence = static_cast<std::int32_t>(sequence);
  p.valid = moto::kTimeValid | moto::kPositionValid | moto::kVelocityValid;
  p.time_s = static_cast<float>(time_s);
  for (std::size_t i = 0; i < 6; ++i) {
    p.position[i] = static_cast<float>(q[static_cast<Eigen::Index>(i)]);
    p.velocity[i] = static_cast<float>(v[static_cast<Eigen::Index>(i)]);
  }
  return p;
}

/// Share of the way and its rate at a share of the time.
double way(double u) { return u * u * u * (10 + u * (-15 + 6 * u)); }
double rate(double u) { return 30 * u * u * (1 + u * (-2 + u)); }

std::size_t pieces(double duration_s) {
  return static_cast<std::size_t>(std::max(2.0, std::ceil(duration_s / kPointEvery_s)));
}

/// Between two points the controller follows this cubic.
struct Cubic {
  ArmJoints q0, v0, q1, v1;
  double length_s;
  [[nodiscard]] ArmJoints position(double u) const {
    const ArmJoints c2 = 3 * (q1 - q0) - (2 * v0 + v1) * length_s, c3 = 2 * (q0 - q1) + (v0 + v1) * length_s;
    return q0 + u * (v0 * length_s + u * (c2 + u * c3));
  }
  [[nodiscard]] ArmJoints speed(double u) const {
    const ArmJoints c2 = 3 * (q1 - q0) - (2 * v0 + v1) * length_s, c3 = 2 * (q0 - q1) + (v0 + v1) * length_s;
    return v0 + u * (2 * c2 + 3 * u * c3) / length_s;
  }
};

/// One moment of the way.
core::Status check_moment(const ArmJoints& q, const ArmJoints& v, const MotoRosLimits& limits,
                          const std::string& where) {
  const ArmGeometry& arm = *limits.arm;
  for (Eigen::Index i = 0; i < 6; ++i) {
    const std::string axis = where + ": axis " + kAxes[i];
    if (!(q[i] >= arm.lower_rad[i] - kSlack && q[i] <= arm.upper_rad[i] + kSlack))
      return unsafe(axis + " at " + number(core::deg_from_rad(q[i]), "deg") + " is outside " +
                        number(core::deg_from_rad(arm.lower_rad[i]), "..") + " " +
                        number(core::deg_from_rad(arm.upper_rad[i]), "deg"),
                    "choose a target within the limits of the axes");
    const double most = limits.speed_fraction * arm.max_speed_rad_s[i];
    if (!(std::abs(v[i]) <= most * (1 + 1e-4) + kSlack))
      return unsafe(axis + " would turn at " + number(core::deg_from_rad(v[i]), "deg/s") + ", allowed are " +
                        number(core::deg_from_rad(most), "deg/s"),
                    "lower the speed");
  }
  const Eigen::Vector3d tool_mm = (flange_in_base(arm, q) * limits.T_flange_tool).translation_m() * 1e3;
  for (std::size_t i = 0; i < 3; ++i) {
    const double at = tool_mm(static_cast<Eigen::Index>(i));
    if (!(at >= limits.box_min_mm[i] && at <= limits.box_max_mm[i]))
      return unsafe(where + ": " + "xyz"[i] + " = " + number(at, "mm") + " is outside " +
                        number(limits.box_min_mm[i], "..") + " " + number(limits.box_max_mm[i], "mm"),
                    "choose a target whose way stays in the workspace box");
  }
  return {};
}

core::Status check_piece(const Cubic& cubic, const MotoRosLimits& limits, const std::string& where) {
  Eigen::Vector3d before_m = (flange_in_base(*limits.arm, cubic.q0) * limits.T_flange_tool).translation_m();
  for (int look = 1; look <= kLooksBetweenPoints; ++look) {
    const double u = static_cast<double>(look) / kLooksBetweenPoints;
    const ArmJoints q = cubic.position(u);
    if (auto fine = check_moment(q, cubic.speed(u), limits, where); !fine) return fine;
    const Eigen::Vector3d now_m = (flange_in_base(*limits.arm, q) * limits.T_flange_tool).translation_m();
    const double speed_mm_s = core::mm_from_m((now_m - before_m).norm()) * kLooksBetweenPoints / cubic.length_s;
    if (speed_mm_s > limits.line_speed_mm_s * 1.01)
      return unsafe(where + ": the tool would move at " + number(speed_mm_s, "mm/s") + ", allowed are " +
                        number(limits.line_speed_mm_s, "mm/s"),
                    "lower the speed");
    before_m = now_m;
  }
  return {};
}

}  // namespace

ArmJoints arm_joints(const MotoJoints& joints) {
  ArmJoints q;
  for (std::size_t i = 0; i < 6; ++i) q[static_cast<Eigen::Index>(i)] = static_cast<double>(joints[i]);
  return q;
}

std::vector<MotoTrajectoryPoint> plan_joint_move(const ArmGeometry& arm, const ArmJoints& from, const ArmJoints& to,
                                                 double speed_fraction) {
  const ArmJoints distance = to - from;
  const double duration_s =
      std::max(0.2, (distance.cwiseAbs().array() / arm.max_speed_rad_s.array()).maxCoeff() * kFastest / speed_fraction);
  const std::size_t n = pieces(duration_s);
  std::vector<MotoTrajectoryPoint> points;
  for (std::size_t i = 0; i <= n; ++i) {
    const double u = static_cast<double>(i) / static_cast<double>(n);
    points.push_back(point(i, u * duration_s, from + way(u) * distance, rate(u) / duration_s * distance));
  }
  return points;
}

core::Result<std::vector<MotoTrajectoryPoint>> plan_line(const MotoRosLimits& limits, const ArmJoints& from,
                                                         const FlangeInBase& T_base_flange, double speed_mm_s) {
  if (!limits.arm) throw std::invalid_argument("a line needs the arm's geometry");
  const FlangeInBase start = flange_in_base(*limits.arm, from);
  const core::Transform<core::Base, core::Tool> tool0 = start * limits.T_flange_tool;
  const core::Transform<core::Base, core::Tool> tool1 = T_base_flange * limits.T_flange_tool;
  const Eigen::Quaterniond turn0(start.rotation()), turn1(T_base_flange.rotation());
  const double way_mm = core::mm_from_m((tool1.translation_m() - tool0.translation_m()).norm());
  const double turn_rad = turn0.angularDistance(turn1);
  constexpr double kTurn_rad_s = 0.2;  // slow: about 11 deg/s
  const double duration_s = std::max({0.2, way_mm * kFastest / speed_mm_s, turn_rad * kFastest / kTurn_rad_s});
  const std::size_t n = pieces(duration_s);
  std::vector<ArmJoints> joints{from};
  for (std::size_t i = 1; i <= n; ++i) {
    const double s = way(static_cast<double>(i) / static_cast<double>(n));
    const Eigen::Matrix3d R_base_flange = turn0.slerp(s, turn1).toRotationMatrix();
    const Eigen::Vector3d tool_m = tool0.translation_m() + s * (tool1.translation_m() - tool0.translation_m());
    const FlangeInBase here(R_base_flange, tool_m - R_base_flange * limits.T_flange_tool.translation_m());
    const auto q = joints_near(*limits.arm, here, joints.back());
    constexpr double kJump_rad = 0.5;
    if (!q || (*q - joints.back()).cwiseAbs().maxCoeff() > kJump_rad)
      return unsafe("the line cannot be followed after " + number(s * way_mm, "mm"),
                    "choose a target in reach and away from singular poses");
    joints.push_back(*q);
  }
  std::vector<MotoTrajectoryPoint> points;
  const double step_s = duration_s / static_cast<double>(n);
  for (std::size_t i = 0; i <= n; ++i) {
    ArmJoints v = ArmJoints::Zero();
    if (i > 0 && i < n) v = (joints[i + 1] - joints[i - 1]) / (2 * step_s);
    points.push_back(point(i, static_cast<double>(i) * step_s, joints[i], v));
  }
  return points;
}

core::Status check_trajectory(const std::vector<MotoTrajectoryPoint>& points, const MotoRosLimits& limits) {
  if (!limits.arm) throw std::invalid_argument("a trajectory needs the arm's geometry");
  if (points.size() < 2) return unsafe("it has fewer than two points", "give a start and an end");
  for (std::size_t i = 0; i < points.size(); ++i) {
    const std::string where = "point " + std::to_string(i);
    const ArmJoints q = arm_joints(points[i].position), v = arm_joints(points[i].velocity);
    if (points[i].group != 0 || points[i].sequence != static_cast<std::int32_t>(i))
      return unsafe(where + " is numbered " + std::to_string(points[i].sequence), "number points from 0, group 0");
    if (!q.allFinite() || !v.allFinite() || !std::isfinite(points[i].time_s))
      return unsafe(where + " is not finite", "check what it was planned from");
    const bool rests = i == 0 || i + 1 == points.size();
    if (rests && v.cwiseAbs().maxCoeff() > kSlack) return unsafe(where + " is not at rest", "begin and end at rest");
    if (auto fine = check_moment(q, v, limits, where); !fine) return fine;
    if (i == 0) continue;
    const double length_s = static_cast<double>(points[i].time_s) - static_cast<double>(points[i - 1].time_s);
    if (!(length_s > 1e-3)) return unsafe(where + " does not come after the one before", "times must increase");
    const Cubic cubic{arm_joints(points[i - 1].position), arm_joints(points[i - 1].velocity), q, v, length_s};
    if (auto fine = check_piece(cubic, limits, "before " + where); !fine) return fine;
  }
  return {};
}

namespace {

/// What keeps the arm from moving, or nothing.
core::Status check_state(const MotoStatus& s) {
  const auto no = [](std::string why, std::string remedy) {
    return core::failure(ErrorCode::refused, "robot", std::move(why), std::move(remedy));
  };
  if (s.e_stopped == 1) return no("emergency stop", "release the emergency stop");
  if (s.in_error == 1)
    return no("the controller is in alarm or error " + std::to_string(s.error_code), "remove the cause, then reset");
  if (s.mode == 1) return no("the key switch stands on TEACH", "turn it to REMOTE");
  return {};
}

/// After a failure nobody knows how far the arm goes by itself: stop it, and say whether that worked.
core::Status stopped(MotoRosClient& client, core::Error error) {
  const bool sure = client.stop().has_value();
  error.remedy = sure ? "the arm was stopped; " + error.remedy
                      : "the arm could NOT be stopped from here: use the pendant; " + error.remedy;
  return tl::unexpected(std::move(error));
}

core::Status go_on(const std::function<bool()>& stop_asked) {
  if (!stop_asked || !stop_asked()) return {};
  return core::failure(ErrorCode::refused, "robot", "a stop was asked for", "order the move again");
}

core::Status send(MotoRosClient& client, const MotoTrajectoryPoint& point, core::Seat& seat,
                  const std::function<bool()>& stop_asked) {
  // A point waits until the one before is cut: at most as long as the queue is, and then some.
  const core::TimePoint deadline = seat.now() + kArrival;
  for (;;) {
    if (auto on = go_on(stop_asked); !on) return on;
    auto taken = client.send_point(point);
    if (!taken) return core::forward(taken);
    if (*taken == MotoRosClient::Taken::yes) return {};
    if (seat.now() >= deadline)
      return core::failure(ErrorCode::timeout, client.peer(), "stays busy at point " + std::to_string(point.sequence),
                           "see whether the arm moves");
    seat.sleep_for(kBusyPause);
  }
}

core::Status arrive(MotoRosClient& client, const ArmJoints& target, core::TimePoint deadline, core::Seat& seat,
                    const std::function<bool()>& stop_asked) {
  constexpr double kThere_rad = 1e-3;
  for (;;) {
    if (auto on = go_on(stop_asked); !on) return on;
    auto state = client.read_state();
    if (!state) return core::forward(state);
    if (auto fine = check_state(state->status); !fine) return fine;
    const bool there = (arm_joints(state->feedback.position) - target).cwiseAbs().maxCoeff() < kThere_rad;
    if (there && state->status.in_motion != 1) return {};
    if (state->status.motion_possible == 0)
      return core::failure(ErrorCode::refused, "robot", "left the trajectory mode before the target",
                           "see the pendant (hold, servo, mode)");
    if (seat.now() >= deadline)
      return core::failure(ErrorCode::timeout, client.peer(), "the arm did not arrive", "see the pendant");
    seat.sleep_for(kBusyPause);
  }
}

}  // namespace

core::Status run_trajectory(MotoRosClient& client, const std::vector<MotoTrajectoryPoint>& points,
                            const MotoRosLimits& limits, core::Seat& seat, const std::function<bool()>& stop_asked) {
  if (auto safe = check_trajectory(points, limits); !safe) return safe;
  auto state = client.read_state();
  if (!state) return core::forward(state);
  if (auto fine = check_state(state->status); !fine) return fine;
  if (state->status.in_motion == 1)
    return core::failure(ErrorCode::refused, "robot", "the arm moves already", "wait until it stands");
  constexpr double kAtStart_rad = 2e-3;
  if ((arm_joints(state->feedback.position) - arm_joints(points.front().position)).cwiseAbs().maxCoeff() > kAtStart_rad)
    return unsafe("the arm does not stand at the start", "read the position and plan again");
  auto ready = client.ready();
  if (!ready) return core::forward(ready);
  if (!*ready) {
    if (auto started = client.start_trajectory_mode(); !started) return started;
  }
  const double duration_s = static_cast<double>(points.back().time_s);
  for (const MotoTrajectoryPoint& p : points)
    if (auto sent = send(client, p, seat, stop_asked); !sent) return stopped(client, std::move(sent.error()));
  const core::TimePoint deadline = seat.now() + core::duration_s(duration_s) + kArrival;
  if (auto there = arrive(client, arm_joints(points.back().position), deadline, seat, stop_asked); !there)
    return stopped(client, std::move(there.error()));
  return client.stop_trajectory_mode();
}

}  // namespace pickcell::robot
