#include "pickcell/sim/job_interpreter.hpp"

#include <cmath>
#include <limits>
#include <utility>

#include "pickcell/core/units.hpp"
#include "pickcell/sim/controller_contacts.hpp"
#include "pickcell/sim/job_values.hpp"
#include "pickcell/sim/position_solver.hpp"

namespace pickcell::sim {

namespace {

constexpr int kInstructionsPerTick = 50;
constexpr std::size_t kCallDepth = 10;

/// What an instruction leaves behind.
enum class After {
  next,    ///< go on with the following line, or where the instruction jumped to
  busy,    ///< not finished: the same line again in the next tick
  scan,    ///< finished, but the outputs go out first
  halted,  ///< the job stopped: end, pause or alarm
};

class Interpreter {
 public:
  Interpreter(ControllerState& state, double dt_s) : s_(state), t_(state.task), dt_s_(dt_s) {}

  void tick() {
    const auto runs = [this] { return t_.running || s_.direct_move; };
    if (s_.motion_blocked() && runs()) s_.stopping = true;
    carry_on();
    if (!runs()) s_.stopping = false;
  }

 private:
  void carry_on() {
    if (s_.move && !advance_move()) return;
    if (!t_.running) return;
    if (blocked()) {
      t_.running = false;
      return;
    }
    for (int n = 0; n < kInstructionsPerTick && t_.running; ++n) {
      const After after = step();
      if (after == After::halted) t_.running = false;
      if (after == After::busy || after == After::halted) return;
      if (s_.cycle == CycleMode::step) t_.running = false;
      if (after == After::scan) return;
    }
  }

  /// A stop that has begun comes to its end, also when its cause is gone before.
  [[nodiscard]] bool blocked() const { return s_.motion_blocked() || s_.stopping; }

  /// True when the arm stands and the job may go on.
  bool advance_move() {
    if (blocked())
      s_.move->stop(s_.servo && s_.play ? s_.limits.hold_ramp_s : s_.limits.emergency_ramp_s);
    else if (t_.running || s_.direct_move)
      s_.move->resume();
    else
      return false;  // a stopped job's move waits for START
    const Move::Step step = s_.move->advance(dt_s_);
    s_.q = step.q;
    if (step.fault) {
      s_.move.reset();
      alarm_of(*step.fault);
    } else if (step.finished) {
      s_.move.reset();
      if (!std::exchange(s_.direct_move, false)) {
        finish_line();
        if (s_.cycle == CycleMode::step) t_.running = false;
      }
    } else if (s_.move->at_rest()) {
      if (std::exchange(s_.direct_move, false)) s_.move.reset();  // a direct move is not carried on
      t_.running = false;
    } else {
      return false;
    }
    if (blocked()) s_.direct_move = t_.running = false;
    return true;
  }

  After alarm(int code, int data, std::string text) {
    s_.raise_alarm({code, data, std::move(text)});
    s_.direct_move = false;
    return After::halted;
  }

  After alarm_of(MoveFault fault) {
    const int code = fault == MoveFault::axis_limit ? kAlarmPulseLimit
                     : fault == MoveFault::too_fast ? kAlarmExcessiveSpeed
                                                    : kAlarmOutOfReach;
    return alarm(code, static_cast<int>(t_.at.line), std::string(name(fault)));
  }

  After value_alarm() {
    return alarm(kAlarmVariableRange, static_cast<int>(t_.at.line), "variable or value out of range");
  }

  const Instruction& line() const { return t_.at.job->lines[t_.at.line]; }

  void finish_line() {
    if (line().op == Op::move_joint || line().op == Op::move_line) t_.step = t_.at.job->step_at(t_.at.line);
    t_.begun = false;
    ++t_.at.line;
  }

  After go_to(std::size_t target) {
    t_.begun = false;
    t_.at.line = target;
    return After::next;
  }

  After done() {
    finish_line();
    return After::next;
  }

  After step() {
    const Instruction& i = line();
    switch (i.op) {
      case Op::end:
        return end();
      case Op::ret:
        return t_.callers.empty() ? end() : give_back();
      case Op::pause:
        finish_line();
        return After::halted;
      case Op::jump:
        return when(i, [&] { return go_to(i.target); });
      case Op::call:
        return when(i, [&] { return call(i.text); });
      case Op::set:
      case Op::add:
      case Op::sub:
      case Op::mul:
      case Op::div:
      case Op::inc:
      case Op::dec:
        return arithmetic(i);
      case Op::get_element:
      case Op::set_element:
        return element(i);
      case Op::move_joint:
      case Op::move_line:
        return begin_move(i);
      case Op::timer:
        return pass_time(i.value) ? done() : After::busy;
      case Op::wait:
        return wait(i);
      case Op::output:
        return output(i);
      case Op::if_then:
        return branch();
      case Op::while_do:
        return loop(i);
      case Op::else_if:
      case Op::otherwise:
        return go_to(i.exit);  // reached from above: the branch before was run
      case Op::end_while:
        return go_to(i.target);
      case Op::nop:
      case Op::label:
      case Op::comment:
      case Op::end_if:
        return done();
    }
    return done();
  }

  After end() {
    if (!t_.callers.empty()) return give_back();
    t_.step = 0;
    (void)go_to(0);
    return s_.cycle == CycleMode::continuous ? After::scan : After::halted;
  }

  After give_back() {
    t_.at = t_.callers.back();
    t_.callers.pop_back();
    return done();
  }

  After call(const std::string& job) {
    const auto found = s_.jobs.find(job);
    if (found == s_.jobs.end() || t_.callers.size() >= kCallDepth)
      return alarm(kAlarmNoSuchJob, static_cast<int>(t_.at.line), "cannot call " + job);
    t_.callers.push_back(t_.at);
    t_.at.job = found->second;
    return go_to(0);
  }

