#pragma once
/// The MotoROS application of the simulated controller: trajectory mode through the job INIT_ROS, points cut into
/// increments, stop (docs/yaskawa-protocols 3.2). On the one controller state; no sockets, no clock.

#include <deque>
#include <optional>
#include <string_view>

#include "pickcell/robot/motoros_codec.hpp"
#include "pickcell/sim/controller_state.hpp"

namespace pickcell::sim {

struct MotoRosSettings {
  double increment_s = 0.004;  ///< interpolation period; the recorded FS100 behaves as with 0.002
  int queue_increments = 200;
  int start_deviation_pulses = 30;
};

/// General outputs of MotoROS (#11120..).
constexpr int kMotoRosWaiting = 889, kMotoRosDone = 890, kMotoRosInitDone = 891, kMotoRosServing = 892;
constexpr int kMotoRosMotionConnected = 893, kMotoRosStateConnected = 894, kMotoRosIoConnected = 895;

struct MotoRosAnswer {
  std::optional<robot::MotoFrame> frame;  ///< empty: none, or later
  bool later = false;                     ///< ask waited()
  bool close = false;                     ///< the connection ends after it
};

/// What scenario files call a message: MOTIONCTRL, JOINTTRAJPT, MOTOROSIO, or MOTOROS for the rest.
[[nodiscard]] std::string_view motoros_command_name(const robot::MotoFrame& message);

/// Not synchronised: whoever holds the state's lock.
class MotoRosMotion {
 public:
  explicit MotoRosMotion(MotoRosSettings settings = {}) : settings_(settings) {}

  /// A message to the motion port, with the refusals in MotoROS' order.
  [[nodiscard]] MotoRosAnswer handle(ControllerState& state, const robot::MotoFrame& message);
  /// The answer that was announced as later, when it is there.
  [[nodiscard]] std::optional<robot::MotoFrame> waited(const ControllerState& state);
  /// The host is gone: motion ends, an answer is no longer waited for.
  void host_left();
  /// Moves the arm on, and drops the queue when the controller is no longer ready. After the state's own tick.
  void tick(ControllerState& state, double dt_s);

  /// Points or increments wait or run.
  [[nodiscard]] bool holds_motion() const { return executed_s_ < end_s_; }
  [[nodiscard]] robot::MotoStatus status(const ControllerState& state) const;
  [[nodiscard]] static robot::MotoFeedback feedback(const ControllerState& state);

 private:
  /// Between two points: cubic, with the given speeds at both ends.
  struct Segment {
    double from_s, to_s;
    Joints q0, v0, q1, v1;
    [[nodiscard]] Joints at(double t_s) const;
  };
  struct Point {
    double time_s = 0;  ///< of the trajectory, as sent
    Joints q = Joints::Zero(), v = Joints::Zero();
  };
  /// A START_TRAJ_MODE whose answer waits for the job.
  struct Starting {
    robot::MotoReply reply;
    double left_s = 5, to_check_s = 0.05;
    std::optional<bool> ready;
  };

  [[nodiscard]] robot::MotoReply point(const ControllerState& state, const robot::MotoTrajectoryPoint& point);
  [[nodiscard]] robot::MotoReply select_tool(ControllerState& state, const robot::MotoSelectTool& select) const;
  [[nodiscard]] MotoRosAnswer control(ControllerState& state, const robot::MotoCommand& command);
  [[nodiscard]] MotoRosAnswer start(ControllerState& state, robot::MotoReply reply);
  [[nodiscard]] bool start_job(ControllerState& state);
  void first_point(const Point& start);
  void add_point(const Point& next);
  void clear();

  MotoRosSettings settings_;
  std::deque<Segment> segments_;
  Point last_;             ///< where the trajectory ends so far
  double executed_s_ = 0;  ///< both on one time scale that never goes back
  double end_s_ = 0;
  std::optional<Starting> starting_;
};

}  // namespace pickcell::sim
