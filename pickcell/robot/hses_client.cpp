#include "pickcell/robot/hses_client.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

namespace pickcell::robot {

using core::ErrorCode;
using Repeat = HsesSession::Repeat;

namespace {

HsesBytes word(std::uint32_t v) { return HsesWriter().u32(v).take(); }

std::uint16_t instance(int number) {
  if (number < 1 || number > 65535) throw std::invalid_argument("number of a task, axis group or item out of range");
  return static_cast<std::uint16_t>(number);
}

int first_of(AlarmHistory which) {
  switch (which) {
    case AlarmHistory::major:
      return kHsesMajorAlarms;
    case AlarmHistory::monitor:
      return kHsesMonitorAlarms;
    case AlarmHistory::user_system:
      return kHsesUserAlarmsOfSystem;
    case AlarmHistory::user_user:
      return kHsesUserAlarmsOfUser;
    case AlarmHistory::off_line:
      return kHsesOfflineAlarms;
  }
  throw std::invalid_argument("no such list of alarms");
}

std::string file_name(const std::string& job) { return job + ".JBI"; }

/// Joint moves in 0.01 %, lines in 0.1 mm/s or 0.1 deg/s.
HsesSpeed speed_of(bool joint, bool turning, double speed) {
  const double wire = speed * (joint ? 100 : 10);
  if (!(wire >= 1) || wire > 1e6) throw std::invalid_argument("no speed for a move");
  return {joint ? 0u : turning ? 2u : 1u, static_cast<std::uint32_t>(std::llround(wire))};
}

}  // namespace

HsesClient::HsesClient(HsesSettings s)
    : session_(s.host, s.port, s.timeout, s.tries, s.busy_pause), variables_(session_), files_(s) {}

core::Status HsesClient::connect() {
  if (auto opened = session_.open(); !opened) return opened;
  auto status = read_status();
  if (status) return {};
  session_.close();
  return core::forward(status);
}

core::Result<std::string> HsesClient::identity() {
  auto info = read_system();
  if (!info) return core::forward(info);
  return info->model + ", software " + info->software;
}

core::Result<RobotState> HsesClient::read_status() {
  return session_.read(hses_get(kHsesStatus, 1), "status", parse_hses_status);
}

core::Result<Alarm> HsesClient::read_alarm(std::uint16_t command, int number) {
  auto a = session_.read(hses_get(command, instance(number)), "alarm", parse_hses_alarm);
  if (!a) return core::forward(a);
  std::string text = "alarm " + std::to_string(a->code) + " [" + std::to_string(a->data) + ']';
  for (const std::string& more : {a->name, a->sub_code_info, a->sub_code_data})
    if (!more.empty()) text += ' ' + more;
  return Alarm{static_cast<int>(a->code), static_cast<int>(a->data), std::move(text), a->time};
}

core::Result<std::vector<Alarm>> HsesClient::read_alarms() {
  std::vector<Alarm> alarms;
  constexpr int kMost = 4;
  for (int n = 1; n <= kMost; ++n) {
    auto a = read_alarm(kHsesAlarm, n);
    if (!a) return core::forward(a);
    if (a->code == 0) break;
    alarms.push_back(std::move(*a));
  }
  return alarms;
}

core::Result<std::vector<Alarm>> HsesClient::read_past_alarms(AlarmHistory which, int most) {
  constexpr int kMost = 100;
  if (most < 1 || most > kMost) throw std::invalid_argument("a history has 1 to 100 alarms");
  std::vector<Alarm> alarms;
  for (int n = 0; n < most; ++n) {
    auto a = read_alarm(kHsesAlarmHistory, first_of(which) + n);
    if (!a) return core::forward(a);
    if (a->code == 0) break;
    alarms.push_back(std::move(*a));
  }
  return alarms;
}

core::Result<HsesPosition> HsesClient::read_axes(int number) {
  return session_.read(hses_get(kHsesPosition, instance(number)), "position", parse_hses_position);
}

core::Result<CartesianPosition> HsesClient::read_position(int frame) {
  if (frame != kBaseFrame)
    return core::failure(ErrorCode::usage, peer() + " position", "HSES reports positions in the base frame only",
                         "use frame 0, or tcp80://");
  auto raw = read_axes(kHsesRobotCartesian);
  if (!raw) return core::forward(raw);
  auto position = variable_position(*raw);
  if (!position) return core::forward(position);
  if (auto* cartesian = std::get_if<CartesianPosition>(&*position)) return *cartesian;
  return core::failure(ErrorCode::refused, peer() + " position",
                       "the controller tells pulses where a position was asked",
                       "check that robot 1 of the controller has a cartesian position (instance 101)");
}

core::Result<std::vector<std::int32_t>> HsesClient::read_pulses() {
  auto raw = read_axes(kHsesRobotPulse);
  if (!raw) return core::forward(raw);
  return std::vector<std::int32_t>(raw->axes.begin(), raw->axes.end());
}

core::Result<HsesJobInfo> HsesClient::read_task(int task) {
  return session_.read(hses_get(kHsesJob, instance(task)), "running job", parse_hses_job);
}

core::Result<CurrentJob> HsesClient::read_job() {
  auto raw = read_task(1);
  if (!raw) return core::forward(raw);
  return CurrentJob{raw->name, static_cast<int>(raw->line), static_cast<int>(raw->step)};
}

core::Result<std::array<std::string, 8>> HsesClient::read_axis_names(int number) {
  return session_.read(hses_get(kHsesAxisNames, instance(number)), "axis names", parse_hses_axis_names);
}

core::Result<std::array<std::int32_t, 8>> HsesClient::read_position_error(int number) {
  return session_.read(hses_get(kHsesPositionError, instance(number)), "position error", parse_hses_axes);
}

core::Result<std::array<std::int32_t, 8>> HsesClient::read_torque(int number) {
  return session_.read(hses_get(kHsesTorque, instance(number)), "torque", parse_hses_axes);
}

core::Result<HsesSystemInfo> HsesClient::read_system(int number) {
  return session_.read(hses_get(kHsesSystem, instance(number)), "system information", parse_hses_system);
}

core::Result<HsesManagementTime> HsesClient::read_management_time(int number) {
  return session_.read(hses_get(kHsesTime, instance(number)), "management time", parse_hses_time);
}

// --- variables, registers, contacts ---

core::Result<std::int32_t> HsesClient::read_integer(VariableType type, int number) {
  return variables_.read_integer(type, number);
}
core::Result<double> HsesClient::read_real(int number) { return variables_.read_real(number); }
core::Result<std::string> HsesClient::read_string(int number) { return variables_.read_string(number); }
core::Result<VariablePosition> HsesClient::read_position_variable(int number) {
  return variables_.read_position(number);
}
core::Status HsesClient::write_integer(VariableType type, int number, std::int32_t value) {
  return variables_.write_integer(type, number, value);
}
core::Status HsesClient::write_real(int number, double value) { return variables_.write_real(number, value); }
core::Status HsesClient::write_string(int number, const std::string& value) {
  return variables_.write_string(number, value);
}
core::Status HsesClient::write_position_variable(int number, const VariablePosition& position) {
  return variables_.write_position(number, position);
}
core::Result<std::uint16_t> HsesClient::read_register(int number) { return variables_.read_register(number); }
core::Status HsesClient::write_register(int number, std::uint16_t value) {
  return variables_.write_register(number, value);
}

core::Result<std::vector<std::uint8_t>> HsesClient::read_contacts(int first, int groups) {
  std::vector<std::uint8_t> bytes;
  for (int i = 0; i < groups; ++i) {
    auto one = variables_.read_group(first / 10 + i);
    if (!one) return core::forward(one);
    bytes.push_back(*one);
  }
  return bytes;
}

core::Status HsesClient::write_contacts(int first, const std::vector<std::uint8_t>& groups) {
  for (std::size_t i = 0; i < groups.size(); ++i) {
    auto written = variables_.write_group(first / 10 + static_cast<int>(i), groups[i]);
    if (!written) return written;
  }
  return {};
}

// --- what switches, starts and moves ---

core::Status HsesClient::hold(bool on) {
  // Holding twice is holding; a repeated release could undo somebody's hold.
  return session_.tell(hses_power(kHsesHold, on), on ? Repeat::yes : Repeat::no, on ? "hold" : "hold off");
}

core::Status HsesClient::reset_alarm() {
  return session_.tell(hses_set_one(kHsesReset, kHsesResetAlarm, word(1)), Repeat::no, "alarm reset");
}

core::Status HsesClient::cancel_error() {
  return session_.tell(hses_set_one(kHsesReset, kHsesCancelError, word(1)), Repeat::no, "error cancel");
}

core::Status HsesClient::servo(bool on) { return session_.tell(hses_power(kHsesServo, on), Repeat::no, "servo"); }

core::Status HsesClient::lock_pendant(bool on) {
  return session_.tell(hses_power(kHsesLock, on), Repeat::no, "pendant lock");
}

core::Status HsesClient::set_cycle(Cycle cycle) {
  return session_.tell(hses_cycle(static_cast<std::uint32_t>(cycle)), Repeat::no, "cycle");
}

core::Status HsesClient::show_message(const std::string& text) {
  return session_.tell(hses_message(text), Repeat::no, "message");
}

core::Status HsesClient::select_job(const std::string& job, int line) {
  if (line < 0 || line > 9999) throw std::invalid_argument("lines are 0 to 9999");
  return session_.tell(hses_select_job(job, static_cast<std::uint32_t>(line)), Repeat::no, "select " + job);
}

core::Status HsesClient::set_master_job(const std::string& job) {
  return session_.tell(hses_select_master(job), Repeat::no, "master " + job);
}

core::Status HsesClient::start_job(const std::string& job) {
  if (auto selected = select_job(job, 0); !selected) return selected;
  return session_.tell(hses_start(), Repeat::no, "start");
}

core::Status HsesClient::move(const DirectMove& m) {
  const bool joint = m.kind == DirectMove::Kind::joint;
  HsesMoveData data;
  data.speed = speed_of(joint, m.turning, m.speed);
  data.target = hses_position(m.target);
  const auto kind = joint                              ? HsesMoveKind::joint
                    : m.kind == DirectMove::Kind::line ? HsesMoveKind::line
                                                       : HsesMoveKind::line_by;
  return session_.tell(hses_move(kind, data), Repeat::no, "move");
}

core::Status HsesClient::move_pulses(const PulseMove& m) {
  HsesPulseMoveData data;
  if (m.target.tool < 0 || m.target.tool > kMaxTool) throw std::invalid_argument("tool number outside 0..63");
  data.speed = speed_of(!m.line, false, m.speed);
  std::copy(m.target.pulses.begin(), m.target.pulses.end(), data.pulses.begin());
  data.tool = static_cast<std::uint32_t>(m.target.tool);
  return session_.tell(hses_pulse_move(m.line ? HsesMoveKind::line : HsesMoveKind::joint, data), Repeat::no, "move");
}

// --- files ---

core::Result<std::vector<std::string>> HsesClient::list_jobs() {
  auto jobs = files_.list("*.JBI");
  if (!jobs) return jobs;
  for (std::string& job : *jobs)
    if (job.ends_with(".JBI")) job.resize(job.size() - 4);
  return jobs;
}

core::Result<std::string> HsesClient::read_job_text(const std::string& job) { return files_.save(file_name(job)); }

core::Status HsesClient::write_job_text(const std::string& job, const std::string& text) {
  if (text.empty()) return core::failure(ErrorCode::usage, job, "the job is empty", "give a job's text");
  return files_.load(file_name(job), text);
}

core::Status HsesClient::delete_job(const std::string& job) { return files_.remove(file_name(job)); }

}  // namespace pickcell::robot