  template <class Action>
  After when(const Instruction& i, Action action) {
    const auto go = i.condition ? job_values::holds(s_, *i.condition) : true;
    if (!go) return value_alarm();
    return *go ? action() : done();
  }

  After loop(const Instruction& i) {
    const auto holds = job_values::holds(s_, *i.condition);
    if (!holds) return value_alarm();
    return *holds ? done() : go_to(i.target);
  }

  /// From IFTHENEXP along the failed tests to the branch to run.
  After branch() {
    std::size_t at = t_.at.line;
    while (true) {
      const Instruction& i = t_.at.job->lines[at];
      if (!i.condition) return go_to(at + 1);  // ELSE or ENDIF
      const auto holds = job_values::holds(s_, *i.condition);
      if (!holds) return value_alarm();
      if (*holds) return go_to(at + 1);
      at = i.target;
    }
  }

  After arithmetic(const Instruction& i) {
    if (i.a.kind == Operand::Kind::P) return copy_position(i);
    if (i.a.kind == Operand::Kind::S) return copy_text(i);
    const auto a = job_values::value(s_, i.a);
    const auto b = i.op == Op::inc || i.op == Op::dec ? 1.0 : job_values::value(s_, i.b);
    if (!a || !b || (i.op == Op::div && *b == 0)) return value_alarm();
    double result = *b;
    if (i.op == Op::add || i.op == Op::inc) result = *a + *b;
    if (i.op == Op::sub || i.op == Op::dec) result = *a - *b;
    if (i.op == Op::mul) result = *a * *b;
    if (i.op == Op::div) result = i.a.kind == Operand::Kind::R ? *a / *b : std::trunc(*a / *b);
    return job_values::assign(s_, i.a, result) ? done() : value_alarm();
  }

  std::optional<Position>* variable(const Operand& o) {
    return static_cast<std::size_t>(o.index) < s_.P.size() ? &s_.P[static_cast<std::size_t>(o.index)] : nullptr;
  }

  After copy_position(const Instruction& i) {
    auto* to = variable(i.a);
    const auto* from = variable(i.b);
    if (!to || !from) return value_alarm();
    if (!*from) return undefined_position();
    *to = *from;
    return done();
  }

  After copy_text(const Instruction& i) {
    const auto index = [](const Operand& o) { return static_cast<std::size_t>(o.index); };
    if (index(i.a) >= s_.S.size() || (i.b.kind == Operand::Kind::S && index(i.b) >= s_.S.size())) return value_alarm();
    const std::string text = i.b.kind == Operand::Kind::S ? s_.S[index(i.b)] : i.b.text;
    constexpr std::size_t kBytes = 16;
    if (text.size() > kBytes) return value_alarm();
    s_.S[index(i.a)] = text;
    return done();
  }

  After undefined_position() {
    return alarm(kAlarmUndefinedPosition, static_cast<int>(t_.at.line), "position variable not set");
  }

  After element(const Instruction& i) {
    auto* p = variable(i.a);
    if (!p) return value_alarm();
    if (!*p) return undefined_position();
    std::int32_t& axis = (*p)->axis[static_cast<std::size_t>(i.element - 1)];
    if (i.op == Op::get_element) return job_values::assign(s_, i.b, axis) ? done() : value_alarm();
    const auto v = job_values::value(s_, i.b);
    if (!v || std::abs(*v) > std::numeric_limits<std::int32_t>::max()) return value_alarm();
    axis = static_cast<std::int32_t>(std::lround(*v));
    return done();
  }

  After begin_move(const Instruction& i) {
    std::optional<Position> target;
    if (i.a.kind == Operand::Kind::P) {
      const auto* p = variable(i.a);
      if (!p) return value_alarm();
      target = *p;
    } else if (const auto taught = t_.at.job->taught.find(i.a.index); taught != t_.at.job->taught.end()) {
      target = taught->second;
    }
    if (!target) return undefined_position();
    const double turn = i.turning ? core::rad_from_deg(i.value) : s_.limits.turn_speed_rad_s;
    constexpr double kNoLimit_m_s = 1e3;  // with VR the turn alone sets the time
    auto planned = i.op == Op::move_joint
                       ? plan_joint_move(s_, *target, i.value / 100)
                       : plan_line(s_, *target, i.turning ? kNoLimit_m_s : core::m_from_mm(i.value), turn);
    if (const auto* fault = std::get_if<MoveFault>(&planned)) return alarm_of(*fault);
    s_.move = std::get<Move>(planned);
    s_.tool = target->tool;
    return After::busy;
  }

  /// True when the time since the line was begun is over. The tick in which it begins does not count.
  bool pass_time(double whole_s) {
    if (!std::exchange(t_.begun, true))
      t_.left_s = whole_s;
    else
      t_.left_s -= dt_s_;
    return t_.left_s < dt_s_ * 1e-6;
  }

  After wait(const Instruction& i) {
    const auto holds = job_values::holds(s_, *i.condition);
    if (!holds) return value_alarm();
    if (*holds) return done();
    return i.value >= 0 && pass_time(i.value) ? done() : After::busy;
  }

  After output(const Instruction& i) {
    if (i.a.index > s_.type.general_groups * 8) return value_alarm();
    set_output(s_, i.a.index, i.value != 0);
    finish_line();
    return After::scan;
  }

  ControllerState& s_;
  Task& t_;
  double dt_s_;
};

}  // namespace

void run_tick(ControllerState& state, double dt_s) { Interpreter(state, dt_s).tick(); }

}  // namespace pickcell::sim
