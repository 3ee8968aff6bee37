#pragma once
/// The arm behind a Yaskawa controller, whatever protocol its link speaks: picks through the job VISPICK, handed over
/// at most once.

#include <memory>
#include <string>
#include <vector>

#include "pickcell/core/clock.hpp"
#include "pickcell/robot/controller_link.hpp"
#include "pickcell/robot/journal.hpp"
#include "pickcell/robot/pick_check.hpp"
#include "pickcell/robot/pick_session.hpp"
#include "pickcell/robot/robot.hpp"

namespace pickcell::robot {

struct JobRobotSettings {
  std::string job = "VISPICK";
  int first_variable = 10;  ///< of the hand-over: B010, I010, D010, P010 and the following
  int frame = kBaseFrame;   ///< that the poses of picks are in
  int tool = 1;
  Form form;
  PickLimits limits;
};

/// The registers of the hand-over as B, I, D and P variables of the controller.
class VariableRegisters final : public Registers {
 public:
  VariableRegisters(ControllerLink& link, int first_variable) : link_(link), first_(first_variable) {}
  [[nodiscard]] core::Result<std::int32_t> read(Register which) override;
  [[nodiscard]] core::Status write(Register which, std::int32_t value) override;
  [[nodiscard]] core::Result<VariablePosition> read_pose(PoseRegister which) override;
  [[nodiscard]] core::Status write_pose(PoseRegister which, const CartesianPosition& position) override;

 private:
  ControllerLink& link_;
  int first_;
};

class JobRobot final : public Robot {
 public:
  /// Journal and clock must outlive the robot. Settings out of range throw std::invalid_argument.
  JobRobot(JobRobotSettings settings, std::unique_ptr<ControllerLink> link, Journal& journal, const core::Clock& clock);

  [[nodiscard]] core::Status connect(core::Seat& seat) override;
  [[nodiscard]] bool connected() const override { return link_->connected(); }
  [[nodiscard]] core::Result<RobotState> state() override;
  [[nodiscard]] core::Result<std::vector<Alarm>> alarms() override;
  [[nodiscard]] core::Result<core::Transform<core::Base, core::Tool>> pose() override;
  [[nodiscard]] core::Status start(core::Seat& seat) override;
  [[nodiscard]] core::Status confirm(core::Seat& seat) override;
  [[nodiscard]] std::vector<Outcome> take_settled() override { return session_.take_settled(); }
  [[nodiscard]] core::Result<std::int32_t> submit(const picks::Pick& pick) override;
  [[nodiscard]] core::Result<std::optional<Outcome>> outcome() override;
  [[nodiscard]] core::Status hold(bool on) override;
  [[nodiscard]] core::Status reset() override;
  [[nodiscard]] core::Status write_contact(int contact, bool on) override;
  [[nodiscard]] core::Result<bool> read_contact(int contact) override;
  void disconnect() override;

 private:
  [[nodiscard]] core::Result<bool> job_runs();
  [[nodiscard]] core::Status settle(core::Seat& seat);
  [[nodiscard]] core::Status may_start(const RobotState& state);
  [[nodiscard]] core::Status servo_on(core::Seat& seat);
  [[nodiscard]] core::Status start_job(core::Seat& seat);

  JobRobotSettings settings_;
  std::unique_ptr<ControllerLink> link_;
  VariableRegisters registers_;
  PickSession session_;
};

}  // namespace pickcell::robot
