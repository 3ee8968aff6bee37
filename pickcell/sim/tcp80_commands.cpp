#include "pickcell/sim/tcp80_commands.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "pickcell/sim/controller_commands.hpp"
#include "pickcell/sim/position_solver.hpp"
#include "pickcell/sim/tcp80_fields.hpp"
#include "pickcell/sim/tcp80_variables.hpp"

namespace pickcell::sim {

namespace {

using namespace tcp80;
using tcp80_fields::number;
using tcp80_fields::split;
using tcp80_fields::trimmed;
using tcp80_fields::whole;

// --- reading
// -----------------------------------------------------------------------------------------------------------

Outcome ralarm(ControllerState& s, const Fields&) {
  std::string out = s.error ? "1,0" : "0,0";
  for (std::size_t i = 0; i < 4; ++i)
    out += i < s.alarms.size() ? format(",%d,%d", s.alarms[i].code, s.alarms[i].data) : ",0,0";
  return out;
}

Outcome rstats(ControllerState& s, const Fields&) {
  const auto bits = s.status_bits();
  return format("%d,%d", bits[0], bits[1]);
}

Outcome rposj(ControllerState& s, const Fields&) {
  std::string out;
  for (const std::int32_t pulse : pulses_from_joints(*s.arm, s.q)) out += std::to_string(pulse) + ",";
  return out + "0,0,0,0,0,0";
}

Outcome rposc(ControllerState& s, const Fields& f) {
  const auto frame = whole(f[0], 0, s.type.user_frames + 1), external = whole(f[1], 0, 1);
  if (!frame || !external) return Refusal::operand_range;
  if (!s.frame(*frame)) return Refusal::frame_not_taught;
  const Position p = present_position(s, *frame);
  return cartesian_text(p.axis, s.type.angle_decimals) + format(",%d,%d", p.form, p.tool) +
         (*external == 1 ? ",0,0,0,0,0,0" : "");
}

Outcome rjseq(ControllerState& s, const Fields&) {
  if (!s.task.at.job) return Refusal::no_job_set;
  return s.task.at.job->name + format(",%zu,%d", s.task.at.line, s.task.step);
}

Outcome rjdir(ControllerState& s, const Fields& f) {
  std::vector<std::string> names;
  for (const auto& [name, job] : s.jobs)
    if (f[0] == "*" || f[0] == name) names.push_back(name);
  if (names.empty()) return Refusal::no_such_job;
  return joined(names);
}

// --- control
// -----------------------------------------------------------------------------------------------------------

template <Refusal (*Set)(ControllerState&, bool)>
Outcome on_off(ControllerState& s, const Fields& f) {
  const auto on = whole(f[0], 0, 1);
  return on ? Set(s, *on == 1) : Refusal::operand_range;
}

template <Refusal (*Do)(ControllerState&)>
Outcome plain(ControllerState& s, const Fields&) {
  return Do(s);
}

template <Refusal (*Do)(ControllerState&, std::string_view)>
Outcome named(ControllerState& s, const Fields& f) {
  return Do(s, f[0]);
}

Outcome mode(ControllerState& s, const Fields& f) {
  const auto m = whole(f[0], 1, 2);
  return m ? set_mode(s, *m == 2) : Refusal::operand_range;
}

Outcome cycle(ControllerState& s, const Fields& f) {
  const auto c = whole(f[0], 1, 3);
  return c ? set_cycle(s, static_cast<CycleMode>(*c)) : Refusal::operand_range;
}

Outcome start_job(ControllerState& s, const Fields& f) { return start(s, f.empty() ? std::string_view{} : f[0]); }

Outcome jseq(ControllerState& s, const Fields& f) {
  const auto line = whole(f[1], 0, 9999);
  return line ? select_job(s, f[0], *line) : Refusal::operand_range;
}

// --- motion
// ------------------------------------------------------------------------------------------------------------

std::optional<LineSpeed> line_speed(const Fields& f) {
  const auto kind = whole(f[0], 0, 1);
  const auto speed = number(f[1]);
  if (!kind || !speed || *speed < 0.1 || *speed > (*kind == 0 ? 1500 : 180)) return std::nullopt;
  return LineSpeed{*kind == 1, *speed};
}

std::optional<double> joint_speed(std::string_view text) {
  const auto percent = number(text);
  if (!percent || *percent < 0.01 || *percent > 100) return std::nullopt;
  return *percent / 100;
}

/// frame, X..Rz, type, tool, six external axes (numbers, not used: there are none).
std::optional<Position> target(const ControllerState& s, const Fields& f, std::size_t from) {
  Position p;
  const auto frame = whole(f[from], 0, s.type.user_frames + 1);
  const auto axis = cartesian(f, from + 1);
  const auto form = whole(f[from + 7], 0, kFormBits), tool = whole(f[from + 8], 0, kTools);
  const bool external = std::all_of(f.begin() + static_cast<std::ptrdiff_t>(from) + 9, f.end(),
                                    [](std::string_view v) { return number(v).has_value(); });
  if (!frame || !axis || !form || !tool || !external) return std::nullopt;
  p.frame = *frame;
  p.axis = *axis;
  p.form = *form;
  p.tool = *tool;
  return p;
}

Outcome movj(ControllerState& s, const Fields& f) {
  const auto speed = joint_speed(f[0]);
  const auto to = target(s, f, 1);
  return speed && to ? move_joint(s, *to, *speed) : Refusal::operand_range;
}

Outcome movl(ControllerState& s, const Fields& f) {
  const auto speed = line_speed(f);
  const auto to = target(s, f, 2);
  return speed && to ? move_line(s, *to, *speed) : Refusal::operand_range;
}

Outcome imov(ControllerState& s, const Fields& f) {
  const auto speed = line_speed(f);
  const auto by = target(s, f, 2);
  return speed && by ? move_by(s, by->frame, by->axis, by->tool, *speed) : Refusal::operand_range;
}

Outcome pmovj(ControllerState& s, const Fields& f) {
  const auto speed = joint_speed(f[0]);
  const auto tool = whole(f[13], 0, kTools);
  Position p;
  p.pulse = true;
  for (std::size_t i = 0; i < 12; ++i) {
    const auto pulse = whole(f[1 + i], -kAnyPulse, kAnyPulse);
    if (!pulse) return Refusal::operand_range;
    if (i < 6) p.axis[i] = *pulse;
  }
  if (!speed || !tool) return Refusal::operand_range;
  p.tool = *tool;
  return move_joint(s, p, *speed);
}

struct Command {
  std::string_view name;
  std::size_t least, most;  ///< operands
  Outcome (*run)(ControllerState&, const Fields&);
};

constexpr std::array kCommands = {
    Command{"RALARM", 0, 0, ralarm},
    Command{"RSTATS", 0, 0, rstats},
    Command{"RPOSJ", 0, 0, rposj},
    Command{"RPOSC", 2, 2, rposc},
    Command{"RJSEQ", 0, 0, rjseq},
    Command{"RJDIR", 1, 1, rjdir},
    Command{"SAVEV", 2, 2, savev},
    Command{"LOADV", 3, 12, loadv},
    Command{"IOREAD", 2, 2, ioread},
    Command{"IOWRITE", 3, 258, iowrite},
    Command{"HOLD", 1, 1, on_off<set_hold>},
    Command{"RESET", 0, 0, plain<reset_alarms>},
    Command{"CANCEL", 0, 0, plain<cancel_error>},
    Command{"SVON", 1, 1, on_off<set_servo>},
    Command{"MODE", 1, 1, mode},
    Command{"CYCLE", 1, 1, cycle},
    Command{"HLOCK", 1, 1, on_off<set_pendant_lock>},
    Command{"START", 0, 1, start_job},
    Command{"JSEQ", 2, 2, jseq},
    Command{"SETMJ", 1, 1, named<set_master_job>},
    Command{"DELETE", 1, 1, named<delete_job>},
    Command{"MOVJ", 16, 16, movj},
    Command{"MOVL", 17, 17, movl},
    Command{"IMOV", 17, 17, imov},
    Command{"PMOVJ", 14, 14, pmovj},
};

Outcome run(ControllerState& state, std::string_view command, std::string_view operands) {
  if (command == "MDSP") return show_message(state, trimmed(operands));  // a text: commas and all
  const Fields fields = split(operands);
  for (const Command& known : kCommands) {
    if (known.name != command) continue;
    if (fields.size() < known.least || fields.size() > known.most) return Refusal::operand_count;
    return known.run(state, fields);
  }
  return Refusal::unknown_command;
}

}  // namespace

bool is_tcp80_command(std::string_view name) {
  return name == "MDSP" ||
         std::any_of(kCommands.begin(), kCommands.end(), [&](const Command& c) { return c.name == name; });
}

std::string Tcp80Answer::bytes() const { return text + (kind == Kind::data ? "\r" : "\r\n"); }

Tcp80Answer execute_tcp80(ControllerState& state, std::string_view command, std::string_view operands) {
  Outcome outcome = run(state, command, operands);
  if (outcome.data) return {Tcp80Answer::Kind::data, std::move(*outcome.data)};
  if (outcome.refusal == Refusal::none) return {Tcp80Answer::Kind::accepted, "0000"};
  return {Tcp80Answer::Kind::error, "ERROR: " + std::string(command) + " is not successful(" +
                                        format("%04d", static_cast<int>(outcome.refusal)) + ")."};
}

}  // namespace pickcell::sim
