#pragma once
/// The arm under the cell's watch: every call to the robot that is not a pick itself, its state shown, its trouble an
/// alarm.

#include <optional>
#include <string>
#include <vector>

#include "pickcell/cell/alarm_list.hpp"
#include "pickcell/cell/cell_port.hpp"
#include "pickcell/cell/halt.hpp"
#include "pickcell/core/clock.hpp"
#include "pickcell/robot/robot.hpp"

namespace pickcell::cell {

/// The cell's thread only.
class Arm {
 public:
  /// Within this time of the cell's clock a change of the arm's state is seen (product rule: 200 ms).
  static constexpr core::Duration kPoll = std::chrono::milliseconds(50);

  Arm(robot::Robot& robot, const core::Clock& clock, core::Seat& seat, std::string link)
      : robot_(robot), clock_(clock), seat_(seat), link_(std::move(link)) {
    view_.link = link_;
  }

  /// Connects, raises the fence, settles what was open.
  [[nodiscard]] Or<void> connect();
  /// What Reset does: clears alarm and hold, reconnects, passes on that a person has looked at arm and gripper.
  [[nodiscard]] Or<void> reset(bool person_looked);
  /// Servo on, job running, fence acknowledged.
  [[nodiscard]] Or<void> start();

  /// Reads state and position; view() is new then. The need is what the state must be good for.
  enum class Need { nothing, ready, running };
  [[nodiscard]] Or<robot::RobotState> poll(Need need);
  /// Why the arm could not start now, by the last poll.
  [[nodiscard]] std::optional<Hindrance> hindrance() const { return hindrance_; }
  /// Why the cell stands after a call to robot() failed; when the link is gone, view() says so too.
  [[nodiscard]] tl::unexpected<Halt> failed(const core::Error& error, const std::string& doing);
  /// Tells the arm to stand, over a new connection where the old one is gone; a controller that does not answer is
  /// logged.
  void hold();

  [[nodiscard]] const RobotView& view() const { return view_; }
  [[nodiscard]] robot::Robot& robot() { return robot_; }
  [[nodiscard]] AlarmList& alarms() { return alarms_; }

 private:
  /// Clears alarm and commanded hold where there are any; says whether there were.
  [[nodiscard]] Or<bool> clear();
  [[nodiscard]] Halt with_alarm_text(Halt halt);

  robot::Robot& robot_;
  const core::Clock& clock_;
  core::Seat& seat_;
  std::string link_;
  RobotView view_;
  std::optional<Hindrance> hindrance_;
  AlarmList alarms_;
};

}  // namespace pickcell::cell
