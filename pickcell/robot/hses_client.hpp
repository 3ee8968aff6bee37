#pragma once
/// A PC's side of a Yaskawa High Speed Ethernet Server: one datagram out, one back, each within one deadline.
/// Source: docs/yaskawa-protocols.md section 2; docs/robots.md names the bytes of every command.

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "pickcell/core/result.hpp"
#include "pickcell/robot/controller_link.hpp"
#include "pickcell/robot/hses_codec.hpp"
#include "pickcell/robot/hses_files.hpp"
#include "pickcell/robot/hses_session.hpp"
#include "pickcell/robot/hses_variables.hpp"

namespace pickcell::robot {

/// One thread at a time. Errors as in ControllerLink; every error carries the last requests and answers.
///
/// Reads, writes of variables and contacts and "hold on" are repeated when no answer comes or the controller is busy
/// (HsesSession): doing them twice is the same as once. Everything else is sent exactly once. After an unanswered
/// request the link counts as lost until connect().
class HsesClient final : public ControllerLink {
 public:
  explicit HsesClient(HsesSettings settings);
  HsesClient(const HsesClient&) = delete;
  HsesClient& operator=(const HsesClient&) = delete;

  /// Asks for the status, so that somebody is known to be there.
  [[nodiscard]] core::Status connect() override;
  [[nodiscard]] bool connected() const override { return session_.is_open(); }
  void disconnect() override { session_.close(); }
  [[nodiscard]] std::string peer() const override { return session_.peer(); }
  [[nodiscard]] std::string protocol() const override { return "HSES"; }
  [[nodiscard]] core::Result<std::string> identity() override;

  [[nodiscard]] core::Result<RobotState> read_status() override;
  [[nodiscard]] core::Result<std::vector<Alarm>> read_alarms() override;
  [[nodiscard]] core::Result<std::vector<Alarm>> read_past_alarms(AlarmHistory which, int most) override;
  [[nodiscard]] core::Result<CartesianPosition> read_position(int frame) override;
  [[nodiscard]] core::Result<std::vector<std::int32_t>> read_pulses() override;
  [[nodiscard]] core::Result<CurrentJob> read_job() override;

  [[nodiscard]] core::Result<std::int32_t> read_integer(VariableType type, int number) override;
  [[nodiscard]] core::Result<double> read_real(int number) override;
  [[nodiscard]] core::Result<std::string> read_string(int number) override;
  [[nodiscard]] core::Result<VariablePosition> read_position_variable(int number) override;
  [[nodiscard]] core::Status write_integer(VariableType type, int number, std::int32_t value) override;
  [[nodiscard]] core::Status write_real(int number, double value) override;
  [[nodiscard]] core::Status write_string(int number, const std::string& value) override;
  [[nodiscard]] core::Status write_position_variable(int number, const VariablePosition& position) override;
  [[nodiscard]] core::Result<std::uint16_t> read_register(int number) override;
  [[nodiscard]] core::Status write_register(int number, std::uint16_t value) override;
  [[nodiscard]] core::Result<std::vector<std::uint8_t>> read_contacts(int first, int groups) override;
  [[nodiscard]] core::Status write_contacts(int first, const std::vector<std::uint8_t>& groups) override;

  [[nodiscard]] core::Status hold(bool on) override;
  [[nodiscard]] core::Status reset_alarm() override;
  [[nodiscard]] core::Status cancel_error() override;
  [[nodiscard]] core::Status servo(bool on) override;
  [[nodiscard]] core::Status set_cycle(Cycle cycle) override;
  [[nodiscard]] core::Status show_message(const std::string& text) override;
  [[nodiscard]] core::Status select_job(const std::string& job, int line) override;
  [[nodiscard]] core::Status set_master_job(const std::string& job) override;
  [[nodiscard]] core::Status start_job(const std::string& job) override;
  [[nodiscard]] core::Status move(const DirectMove& move) override;
  [[nodiscard]] core::Status move_pulses(const PulseMove& move) override;

  [[nodiscard]] core::Result<std::vector<std::string>> list_jobs() override;
  [[nodiscard]] core::Result<std::string> read_job_text(const std::string& job) override;
  [[nodiscard]] core::Status write_job_text(const std::string& job, const std::string& text) override;
  [[nodiscard]] core::Status delete_job(const std::string& job) override;

  // what other protocols do not have
  /// Single and plural, of every kind.
  [[nodiscard]] HsesVariables& variables() { return variables_; }
  /// Instances as in section 2.2; 11: robot 1.
  [[nodiscard]] core::Result<HsesSystemInfo> read_system(int instance = 11);
  /// 1: control power, see the controller's manual for the others.
  [[nodiscard]] core::Result<HsesManagementTime> read_management_time(int instance = 1);
  /// Of a task: 1 master, 2.. subtasks.
  [[nodiscard]] core::Result<HsesJobInfo> read_task(int task);
  /// Instances as of positions in section 2.2: 1 robot 1 in pulses, 101 in the base frame, 11.. base, 21.. stations.
  [[nodiscard]] core::Result<HsesPosition> read_axes(int instance = kHsesRobotPulse);
  [[nodiscard]] core::Result<std::array<std::string, 8>> read_axis_names(int instance = kHsesRobotPulse);
  /// Pulses; the unit of the torque is the controller's own.
  [[nodiscard]] core::Result<std::array<std::int32_t, 8>> read_position_error(int instance = kHsesRobotPulse);
  [[nodiscard]] core::Result<std::array<std::int32_t, 8>> read_torque(int instance = kHsesRobotPulse);
  /// HLOCK: pendant and I/O operation, emergency stop excepted.
  [[nodiscard]] core::Status lock_pendant(bool on);

 protected:
  [[nodiscard]] std::string instead() const override { return "use tcp80://"; }

 private:
  [[nodiscard]] core::Result<Alarm> read_alarm(std::uint16_t command, int instance);

  HsesSession session_;
  HsesVariables variables_;
  HsesFiles files_;
};

}  // namespace pickcell::robot
