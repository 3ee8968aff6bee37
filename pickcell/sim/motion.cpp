#include "pickcell/sim/motion.hpp"

#include <algorithm>
#include <cmath>

namespace pickcell::sim {

namespace {

/// A standing still "move": done at once.
constexpr double kNoWay = 1e-12;

/// Highest rate of the path parameter that keeps distance * rate within limit.
double rate(double limit, double distance) { return limit / std::max(distance, kNoWay); }

}  // namespace

double Trapezoid::duration_s() const {
  const double ramp_s = speed / acceleration;
  return speed * ramp_s >= 1 ? 2 / std::sqrt(acceleration) : 1 / speed + ramp_s;
}

double Trapezoid::at(double t_s) const {
  const double end_s = duration_s();
  if (t_s >= end_s) return 1;
  if (t_s <= 0) return 0;
  if (t_s > end_s / 2) return 1 - at(end_s - t_s);
  const double ramp_s = std::min(speed / acceleration, end_s / 2);
  return t_s < ramp_s ? acceleration * t_s * t_s / 2 : acceleration * ramp_s * (t_s - ramp_s / 2);
}

std::string_view name(MoveFault fault) {
  switch (fault) {
    case MoveFault::out_of_reach:
      return "out of reach";
    case MoveFault::axis_limit:
      return "axis limit";
    case MoveFault::too_fast:
      return "axis speed";
  }
  return "";
}

Move Move::joint(const Arm& arm, const MotionLimits& limits, const Joints& from, const Joints& to, double fraction) {
  Move move(arm, from);
  move.to_ = to;
  move.profile_ = {1 / kNoWay, 1 / kNoWay};
  for (int i = 0; i < 6; ++i) {
    const double distance = std::abs(to[i] - from[i]);
    move.profile_.speed = std::min(move.profile_.speed, rate(fraction * arm.max_speed[i], distance));
    move.profile_.acceleration =
        std::min(move.profile_.acceleration, rate(arm.max_speed[i] / limits.time_to_full_speed_s, distance));
  }
  return move;
}

Move Move::line(const Arm& arm, const MotionLimits& limits, const Joints& from, const ToolData& tool,
                const ToolPose& target, double speed_m_s, double turn_speed_rad_s) {
  Move move(arm, from);
  const ToolPose start = forward(arm, from) * tool;
  move.line_ = Line{start.translation_m(), target.translation_m(), Eigen::Quaterniond(start.rotation()),
                    Eigen::Quaterniond(target.rotation()), tool};
  const double way_m = (target.translation_m() - start.translation_m()).norm();
  const double turn_rad = move.line_->from_q.angularDistance(move.line_->to_q);
  move.profile_.speed =
      std::min(rate(speed_m_s, way_m), rate(std::min(turn_speed_rad_s, limits.turn_speed_rad_s), turn_rad));
  move.profile_.acceleration =
      std::min(rate(limits.line_acceleration_m_s2, way_m), rate(limits.turn_acceleration_rad_s2, turn_rad));
  return move;
}

std::optional<Joints> Move::joints_at(double s) const {
  if (!line_) return from_ + (to_ - from_) * s;
  const Eigen::Vector3d p = line_->from_m + (line_->to_m - line_->from_m) * s;
  const ToolPose T_base_tool(line_->from_q.slerp(s, line_->to_q).toRotationMatrix(), p);
  return inverse_continuing(*arm_, T_base_tool * line_->tool.inverse(), last_);
}

Move::Step Move::advance(double dt_s) {
  const double feed_before = feed_;
  feed_ = stopping_ ? std::max(0.0, feed_ - dt_s / ramp_s_) : std::min(1.0, feed_ + dt_s / ramp_s_);
  const double path_time_s = path_time_s_ + (feed_before + feed_) / 2 * dt_s;
  const auto q = joints_at(profile_.at(path_time_s));
  if (!q) return {last_, false, MoveFault::out_of_reach};
  if (!inside_limits(*arm_, *q)) return {last_, false, MoveFault::axis_limit};
  const Joints farthest = arm_->max_speed * dt_s * 1.001 + Joints::Constant(1e-9);
  if (line_ && ((*q - last_).cwiseAbs().array() > farthest.array()).any()) return {last_, false, MoveFault::too_fast};
  path_time_s_ = path_time_s;
  last_ = *q;
  return {last_, path_time_s_ >= profile_.duration_s(), std::nullopt};
}

void Move::stop(double ramp_s) {
  ramp_s_ = stopping_ ? std::min(ramp_s_, ramp_s) : ramp_s;
  stopping_ = true;
}

void Move::resume() { stopping_ = false; }

}  // namespace pickcell::sim
