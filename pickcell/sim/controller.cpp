#include "pickcell/sim/controller.hpp"

#include <stdexcept>
#include <utility>

#include "pickcell/sim/hses_commands.hpp"
#include "pickcell/sim/job_interpreter.hpp"

namespace pickcell::sim {

namespace {

Tcp80Settings door(const ControllerSettings& settings) {
  const auto type = controller_type(settings.type);
  if (!type) throw std::invalid_argument("unknown controller type " + settings.type);
  return {settings.bind, settings.tcp80_port, settings.banner.empty() ? std::string(type->banner) : settings.banner,
          settings.segment_pause_s};
}

/// Interpolation period and byte order of the controllers that speak MotoROS.
std::unique_ptr<MotoRosDoor> motoros_door(const ControllerSettings& settings, MotoRosDoor::WithState with_state,
                                          MotoRosDoor::Commanded commanded, AnswerFaults& faults) {
  if (!settings.motoros_port) return nullptr;
  const bool fs100 = settings.type == "fs100";
  MotoRosDoorSettings door{settings.bind, *settings.motoros_port,
                           settings.motoros_order.value_or(fs100 ? robot::ByteOrder::big : robot::ByteOrder::little)};
  MotoRosSettings motion;
  if (fs100) motion.increment_s = 0.002;
  return std::make_unique<MotoRosDoor>(door, motion, std::move(with_state), std::move(commanded), faults);
}

constexpr std::uint16_t kBusy = 0xD8F1, kBusyFiles = 0xE444;

AnswerFault answer_fault(Fault fault) {
  switch (fault) {
    case Fault::twice:
      return AnswerFault::twice;
    case Fault::late:
      return AnswerFault::late;
    case Fault::truncate:
      return AnswerFault::truncate;
    case Fault::half_line:
      return AnswerFault::half_line;
    case Fault::reset_after_ok:
      return AnswerFault::reset_after_ok;
    default:
      return AnswerFault::drop;
  }
}

}  // namespace

core::Result<std::unique_ptr<Controller>> Controller::switch_on(const ControllerSettings& settings, core::Clock& clock,
                                                                Plant* plant) {
  std::unique_ptr<Controller> controller(new Controller(settings, clock, plant));
  if (auto opened = controller->open_doors(); !opened) return core::forward(opened);
  controller->life_ = std::jthread([c = controller.get()] { c->live(); });
  return controller;
}

Controller::Controller(const ControllerSettings& settings, core::Clock& clock, Plant* plant)
    : clock_(clock),
      plant_(plant),
      tick_s_(settings.tick_s),
      wired_inputs_(settings.wired_inputs),
      state_(settings),
      seat_(clock.join("controller")),
      tcp80_(
          door(settings),
          [this](std::string_view command, std::string_view operands) { return execute(command, operands); },
          answer_faults_),
      hses_(
          {settings.bind, settings.hses_port}, [this](const robot::HsesRequest& r) { return execute(r); },
          answer_faults_),
      motoros_(motoros_door(
          settings, [this](const auto& action) { with_scanned_state(action); },
          [this](ControllerState& state, std::string_view command) {
            for (const FaultEvent& event : plan_.after(command)) apply(state, event, command);
          },
          answer_faults_)) {
  state_.unix_us = state_.switched_on_unix_us = clock.unix_us();
  if (!(tick_s_ > 0)) throw std::invalid_argument("a tick must be longer than 0 s");
}

core::Status Controller::open_doors() {
  if (auto opened = tcp80_.open(); !opened) return opened;
  auto opened = hses_.open();
  if (opened && motoros_) opened = motoros_->open();
  if (!opened) {
    tcp80_.close();
    hses_.close();
  }
  return opened;
}

Controller::~Controller() {
  tcp80_.close();
  hses_.close();
  if (motoros_) motoros_->close();
  stopping_ = true;
  if (life_.joinable()) {
    seat_->interrupt();
    life_.join();
  }
}

void Controller::live() {
  // Waits before the first tick too: only a sleeping party has its turn, and until then commands of others may come
  // before or after, as the machine likes.
  core::TimePoint next = seat_->now();
  for (;;) {
    next += core::duration_s(tick_s_);
    seat_->sleep_until(next);
    if (stopping_) return;
    tick();
  }
}

GeneralContacts Controller::scan_inputs() const {
  GeneralContacts inputs;
  if (!plant_) return inputs;
  const core::TimePoint now = clock_.now();
  for (int n = 1; n <= wired_inputs_; ++n) inputs[static_cast<std::size_t>(n)] = plant_->input(n, now);
  return inputs;
}

Controller::ForPlant Controller::take_events(ControllerState& state) {
  return {std::exchange(state.output_events, {}), std::exchange(state.contact_events, {}), state.T_base_tool()};
}

void Controller::deliver(const ForPlant& events) {
  if (!plant_) return;
  const core::TimePoint now = clock_.now();
  for (const OutputEvent& e : events.outputs) plant_->output_changed(e.n, e.on, events.T_base_tool, now);
  for (const ContactEvent& e : events.contacts) plant_->contact_written(e.contact, e.on, now);
}

void Controller::tick() {
  const GeneralContacts inputs = scan_inputs();
  ForPlant events;
  {
    const std::lock_guard lock(mutex_);
    state_.inputs = inputs;
    state_.unix_us = clock_.unix_us();
    for (const FaultEvent& event : plan_.due(core::seconds(clock_.now() - plan_start_), state_.move.has_value()))
      apply(state_, event, {});
    run_tick(state_, tick_s_);
    if (motoros_) motoros_->tick(state_, tick_s_);
    events = take_events(state_);
  }
  deliver(events);
}

Tcp80Answer Controller::execute(std::string_view command, std::string_view operands) {
  const GeneralContacts inputs = scan_inputs();
  ForPlant events;
  Tcp80Answer answer;
  {
    const std::lock_guard lock(mutex_);
    state_.inputs = inputs;
    answer = execute_tcp80(state_, command, operands);
    for (const FaultEvent& event : plan_.after(command)) apply(state_, event, command);
    events = take_events(state_);
  }
  deliver(events);
  return answer;
}

HsesServer::Executed Controller::execute(const robot::HsesRequest& request) {
  const bool files = request.division == robot::HsesDivision::file;
  HsesServer::Executed done;
  done.name = files ? "FILE" : hses_command_name(request);
  const GeneralContacts inputs = scan_inputs();
  ForPlant events;
  {
    const std::lock_guard lock(mutex_);
    state_.inputs = inputs;
    const std::vector<FaultEvent> events_of_it = plan_.after(done.name);
    if (busy(events_of_it))
      done.answer = hses_refusal(request, files ? kBusyFiles : kBusy);
    else
      done.answer = files ? files_.handle(state_, request) : execute_hses(state_, request);
    done.try_again_soon = files && done.answer && HsesFiles::in_use(*done.answer);
    for (const FaultEvent& event : events_of_it) apply(state_, event, done.name);
    events = take_events(state_);
  }
  deliver(events);
  return done;
}

void Controller::with_scanned_state(const std::function<void(ControllerState&)>& action) {
  const GeneralContacts inputs = scan_inputs();
  with_state([&](ControllerState& state) {
    state.inputs = inputs;
    action(state);
  });
}

bool Controller::busy(const std::vector<FaultEvent>& events) {
  for (const FaultEvent& event : events) busy_left_ += event.fault == Fault::busy ? event.count : 0;
  if (busy_left_ == 0) return false;
  --busy_left_;
  return true;
}

void Controller::apply(ControllerState& state, const FaultEvent& event, std::string_view command) {
  switch (event.fault) {
    case Fault::alarm:
      return state.raise_alarm({event.code, 0, "alarm of the scenario"});
    case Fault::estop:
      return state.press_emergency_stop();
    case Fault::teach:
      return state.turn_key_to_teach();
    case Fault::hold:
      state.hold_pendant = true;
      return;
    case Fault::servo_off:
      state.servo = false;
      return;
    case Fault::busy:
      // With a command it was counted when that command came; TCP 80 has no such answer.
      if (command.empty()) busy_left_ += event.count;
      return;
    default:
      answer_faults_.inject({answer_fault(event.fault), event.count, std::string(command), event.delay_s});
  }
}

ToolPose Controller::T_base_tool() const {
  const std::lock_guard lock(mutex_);
  return state_.T_base_tool();
}

FlangePose Controller::T_base_flange() const {
  const std::lock_guard lock(mutex_);
  return state_.T_base_flange();
}

void Controller::with_state(const std::function<void(ControllerState&)>& action) {
  ForPlant events;
  {
    const std::lock_guard lock(mutex_);
    action(state_);
    events = take_events(state_);
  }
  deliver(events);
}

ControllerState Controller::copy_of_state() const {
  const std::lock_guard lock(mutex_);
  return state_;
}

void Controller::follow(std::vector<FaultEvent> scenario) {
  const std::lock_guard lock(mutex_);
  plan_ = FaultPlan(std::move(scenario));
  busy_left_ = 0;
  plan_start_ = clock_.now();
}

void Controller::inject(const FaultEvent& event) {
  const std::lock_guard lock(mutex_);
  if (event.mid_move)
    plan_.add_for_next_move(event);
  else
    apply(state_, event, {});
}

void Controller::kill() {
  tcp80_.close();
  hses_.close();
  if (motoros_) motoros_->close();
  with_state([this](ControllerState& state) {
    state.lose_power();
    files_ = {};
  });
}

core::Status Controller::revive() { return open_doors(); }

}  // namespace pickcell::sim
