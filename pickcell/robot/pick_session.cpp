#include "pickcell/robot/pick_session.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "pickcell/core/log.hpp"
#include "pickcell/core/units.hpp"
#include "pickcell/robot/pose_angles.hpp"

namespace pickcell::robot {

using core::ErrorCode;

namespace {

/// The controller keeps 0.001 mm and 0.0001 degrees, and may write an angle another way.
bool same(const CartesianPosition& a, const CartesianPosition& b) {
  const auto away_mm = std::max({std::abs(a.x_mm - b.x_mm), std::abs(a.y_mm - b.y_mm), std::abs(a.z_mm - b.z_mm)});
  const auto turned =
      (rotation(ZyxAngles{a.rx_deg, a.ry_deg, a.rz_deg}) - rotation(ZyxAngles{b.rx_deg, b.ry_deg, b.rz_deg})).norm();
  return away_mm < 0.002 && turned < 2e-5 && a.frame == b.frame && a.tool == b.tool && a.form == b.form;
}

core::Status person_must_look(std::string why) {
  return core::failure(ErrorCode::refused, "hand-over", std::move(why),
                       "look at the arm, take the part out of its gripper (it opens), then Reset");
}

}  // namespace

core::Status PickSession::verify(PoseRegister which, const CartesianPosition& wanted) {
  auto stored = registers_.read_pose(which);
  if (!stored) return core::forward(stored);
  const auto* position = std::get_if<CartesianPosition>(&*stored);
  if (position && same(*position, wanted)) return {};
  return core::failure(ErrorCode::refused, "hand-over", "the pose read back differs from the one written",
                       "check that no other program writes the controller's variables");
}

core::Result<std::int32_t> PickSession::perform(const HandOverStep& step) {
  using Kind = HandOverStep::Kind;
  const std::int64_t now_us = clock_.unix_us();
  core::Status status;
  switch (step.kind) {
    case Kind::read:
      return registers_.read(step.which);
    case Kind::write:
      status = registers_.write(step.which, step.value);
      break;
    case Kind::write_poses:
      status = registers_.write_pose(PoseRegister::grasp, command_.grasp);
      if (status) status = registers_.write_pose(PoseRegister::place, command_.place);
      break;
    case Kind::verify_poses:
      status = verify(PoseRegister::grasp, command_.grasp);
      if (status) status = verify(PoseRegister::place, command_.place);
      break;
    case Kind::record_intent:
      command_.row.sequence = step.value;
      command_.row.epoch = step.epoch;
      command_.row.state = CommandState::intent;
      command_.row.t_intent_us = now_us;
      status = journal_.record_intent(command_.row);
      break;
    case Kind::record_sent:
      status = journal_.record_sent(step.value, now_us);
      break;
    case Kind::record_end:
      status = journal_.record_end(step.value, command_state(step.outcome), step.result, now_us);
      break;
    case Kind::record_epoch:
      status = journal_.record_epoch(step.epoch, step.value);
      break;
  }
  if (!status) return core::forward(status);
  return 0;
}

core::Status PickSession::drive() {
  while (const HandOverStep* step = hand_over_.next()) {
    auto done = perform(*step);
    if (!done) {
      hand_over_.lost();
      return core::forward(done);
    }
    hand_over_.done(*done);
  }
  for (Outcome& outcome : hand_over_.take_settled()) {
    core::log(core::LogLevel::info, "robot", "pick " + std::to_string(outcome.sequence) + ": " + outcome.text);
    settled_.push_back(std::move(outcome));
  }
  return stopped();
}

/// Whether the machine stands where a person or a reconnection is needed.
core::Status PickSession::stopped() const {
  const std::string& problem = hand_over_.problem();
  switch (hand_over_.phase()) {
    case HandOverPhase::journal_missing:
      return core::failure(ErrorCode::refused, "journal", problem,
                           "make sure that no part is in the gripper and nothing waits for its outcome, then Reset");
    case HandOverPhase::held:
      if (hand_over_.known(Register::reason) == kHeldGripperFull)
        return person_must_look("something is in the gripper at the start of the job");
      return person_must_look("pick " + std::to_string(hand_over_.known(Register::accepted)) +
                              " was interrupted: nobody knows whether the part was moved");
    default:
      break;
  }
  if (problem.empty()) return {};
  if (hand_over_.phase() == HandOverPhase::lost)
    return core::failure(ErrorCode::refused, "hand-over", problem,
                         "set the variables of the hand-over back to 0 and begin a new journal");
  return core::failure(ErrorCode::refused, "hand-over", problem, "connect again");
}

core::Status PickSession::connect() {
  HandOver::Past past;
  auto epoch = journal_.last_epoch();
  if (!epoch) return core::forward(epoch);
  auto sequence = journal_.last_sequence();
  if (!sequence) return core::forward(sequence);
  auto open = journal_.open_rows();
  if (!open) return core::forward(open);
  past.last_epoch = *epoch;
  past.last_sequence = *sequence;
  for (const JournalRow& row : *open) past.open.push_back(row.sequence);
  hand_over_.connect(past);
  return drive();
}

core::Status PickSession::settle(core::Seat& seat, const std::function<core::Result<bool>()>& job_runs) {
  if (phase() == HandOverPhase::journal_missing) return stopped();
  const core::TimePoint deadline = seat.now() + kFenceTimeout;
  while (phase() == HandOverPhase::fencing || phase() == HandOverPhase::held) {
    hand_over_.look();
    if (auto looked = drive(); !looked) return looked;
    if (phase() == HandOverPhase::ready) break;
    auto running = job_runs();
    if (!running) return core::forward(running);
    if (!*running) return {};
    const core::TimePoint before = seat.now();
    if (before >= deadline) {
      return core::failure(ErrorCode::timeout, "hand-over", "the job does not reach its waiting loop",
                           "see which line the job stands at; hold it if it must not go on");
    }
    seat.sleep_for(kPoll);
    if (seat.now() == before) return core::failure(ErrorCode::timeout, "hand-over", "stopped while waiting");
  }
  return {};
}

core::Status PickSession::fence() {
  hand_over_.fence();
  return drive();
}

core::Status PickSession::confirm() {
  hand_over_.confirm();
  return drive();
}

core::Result<std::int32_t> PickSession::submit(const PickCommand& command) {
  if (phase() != HandOverPhase::ready) {
    return core::failure(ErrorCode::refused, "hand-over", std::string("not ready for a pick: ") + name(phase()),
                         "connect and start the job first");
  }
  command_ = command;
  hand_over_.submit(command.part_class);
  if (auto driven = drive(); !driven) return core::forward(driven);
  return hand_over_.last_sequence();
}

core::Result<std::optional<Outcome>> PickSession::outcome() {
  if (phase() == HandOverPhase::lost)
    return core::failure(ErrorCode::link, "hand-over", "the link was lost", "connect again");
  hand_over_.look();
  if (auto driven = drive(); !driven) return core::forward(driven);
  if (settled_.empty() || phase() != HandOverPhase::ready) return std::nullopt;
  Outcome last = settled_.back();
  settled_.pop_back();
  return last;
}

std::vector<Outcome> PickSession::take_settled() { return std::exchange(settled_, {}); }

}  // namespace pickcell::robot
