#include "pickcell/sim/controller_state.hpp"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "pickcell/core/units.hpp"

namespace pickcell::sim {

namespace {

ControllerType type_of(const ControllerSettings& settings) {
  auto type = controller_type(settings.type);
  if (!type) throw std::invalid_argument("unknown controller type " + settings.type);
  return *type;
}

constexpr int bit(bool set, int n) { return set ? 1 << n : 0; }

}  // namespace

ControllerState::ControllerState(const ControllerSettings& settings)
    : arm(&sim::arm(settings.model)),
      type(type_of(settings)),
      limits(settings.limits),
      q(settings.start_deg * (core::kPi / 180.0)),
      user_frames(static_cast<std::size_t>(type.user_frames)),
      mounted_tool(Eigen::Matrix3d::Identity(), Eigen::Vector3d(0, 0, settings.tool_length_m)) {
  tools[1] = mounted_tool;
  for (const std::string& text : settings.jobs) {
    auto job = parse_job(text);
    if (!job)
      throw std::invalid_argument("job text, line " + std::to_string(job.error().line) + ": " + job.error().why);
    load_job(std::move(*job));
  }
}

std::array<int, 2> ControllerState::status_bits() const {
  return {bit(cycle == CycleMode::step, 0) | bit(cycle == CycleMode::one_cycle, 1) |
              bit(cycle == CycleMode::continuous, 2) | bit(running(), 3) | bit(!play, 5) | bit(play, 6) |
              bit(remote, 7),
          bit(hold_pendant, 1) | bit(hold_external, 2) | bit(hold_command, 3) | bit(!alarms.empty(), 4) |
              bit(error, 5) | bit(servo, 6)};
}

bool ControllerState::frame_exists(int number) const { return number >= 0 && number <= type.user_frames + 1; }

std::optional<Eigen::Isometry3d> ControllerState::frame(int number) const {
  if (!frame_exists(number)) return std::nullopt;
  // One arm without a base axis: robot and base frame are the same.
  if (number < 2) return Eigen::Isometry3d::Identity();
  return user_frames[static_cast<std::size_t>(number - 2)];
}

void ControllerState::load_job(JobProgram job) {
  for (const auto& [n, position] : job.p_variables) P[static_cast<std::size_t>(n)] = position;
  auto shared = std::make_shared<const JobProgram>(std::move(job));
  jobs[shared->name] = shared;
  if (task.running || !in_use(shared->name)) return;
  task = {};
  task.at.job = shared;
  move.reset();
}

bool ControllerState::in_use(std::string_view job) const {
  return (task.at.job && task.at.job->name == job) ||
         std::any_of(task.callers.begin(), task.callers.end(), [&](const auto& c) { return c.job->name == job; });
}

void ControllerState::raise_alarm(AlarmEntry alarm) {
  alarm.unix_us = unix_us;
  constexpr std::size_t kShown = 4, kRemembered = 100;
  alarm_history.insert(alarm_history.begin(), alarm);
  alarms.insert(alarms.begin(), std::move(alarm));
  if (alarm_history.size() > kRemembered) alarm_history.resize(kRemembered);
  if (alarms.size() > kShown) alarms.resize(kShown);
  servo = false;
}

void ControllerState::press_emergency_stop() {
  emergency_stop = true;
  servo = false;
}

void ControllerState::turn_key_to_teach() {
  play = false;
  remote = false;
  servo = false;
}

void ControllerState::turn_key_to_remote() {
  play = true;
  remote = true;
  servo = false;
}

void ControllerState::reset_at_pendant() {
  alarms.clear();
  error = false;
}

void ControllerState::lose_power() {
  task = {};
  move.reset();
  direct_move = stopping = false;
  servo = false;
  alarms.clear();
  error = hold_pendant = hold_external = hold_command = false;
  for (std::size_t n = 1; n < outputs.size(); ++n)
    if (outputs[n]) output_events.push_back({static_cast<int>(n), false});
  outputs.reset();
}

}  // namespace pickcell::sim
