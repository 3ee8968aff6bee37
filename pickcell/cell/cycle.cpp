/// The working cycle of the cell: look, pick what the picture holds, feed. Runs in the cell's thread.

#include <algorithm>
#include <chrono>
#include <cmath>

#include "pickcell/cell/cell.hpp"
#include "pickcell/cell/fate.hpp"

namespace pickcell::cell {

using core::duration_s;
using robot::OutcomeKind;

namespace {

/// A belt that was asked to move and shows no motion for so long does not move.
constexpr core::Duration kBeltReacts = std::chrono::seconds(2);

Halt stopped_by_operator() { return {Mode::idle, "STOPPED", "stopped by the operator", "", false}; }

double ms_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
}

}  // namespace

Halt Cell::work() {
  if (auto begun = begin_work(); !begun) return begun.error();
  for (;;) {
    if (desk_.asked(Command::stop) || quit_) return stopped_by_operator();
    if (settings_.stop_after_picks > 0 && ledger_.dealt_with() >= settings_.stop_after_picks)
      return {Mode::idle, "DONE", "all " + std::to_string(settings_.stop_after_picks) + " picks are dealt with", "",
              false};
    auto done = queue_.empty() ? look() : pick_next();
    if (done && queue_.empty() && parts_.empty()) done = feed();
    if (!done) return done.error();
  }
}

Or<void> Cell::begin_work() {
  reason_code_.clear();
  reason_.clear();
  remedy_.clear();
  refused_in_row_ = empty_in_row_ = 0;
  queue_.clear();
  ledger_.standing().forget();
  show(Mode::running, "starting the robot's job");
  if (auto exchanged = exchange_full_trays(); !exchanged) return exchanged;
  if (auto logged = ledger_.event("STARTED", settings_.recipe); !logged)
    return tl::unexpected(halt_from(logged.error(), "recording"));
  if (auto ready = arm_.poll(Arm::Need::ready); !ready) return tl::unexpected(ready.error());
  if (auto started = arm_.start(); !started) return started;
  if (auto settled = settle(); !settled) return settled;
  // The job runs and nothing is left to settle: what is still open here never reached the controller.
  if (ledger_.open()) ledger_.give_back("", "was not handed over");
  if (auto stands = wait_until_belt_stands(); !stands) return stands;
  if (camera_check_)
    if (auto stands = check_camera(); !stands) return stands;
  ledger_.cycle_begins();
  return {};
}

Or<void> Cell::check_camera() {
  if (auto clear = wait_until_clear(); !clear) return clear;
  auto frame = picture_with_pose();
  if (!frame) return tl::unexpected(frame.error());
  show_step("looking whether the camera still stands where it was calibrated");
  const auto checked = camera_check_(*frame);
  if (!checked && checked.error().code == core::ErrorCode::negative)
    return stand("NO_BOARD", "the camera cannot be verified: " + checked.error().why,
                 "lay the board in its reference place and press Start again");
  if (!checked) return fault("CAMERA_MOVED", checked.error().why, checked.error().remedy);
  camera_check_ = nullptr;
  if (auto logged = ledger_.event("CAMERA_VERIFIED", *checked); !logged)
    return tl::unexpected(halt_from(logged.error(), "recording"));
  if (settings_.board_is_taken_away)
    return stand("CAMERA_VERIFIED", "the camera is verified: " + *checked, "take the board away and press Start");
  return {};
}

Or<frames::Frame> Cell::picture_with_pose() {
  if (!vision_.rides_on_arm()) return take_picture();
  constexpr int kTries = 5;
  constexpr double kStandsM = 0.05e-3, kStandsRad = 2e-4;
  for (int i = 0; i < kTries; ++i) {
    const auto before = arm_.robot().pose();
    if (!before) return arm_.failed(before.error(), "reading where the camera on the arm is");
    auto frame = take_picture();
    if (!frame) return frame;
    // The arm is asked again: only when it stood, its pose is that of the exposure.
    const auto after = arm_.robot().pose();
    if (!after) return arm_.failed(after.error(), "reading where the camera on the arm is");
    const auto moved = before->inverse() * *after;
    frame->T_base_flange = *after * settings_.T_flange_tool.inverse();
    if (moved.translation_m().norm() < kStandsM && Eigen::AngleAxisd(moved.rotation()).angle() < kStandsRad)
      return frame;
  }
  return fault("ARM_MOVES", "the arm does not stand still while its camera takes a picture",
               "let the job wait at its look position with B012 = 1; then press Reset");
}

