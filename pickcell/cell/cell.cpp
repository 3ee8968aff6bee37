#include "pickcell/cell/cell.hpp"

#include "pickcell/core/log.hpp"
#include "pickcell/core/units.hpp"

namespace pickcell::cell {

using core::ErrorCode;
using core::failure;

namespace {

std::vector<int> tray_sizes(const picks::PlannerSettings& planner) {
  std::vector<int> sizes;
  for (const picks::PartPlan& part : planner.parts) sizes.push_back(part.place.size());
  return sizes;
}

Eigen::Vector3d metres(const std::array<double, 3>& mm) {
  return {core::m_from_mm(mm[0]), core::m_from_mm(mm[1]), core::m_from_mm(mm[2])};
}

picks::PlacePattern pattern_from(const PlaceConfig& place, double height_m) {
  picks::PlacePattern out;
  out.origin_m = metres(place.origin_mm) + Eigen::Vector3d(0, 0, height_m);
  out.angle_rad = core::rad_from_deg(place.angle_deg);
  out.rows = place.rows;
  out.cols = place.cols;
  out.pitch_x_m = core::m_from_mm(place.pitch_x_mm);
  out.pitch_y_m = core::m_from_mm(place.pitch_y_mm);
  return out;
}

}  // namespace

CellSettings settings_from(const CellConfig& config, const std::vector<matches::Model>& models) {
  CellSettings out;
  out.name = config.name;
  out.robot_link = config.robot.link;
  out.allow_motion = config.robot.allow_motion;
  out.feed = config.feed;
  out.exchange_full_trays = config.exchange_full_trays;
  out.stop_after_refused = config.stop_after_refused;
  out.attempts_per_part = config.attempts_per_part;
  out.pick_timeout_s = config.pick_timeout_s;
  out.camera_wait_s = config.camera_wait_s;
  out.planner.box = {metres(config.limits.box_min_mm), metres(config.limits.box_max_mm)};
  out.planner.grasp_tolerance_m = core::m_from_mm(config.limits.grasp_mm);
  out.planner.grasp_tolerance_rad = core::rad_from_deg(config.limits.grasp_deg);
  out.planner.approach_m = core::m_from_mm(config.limits.approach_mm);
  out.planner.gripper_length_m = core::m_from_mm(config.limits.gripper_length_mm);
  out.planner.gripper_width_m = core::m_from_mm(config.limits.gripper_width_mm);
  for (std::size_t i = 0; i < models.size(); ++i) {
    out.planner.parts.push_back(
        {models[i].name, static_cast<int>(i), pattern_from(config.parts.at(i).place, models[i].height_m)});
    out.recipe += (i ? "+" : "") + models[i].name;
  }
  return out;
}

Cell::Cell(CellParts parts, CellSettings settings)
    : clock_(parts.clock),
      seat_(std::move(parts.seat)),
      source_(parts.source),
      vision_(std::move(parts.vision)),
      settings_(std::move(settings)),
      ledger_(std::move(parts.log), desk_, clock_, tray_sizes(settings_.planner)),
      arm_(parts.robot, clock_, *seat_, settings_.robot_link),
      camera_(source_),
      trays_(parts.trays),
      camera_check_(std::move(parts.camera_check)) {
  show(Mode::idle, "connecting to the robot");
}

Cell::~Cell() { close(); }

void Cell::open() {
  if (thread_.joinable()) throw std::logic_error("the cell is open already");
  thread_ = std::thread([this] { live(); });
}

void Cell::close() {
  if (!thread_.joinable()) return;
  quit_ = true;
  seat_->interrupt();
  thread_.join();
  seat_.reset();  // so that the clock does not wait for a party that is gone
}

void Cell::wait_until_done() const {
  desk_.wait_until(
      [this](const Snapshot& s) { return has_stopped_ && (s.mode == Mode::idle || s.mode == Mode::fault); });
}

core::Status Cell::start() {
  const Snapshot now = snapshot();
  const auto refuse = [](std::string why, std::string remedy = {}) {
    return failure(ErrorCode::refused, "start", std::move(why), std::move(remedy));
  };
  if (now.mode == Mode::fault) return refuse("the cell is in fault: " + now.reason, "press Reset first");
  if (now.mode != Mode::idle) return refuse(std::string("the cell is ") + name(now.mode));
  if (!now.robot.connected) return refuse("the robot is not connected yet");
  if (!settings_.allow_motion)
    return refuse("motion is not allowed by the cell file", "set allow_motion = true in [robot]");
  if (!now.start_hindrance.empty()) return refuse(now.start_hindrance, now.start_remedy);
  desk_.ask(Command::start);
  return {};
}

core::Status Cell::stop_cycle() {
  desk_.ask(Command::stop);
  return {};
}

core::Status Cell::reset() {
  const Mode mode = snapshot().mode;
  if (mode == Mode::running || mode == Mode::stopping)
    return failure(ErrorCode::refused, "reset", std::string("the cell is ") + name(mode), "stop the cycle first");
  desk_.ask(Command::reset);
  return {};
}

void Cell::live() {
  if (auto recalled = recall_trays(); !recalled)
    enter(recalled.error());
  else if (auto connected = arm_.connect(); !connected)
    enter(connected.error());
  else if (auto settled = settle(); !settled)
    enter(settled.error());
  else
    show(Mode::idle, "ready");
  if (settings_.start_at_once && mode_ == Mode::idle) desk_.ask(Command::start);
  if (settings_.start_at_once && mode_ == Mode::fault) {
    has_stopped_ = true;
    publish();
  }
  while (!quit_) {
    if (desk_.take(Command::reset)) do_reset();
    if (mode_ == Mode::idle && desk_.take(Command::start)) {
      const Halt halt = work();
      // Nobody sees any more what the arm does: it is told to stand, and never to go on.
      if (halt.code == "LINK_TIMEOUT" || halt.code == "LINK_LOST") arm_.hold();
      has_stopped_ = true;
      enter(halt);
    }
    if (quit_) return;
    seat_->sleep_for(Arm::kPoll);
    watch_camera();
    if (auto standing = stand_by(); !standing && mode_ == Mode::idle) enter(standing.error());
    desk_.take(Command::stop);
  }
}

/// A cell in fault looks on too, so that what the page shows of the arm is true; its reason stays the first one.
Or<void> Cell::stand_by() {
  if (mode_ == Mode::fault && !arm_.robot().connected()) return {};
  const auto state = arm_.poll(Arm::Need::nothing);
  publish();
  if (!state) return tl::unexpected(state.error());
  return {};
}

void Cell::do_reset() {
  show(mode_, "resetting");
  const auto done = arm_.reset(person_must_look_);
  auto settled = settle();
  if (!done) return enter(done.error());
  if (!settled) return enter(settled.error());
  person_must_look_ = false;
  arm_.alarms().clear_all(clock_.unix_us());
  camera_.alarms_cleared();
  watch_camera();
  reason_code_.clear();
  reason_.clear();
  remedy_.clear();
  desk_.take(Command::start);
  show(Mode::idle, "ready");
}

void Cell::enter(const Halt& halt) {
  reason_code_ = halt.code;
  reason_ = halt.why;
  remedy_ = halt.remedy;
  queue_.clear();
  const bool wrong = halt.next == Mode::fault;
  person_must_look_ = halt.person_must_look || (wrong && ledger_.open());
  if (wrong && ledger_.open())
    remedy_ += ". A pick was under way: look at the arm and take a part out of its gripper before Reset";
  if (wrong)
    arm_.alarms().raise(halt.code, 1, "The cell stopped: " + halt.why, halt.why, {halt.remedy}, clock_.unix_us());
  core::log(wrong ? core::LogLevel::error : core::LogLevel::info, "cell",
            halt.code + ": " + halt.why + (halt.remedy.empty() ? "" : "; " + halt.remedy));
  if (auto logged = ledger_.event(halt.code, halt.why); !logged)
    core::log(core::LogLevel::error, "cell", logged.error().line());
  show(halt.next, wrong ? "stopped by a fault" : "ready");
}

void Cell::show(Mode mode, std::string step) {
  mode_ = mode;
  step_ = std::move(step);
  publish();
}

void Cell::watch_camera() {
  if (camera_.look(arm_.alarms(), clock_.unix_us())) publish();
}

void Cell::publish() {
  Snapshot s;
  s.cell_name = settings_.name;
  s.mode = mode_;
  s.step = step_;
  s.reason = reason_;
  s.reason_code = reason_code_;
  s.remedy = remedy_;
  s.robot = arm_.view();
  s.camera = camera_.view();
  s.counters = ledger_.counters();
  s.alarms = arm_.alarms().rows();
  s.recipe = settings_.recipe;
  s.simulated = settings_.simulated;
  auto hindrance = arm_.hindrance();
  if (!hindrance) hindrance = camera_.hindrance();
  if (hindrance) {
    s.start_hindrance = hindrance->why;
    s.start_remedy = hindrance->remedy;
  }
  desk_.publish(std::move(s));
}

}  // namespace pickcell::cell
