#pragma once
/// The real job VISPICK as the model checker steps it.

#include <cstdint>
#include <vector>

#include "hand_over_model_state.hpp"
#include "pickcell/sim/job_program.hpp"

namespace pickcell::robot {
namespace hand_over_model {

/// The job, one shared variable at a time.
class Job {
 public:
  Job(const sim::JobProgram& program, Without without) : lines_(program.lines), without_(without) {}

  /// One step of the running job and all that follows it unseen.
  void step(State& s) const {
    bool touched = false;
    for (;;) {
      const auto& i = lines_[static_cast<std::size_t>(s.line)];
      if (shared(i)) {
        if (touched) return;
        touched = true;
      }
      execute(s, i);
      if (s.line < 0 || i.op == sim::Op::timer) {
        // After a wait the job asks none of its own copies before it has made new ones.
        for (const Cell own : {kI21, kD21, kD22, kP21}) s.cells[own] = 0;
        return;
      }
    }
  }

 private:
  static int cell(const Operand& o) {
    const auto in = [&](int first, int last, int base) {
      return o.index >= first && o.index <= last ? base + o.index - first : -1;
    };
    switch (o.kind) {
      case Operand::Kind::B:
        return in(10, 13, kB10);
      case Operand::Kind::I:
        return o.index == 21 ? kI21 : in(10, 14, kI10);
      case Operand::Kind::D:
        return o.index == 21 ? kD21 : o.index == 22 ? kD22 : in(10, 13, kD10);
      case Operand::Kind::P:
        return o.index == 10 ? kP10 : o.index == 21 ? kP21 : -1;
      default:
        return -1;
    }
  }

  /// Seen by the PC, or written by it.
  static bool shared(int cell) {
    return cell >= 0 && cell != kB12 && cell != kI21 && cell != kD21 && cell != kD22 && cell != kP21;
  }
  static bool shared(const sim::Instruction& i) {
    if (i.op == sim::Op::output) return true;
    bool any = shared(cell(i.a)) || shared(cell(i.b));
    if (i.condition) {
      for (const auto& t : i.condition->terms) any = any || shared(cell(t.left)) || shared(cell(t.right));
    }
    return any;
  }

  std::int32_t value(const State& s, const Operand& o) const {
    const int c = cell(o);
    return c >= 0 ? s.cells[static_cast<std::size_t>(c)] : static_cast<std::int32_t>(o.number);
  }

  /// Contacts and the window never hinder; without the fence the job does not ask for epochs.
  bool holds(const State& s, const sim::Condition& condition) const {
    for (const auto& t : condition.terms) {
      if (t.left.kind == Operand::Kind::IN || cell(t.left) < 0) return false;
      const bool of_number = cell(t.right) == kD22, of_command = cell(t.left) == kI13;
      if (without_ == Without::fence && (of_number || of_command)) return false;
      if (without_ == Without::epoch_in_the_number && of_number) return false;
      if (without_ == Without::command_epoch && of_command) return false;
      const std::int32_t l = value(s, t.left), r = value(s, t.right);
      const bool yes = t.compare == sim::Compare::equal        ? l == r
                       : t.compare == sim::Compare::not_equal  ? l != r
                       : t.compare == sim::Compare::less       ? l < r
                       : t.compare == sim::Compare::greater    ? l > r
                       : t.compare == sim::Compare::less_equal ? l <= r
                                                               : l >= r;
      if (!yes) return false;
    }
    return true;
  }

  void execute(State& s, const sim::Instruction& i) const {
    int next = s.line + 1;
    switch (i.op) {
      case sim::Op::jump:
        if (!i.condition || holds(s, *i.condition)) next = static_cast<int>(i.target);
        break;
      case sim::Op::set:
        if (const int c = cell(i.a); c >= 0) s.cells[static_cast<std::size_t>(c)] = value(s, i.b);
        break;
      case sim::Op::mul:
        if (const int c = cell(i.a); c >= 0) s.cells[static_cast<std::size_t>(c)] *= value(s, i.b);
        break;
      case sim::Op::output:
        if (i.value == 1) s.gripped.emplace_back(s.cells[kD12], s.cells[kP21]);
        break;
      case sim::Op::end:
        next = -1;
        break;
      default:
        break;
    }
    s.line = next;
  }

  const std::vector<sim::Instruction>& lines_;
  Without without_;
};

}  // namespace hand_over_model
}  // namespace pickcell::robot