Or<void> Cell::settle() {
  bool of_others = false;
  for (const robot::Outcome& outcome : arm_.robot().take_settled()) {
    const auto& open = ledger_.open();
    const bool ours = open && (open->sequence == 0 || open->sequence == outcome.sequence);
    const std::string text = "pick " + std::to_string(outcome.sequence) + ": " + outcome.text;
    auto logged = ours ? ledger_.end(outcome) : ledger_.event("SETTLED", text);
    if (!logged) return tl::unexpected(halt_from(logged.error(), "recording"));
    of_others = of_others || !ours;
  }
  return of_others ? recall_trays() : Or<void>{};
}

Or<robot::RobotState> Cell::rest(Arm::Need need) {
  seat_->sleep_for(Arm::kPoll);
  if (quit_) return tl::unexpected(stopped_by_operator());
  camera_.look(arm_.alarms(), clock_.unix_us());  // the show below tells
  auto state = arm_.poll(need);
  show(desk_.asked(Command::stop) ? Mode::stopping : mode_, step_);
  return state;
}

Or<void> Cell::wait_until_clear() {
  show_step("waiting until the arm is out of the picture");
  const core::TimePoint deadline = seat_->now() + duration_s(settings_.clear_timeout_s);
  for (auto state = arm_.poll(Arm::Need::running);; state = rest(Arm::Need::running)) {
    if (!state) return tl::unexpected(state.error());
    if (state->clear_of_camera) return {};
    if (seat_->now() > deadline) {
      arm_.hold();
      return fault("NOT_CLEAR", "the arm did not leave the picture in time (B012 stays 0)",
                   "look at the arm and its job, then press Reset");
    }
  }
}

/// At once when nothing is known against the camera.
Or<void> Cell::wait_for_camera(core::TimePoint deadline) {
  if (camera_.view().connected) return {};
  show_step("waiting for the camera");
  while (const auto lost = camera_.hindrance()) {
    if (desk_.asked(Command::stop)) return tl::unexpected(stopped_by_operator());
    if (seat_->now() > deadline) {
      return fault("CAMERA",
                   "the camera did not come back in " + std::to_string(std::lround(settings_.camera_wait_s)) +
                       " s: " + lost->why,
                   lost->remedy + ", then press Reset");
    }
    if (auto state = rest(Arm::Need::running); !state) return tl::unexpected(state.error());
  }
  watch_camera();
  return {};
}

/// A camera that gets lost while the arm waits may come back by itself: the cell then goes on.
Or<frames::Frame> Cell::take_picture() {
  const core::TimePoint deadline = seat_->now() + duration_s(settings_.camera_wait_s);
  for (;;) {
    if (auto back = wait_for_camera(deadline); !back) return tl::unexpected(back.error());
    show_step("taking a picture");
    const std::int64_t reconnects = camera_.view().reconnects;
    auto frame = source_.grab(*seat_, duration_s(settings_.grab_timeout_s));
    if (frame) return std::move(*frame);
    if (frame.error().code == core::ErrorCode::negative)
      return stand("NO_PICTURES", "the source of pictures has come to its end: " + frame.error().why);
    watch_camera();
    const bool was_lost = !camera_.view().connected || camera_.view().reconnects != reconnects;
    if (was_lost && seat_->now() <= deadline) continue;
    core::Error error = frame.error();
    if (error.code == core::ErrorCode::timeout) error.code = core::ErrorCode::device;  // the camera's, not the link's
    return tl::unexpected(halt_from(error, "taking a picture"));
  }
}

Or<void> Cell::look() {
  if (auto clear = wait_until_clear(); !clear) return clear;
  const auto grab_start = std::chrono::steady_clock::now();
  auto frame = picture_with_pose();
  if (!frame) return tl::unexpected(frame.error());
  const double grab_ms = ms_since(grab_start);
  show_step("searching");
  auto sight = vision_.look(*frame, ledger_.next_detection_id());
  if (!sight) return tl::unexpected(halt_from(sight.error(), "searching"));
  give_up_on_stubborn(*sight);
  const picks::Plan plan = picks::plan_picks(sight->parts, settings_.planner, ledger_.tray().taken());
  auto logged = ledger_.saw(std::move(*frame), *sight, plan, grab_ms, vision_.models(), settings_.recipe);
  if (!logged) return tl::unexpected(halt_from(logged.error(), "recording"));

  full_tray_.clear();
  for (const picks::Refusal& refusal : plan.refusals)
    for (const poses::PartPose& part : sight->parts)
      if (part.detection_id == refusal.detection_id && refusal.reason == picks::RefusalReason::pattern_full)
        full_tray_ = part.model;
  queue_.assign(plan.picks.rbegin(), plan.picks.rend());
  parts_ = std::move(sight->parts);
  if (queue_.empty()) parts_.clear();
  publish();
  if (sight->unfit)
    return fault("CALIBRATION", sight->unfit->what + ": " + sight->unfit->why,
                 (sight->unfit->remedy.empty() ? "calibrate again" : sight->unfit->remedy) + ", then press Reset");
  return {};
}

