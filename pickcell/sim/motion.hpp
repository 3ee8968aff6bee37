#pragma once
/// Moves of the simulated arm in time: joint moves with all axes in step, straight lines of the tool, both with a
/// trapezoid of speed; stopped on the path by hold and carried on.

#include <Eigen/Geometry>
#include <optional>
#include <string_view>

#include "pickcell/core/transform.hpp"
#include "pickcell/sim/kinematics.hpp"

namespace pickcell::sim {

using ToolPose = core::Transform<core::Base, core::Tool>;
using ToolData = core::Transform<core::Flange, core::Tool>;

/// Accelerations are the simulation's own: brochures give none.
struct MotionLimits {
  double time_to_full_speed_s = 0.25;  ///< of every axis at 100 %
  double line_acceleration_m_s2 = 3.0;
  double turn_speed_rad_s = 3.1415926535897932;  ///< of the tool on a straight line (180 deg/s)
  double turn_acceleration_rad_s2 = 12.566370614359173;
  double hold_ramp_s = 0.15;  ///< from full speed to rest
  double emergency_ramp_s = 0.05;
};

/// Travel over a path of length 1: up with `acceleration`, along with `speed`, down again; without the middle when
/// short.
struct Trapezoid {
  double speed = 1;         ///< 1/s
  double acceleration = 1;  ///< 1/s^2
  [[nodiscard]] double duration_s() const;
  /// Path parameter 0..1 at a time since the start.
  [[nodiscard]] double at(double t_s) const;
};

/// Why a move cannot begin or go on.
enum class MoveFault {
  out_of_reach,  ///< no joints for the pose, or not in the asked-for form
  axis_limit,    ///< an axis would leave its range
  too_fast,      ///< an axis would exceed its speed: the line passes near a singularity, or is too fast
};
[[nodiscard]] std::string_view name(MoveFault fault);

/// A move in progress. Not thread-safe.
class Move {
 public:
  struct Step {
    Joints q;
    bool finished = false;
    std::optional<MoveFault> fault;  ///< q is the last place that was fine
  };

  /// All axes start and stop together. fraction: of the greatest speeds, (0, 1].
  static Move joint(const Arm& arm, const MotionLimits& limits, const Joints& from, const Joints& to, double fraction);

  /// The tool centre goes straight and turns evenly (shortest way). The axes follow continuously: form and turns of the
  /// start. speed_m_s for the way, turn_speed_rad_s for a turn that takes longer than the way.
  static Move line(const Arm& arm, const MotionLimits& limits, const Joints& from, const ToolData& tool,
                   const ToolPose& target, double speed_m_s, double turn_speed_rad_s);

  /// Time the whole move takes when it is not stopped.
  [[nodiscard]] double duration_s() const { return profile_.duration_s(); }

  /// Carries the move on by dt.
  [[nodiscard]] Step advance(double dt_s);

  /// Slows down along the path to rest within ramp_s (less when already slow); repeated calls keep the shorter ramp.
  void stop(double ramp_s);
  /// Speeds up again along the same path.
  void resume();
  [[nodiscard]] bool at_rest() const { return stopping_ && feed_ <= 0; }

 private:
  struct Line {
    Eigen::Vector3d from_m, to_m;
    Eigen::Quaterniond from_q, to_q;
    ToolData tool;
  };
  Move(const Arm& arm, const Joints& from) : arm_(&arm), from_(from), last_(from) {}
  [[nodiscard]] std::optional<Joints> joints_at(double s) const;

  const Arm* arm_;
  Joints from_, last_;
  Joints to_ = Joints::Zero();
  std::optional<Line> line_;
  Trapezoid profile_;
  double path_time_s_ = 0;
  double feed_ = 1;  ///< path seconds per second
  double ramp_s_ = 0.15;
  bool stopping_ = false;
};

}  // namespace pickcell::sim