void Cell::give_up_on_stubborn(Sight& sight) const {
  for (const poses::PartPose& part : sight.parts) {
    const Eigen::Vector2d p_m = part.T_base_part.translation_m().head<2>();
    if (ledger_.attempts(part.model, p_m) < settings_.attempts_per_part) continue;
    for (Sight::Seen& seen : sight.seen)
      if (seen.detection_id == part.detection_id)
        seen.rejection = Rejection{std::string(kGaveUp),
                                   "picking it failed " + std::to_string(settings_.attempts_per_part) + " times"};
  }
  std::erase_if(sight.parts, [&](const poses::PartPose& part) {
    return std::any_of(sight.seen.begin(), sight.seen.end(), [&](const Sight::Seen& seen) {
      return seen.detection_id == part.detection_id && seen.rejection;
    });
  });
}

Or<void> Cell::pick_next() {
  const picks::Pick pick = queue_.back();
  queue_.pop_back();
  const auto part = std::find_if(parts_.begin(), parts_.end(),
                                 [&](const poses::PartPose& p) { return p.detection_id == pick.detection_id; });
  const Eigen::Vector2d part_m = part->T_base_part.translation_m().head<2>();
  show_step("picking " + pick.model + " for place " + std::to_string(pick.place_slot + 1));
  if (auto ready = arm_.poll(Arm::Need::running); !ready) return tl::unexpected(ready.error());
  ledger_.begin({pick, static_cast<std::size_t>(part->model_index), part_m, 0, 0});
  const auto sequence = arm_.robot().submit(pick);
  if (!sequence && sequence.error().code == core::ErrorCode::safety) {
    ledger_.give_back("safety", sequence.error().line());
    return judge({OutcomeKind::refused, 0, 0, sequence.error().why});
  }
  if (!sequence) return arm_.failed(sequence.error(), "handing over " + pick.model);
  if (auto logged = ledger_.handed_over(*sequence); !logged)
    return tl::unexpected(halt_from(logged.error(), "recording"));
  const auto outcome = wait_for_outcome();
  if (!outcome) return tl::unexpected(outcome.error());
  if (auto logged = ledger_.end(*outcome); !logged) return tl::unexpected(halt_from(logged.error(), "recording"));
  return judge(*outcome);
}

Or<robot::Outcome> Cell::wait_for_outcome() {
  const core::TimePoint deadline = seat_->now() + duration_s(settings_.pick_timeout_s);
  for (;;) {
    if (auto state = rest(Arm::Need::running); !state) return tl::unexpected(state.error());
    auto outcome = arm_.robot().outcome();
    if (!outcome) return arm_.failed(outcome.error(), "waiting for the end of the pick");
    if (*outcome) return **outcome;
    if (seat_->now() > deadline) {
      arm_.hold();
      return fault("PICK_TIMEOUT", "the pick did not end in time; the arm was told to hold",
                   "look at the arm; then press Reset, and Start finishes or drops the pick");
    }
  }
}

Or<void> Cell::judge(const robot::Outcome& outcome) {
  publish();
  switch (outcome.kind) {
    case OutcomeKind::done:
      refused_in_row_ = empty_in_row_ = 0;
      return {};
    case OutcomeKind::unknown: {
      Halt halt{Mode::fault, "OUTCOME_UNKNOWN",
                "nobody can say what became of pick " + std::to_string(outcome.sequence),
                "look at the arm, its gripper and the tray, then press Reset", false};
      halt.person_must_look = true;
      return tl::unexpected(std::move(halt));
    }
    case OutcomeKind::refused:
    case OutcomeKind::not_started:
      break;
  }
  // The part may have been pushed: what this picture says about its neighbours is no longer sure.
  queue_.clear();
  if (++refused_in_row_ < settings_.stop_after_refused) return {};
  return fault("REFUSED_IN_ROW",
               std::to_string(refused_in_row_) + " picks in a row failed, the last one: " + outcome.text,
               "look at gripper, parts and calibration, then press Reset");
}

Or<void> Cell::recall_trays() {
  if (!trays_) return {};
  const auto filled = trays_->filled();
  if (!filled) return tl::unexpected(halt_from(filled.error(), "reading which places are filled"));
  const std::vector<picks::PartPlan>& parts = settings_.planner.parts;
  ledger_.tray().forget();
  for (const FilledPlace& place : *filled)
    for (std::size_t kind = 0; kind < parts.size(); ++kind)
      if (parts[kind].model == place.model && place.slot < parts[kind].place.size())
        ledger_.tray().take(kind, place.slot);
  return {};
}

Or<void> Cell::exchange_full_trays() {
  for (const std::size_t kind : ledger_.tray().empty_full_ones()) {
    if (!trays_) continue;
    if (auto recorded = trays_->exchanged(settings_.planner.parts[kind].model); !recorded)
      return tl::unexpected(halt_from(recorded.error(), "recording an exchanged tray"));
  }
  return {};
}

Or<void> Cell::feed() {
  if (!full_tray_.empty() && settings_.exchange_full_trays) {
    full_tray_.clear();
    return exchange_full_trays();
  }
  if (!full_tray_.empty())
    return stand("TRAY_FULL", "the tray of " + full_tray_ + " is full", "put an empty tray there, then press Start");
  if (settings_.feed.empty_pitches_max > 0 && ++empty_in_row_ > settings_.feed.empty_pitches_max)
    return stand("NO_PARTS",
                 "no part to pick in the last " + std::to_string(settings_.feed.empty_pitches_max) + " looks",
                 "bring parts, then press Start");
  if (settings_.feed.kind == FeedKind::indexed) return move_belt();
  show_step("waiting for parts");
  const core::TimePoint until = seat_->now() + duration_s(settings_.feed.look_again_s);
  while (seat_->now() < until && !desk_.asked(Command::stop))
    if (auto state = rest(Arm::Need::running); !state) return tl::unexpected(state.error());
  return {};
}

/// What stopped the cell may have stopped it in the middle of a pitch, which ends by itself.
Or<void> Cell::wait_until_belt_stands() {
  if (settings_.feed.kind != FeedKind::indexed) return {};
  const core::TimePoint deadline = seat_->now() + duration_s(settings_.feed.timeout_s);
  for (;;) {
    const auto moving = arm_.robot().read_contact(settings_.feed.moving_contact);
    if (!moving) return arm_.failed(moving.error(), "watching the belt");
    if (!*moving) return {};
    show_step("waiting until the belt stands");
    if (seat_->now() > deadline)
      return fault("FEED", "the belt does not stop", "look at the belt's drive and its signals, then press Reset");
    if (auto state = rest(Arm::Need::running); !state) return tl::unexpected(state.error());
  }
}

Or<void> Cell::move_belt() {
  show_step("moving the belt");
  auto moved = ask_for_pitch();
  // Whatever the end: a belt that looks at the level, not at the edge, must not run on. What went wrong first is said.
  auto released = arm_.robot().write_contact(settings_.feed.advance_contact, false);
  if (!moved) return moved;
  if (!released) return arm_.failed(released.error(), "moving the belt");
  ledger_.standing().forget();
  return {};
}

Or<void> Cell::ask_for_pitch() {
  robot::Robot& robot = arm_.robot();
  // A fault during an earlier feed may have left it on, and the feeder waits for the edge.
  const auto left_on = robot.read_contact(settings_.feed.advance_contact);
  if (!left_on) return arm_.failed(left_on.error(), "moving the belt");
  if (*left_on) {
    if (auto released = robot.write_contact(settings_.feed.advance_contact, false); !released)
      return arm_.failed(released.error(), "moving the belt");
    if (auto state = rest(Arm::Need::running); !state) return tl::unexpected(state.error());
  }
  if (auto asked = robot.write_contact(settings_.feed.advance_contact, true); !asked)
    return arm_.failed(asked.error(), "moving the belt");
  const core::TimePoint start = seat_->now();
  bool moved = false;
  for (;;) {
    if (auto state = rest(Arm::Need::running); !state) return tl::unexpected(state.error());
    const auto moving = robot.read_contact(settings_.feed.moving_contact);
    if (!moving) return arm_.failed(moving.error(), "watching the belt");
    if (moved && !*moving) return {};
    moved = moved || *moving;
    const core::Duration waited = seat_->now() - start;
    if ((!moved && waited > kBeltReacts) || waited > duration_s(settings_.feed.timeout_s))
      return fault("FEED", moved ? "the belt does not stop" : "the belt does not move",
                   "look at the belt's drive and its signals, then press Reset");
  }
}

}  // namespace pickcell::cell
