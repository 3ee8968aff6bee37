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
#include "pickcell/sim/controller_contacts.hpp"
#include "pickcell/sim/position_solver.hpp"
#include "pickcell/sim/tcp80_fields.hpp"

namespace pickcell::sim {

namespace {

using Fields = std::vector<std::string_view>;
using tcp80_fields::number;
using tcp80_fields::split;
using tcp80_fields::trimmed;
using tcp80_fields::whole;

/// Data of a reading command, or the refusal.
struct Outcome {
  Refusal refusal = Refusal::none;
  std::optional<std::string> data;
  Outcome(Refusal r) : refusal(r) {}                    // NOLINT: every command returns one or the other
  Outcome(std::string text) : data(std::move(text)) {}  // NOLINT
};

template <class... Args>
std::string format(const char* pattern, Args... args) {
  std::array<char, 256> text{};
  const int n = std::snprintf(text.data(), text.size(), pattern, args...);
  return {text.data(), static_cast<std::size_t>(std::clamp(n, 0, 255))};
}

std::string joined(const std::vector<std::string>& parts) {
  std::string out;
  for (const std::string& part : parts) out += (out.empty() ? "" : ",") + part;
  return out;
}

constexpr double kAnyPulse = 2147483647;
constexpr double kFarthest_mm = 999999.999, kWidest_deg = 360;
constexpr int kFormBits = 63, kTools = 63;
constexpr std::size_t kTextBytes = 16;

/// X,Y,Z,Rx,Ry,Rz in mm and degrees.
std::optional<Cartesian> cartesian(const Fields& f, std::size_t from) {
  Cartesian axis{};
  for (std::size_t i = 0; i < 6; ++i) {
    const auto v = number(f[from + i]);
    if (!v || std::abs(*v) > (i < 3 ? kFarthest_mm : kWidest_deg)) return std::nullopt;
    axis[i] = static_cast<std::int32_t>(std::lround(*v * (i < 3 ? 1e3 : 1e4)));
  }
  return axis;
}

std::string cartesian_text(const Cartesian& axis, int angle_decimals) {
  std::string out;
  for (std::size_t i = 0; i < 6; ++i)
    out += format("%s%.*f", i == 0 ? "" : ",", i < 3 ? 3 : angle_decimals, axis[i] / (i < 3 ? 1e3 : 1e4));
  return out;
}

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

Outcome ioread(ControllerState& s, const Fields& f) {
  const auto first = whole(f[0], 10, 99999), count = whole(f[1], 8, 2048);
  if (!first || !count || *first % 10 != 0 || *count % 8 != 0) return Refusal::operand_range;
  std::vector<std::string> bytes;
  for (int group = 0; group < *count / 8; ++group) {
    const auto value = read_group(s, *first / 10 + group);
    if (!value) return Refusal::operand_range;
    bytes.push_back(std::to_string(*value));
  }
  return joined(bytes);
}

// --- variables
// ---------------------------------------------------------------------------------------------------------

enum VariableType { kB = 0, kI = 1, kD = 2, kR = 3, kP = 4, kS = 7 };

Outcome savev(ControllerState& s, const Fields& f) {
  const auto type = whole(f[0], 0, 7);
  const auto n = whole(f[1], 0, type == kP ? 127 : 99);
  if (!type || !n) return Refusal::operand_range;
  const auto i = static_cast<std::size_t>(*n);
  switch (*type) {
    case kB:
      return std::to_string(s.B[i]);
    case kI:
      return std::to_string(s.I[i]);
    case kD:
      return std::to_string(s.D[i]);
    case kR:
      return format("%.6f", static_cast<double>(s.R[i]));
    case kS:
      return s.S[i].substr(0, kTextBytes);
    case kP:
      break;
    default:
      return Refusal::operand_range;  // BP and EX: no base axis, no station
  }
  if (!s.P[i]) return Refusal::position_missing;
  const Position& p = *s.P[i];
  if (!p.pulse)
    return format("1,%d,", p.frame == kToolFrame ? s.type.user_frames + 2 : p.frame) +
           cartesian_text(p.axis, s.type.angle_decimals) + format(",%d,%d", p.form, p.tool);
  std::string out = "0";
  for (const std::int32_t pulse : p.axis) out += "," + std::to_string(pulse);
  return out + "," + std::to_string(p.tool);
}

template <class Array>
Outcome store_whole(ControllerState& s, Array& values, std::size_t i, std::string_view text) {
  using Number = typename Array::value_type;
  const auto v = whole(text, std::numeric_limits<Number>::lowest(), std::numeric_limits<Number>::max());
  if (!v) return Refusal::operand_range;
  if (const Refusal refusal = may_write(s); refusal != Refusal::none) return refusal;
  values[i] = static_cast<Number>(*v);
  return Refusal::none;
}

std::optional<Position> position_operand(const ControllerState& s, const Fields& f) {
  Position p;
  p.pulse = f[2] == "0";
  if (p.pulse) {
    for (std::size_t i = 0; i < 6; ++i) {
      const auto v = whole(f[3 + i], -kAnyPulse, kAnyPulse);
      if (!v) return std::nullopt;
      p.axis[i] = *v;
    }
  } else {
    const auto frame = whole(f[3], 0, s.type.user_frames + 1), form = whole(f[10], 0, kFormBits);
    const auto axis = cartesian(f, 4);
    if (!frame || !axis || !form) return std::nullopt;
    p.frame = *frame;
    p.axis = *axis;
    p.form = *form;
  }
  const auto tool = whole(f.back(), 0, kTools);
  if (!tool) return std::nullopt;
  p.tool = *tool;
  return p;
}

Outcome load_position(ControllerState& s, const Fields& f) {
  if (f[2] != "0" && f[2] != "1") return Refusal::operand_range;
  if (f.size() != (f[2] == "0" ? 10u : 12u)) return Refusal::operand_count;
  const auto n = whole(f[1], 0, 127);
  const auto p = position_operand(s, f);
  if (!n || !p) return Refusal::operand_range;
  if (const Refusal refusal = may_write(s); refusal != Refusal::none) return refusal;
  s.P[static_cast<std::size_t>(*n)] = *p;
  return Refusal::none;
}

Outcome load_real(ControllerState& s, std::size_t i, std::string_view text) {
  const auto v = number(text);
  if (!v || std::abs(*v) > std::numeric_limits<float>::max()) return Refusal::operand_range;
  if (const Refusal refusal = may_write(s); refusal != Refusal::none) return refusal;
  s.R[i] = static_cast<float>(*v);
  return Refusal::none;
}

Outcome load_text(ControllerState& s, std::size_t i, std::string_view text) {
  if (text.size() > kTextBytes) return Refusal::operand_length;
  if (const Refusal refusal = may_write(s); refusal != Refusal::none) return refusal;
  s.S[i] = std::string(text);
  return Refusal::none;
}

Outcome loadv(ControllerState& s, const Fields& f) {
  const auto type = whole(f[0], 0, 7);
  if (!type) return Refusal::operand_range;
  if (*type == kP) return load_position(s, f);
  if (f.size() != 3) return Refusal::operand_count;
  const auto n = whole(f[1], 0, 99);
  if (!n) return Refusal::operand_range;
  const auto i = static_cast<std::size_t>(*n);
  switch (*type) {
    case kB:
      return store_whole(s, s.B, i, f[2]);
    case kI:
      return store_whole(s, s.I, i, f[2]);
    case kD:
      return store_whole(s, s.D, i, f[2]);
    case kR:
      return load_real(s, i, f[2]);
    case kS:
      return load_text(s, i, f[2]);
    default:
      return Refusal::operand_range;
  }
}

Outcome iowrite(ControllerState& s, const Fields& f) {
  const auto first = whole(f[0], 10, 99999), count = whole(f[1], 8, 2048);
  if (!first || !count || *first % 10 != 0 || *count % 8 != 0) return Refusal::operand_range;
  const auto groups = static_cast<std::size_t>(*count / 8);
  if (f.size() != 2 + groups) return Refusal::operand_count;
  std::vector<std::uint8_t> values;
  for (std::size_t i = 0; i < groups; ++i) {
    const auto v = whole(f[2 + i], 0, 255);
    if (!v) return Refusal::operand_range;
    values.push_back(static_cast<std::uint8_t>(*v));
  }
  if (*first < s.type.network_input_first || *first + *count / 8 * 10 - 3 > s.type.network_input_last)
    return Refusal::not_loadable;
  if (const Refusal refusal = may_write(s); refusal != Refusal::none) return refusal;
  for (std::size_t i = 0; i < groups; ++i) (void)write_group(s, *first / 10 + static_cast<int>(i), values[i]);
  return Refusal::none;
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

std::string Tcp80Answer::bytes() const { return text + (kind == Kind::data ? "\r" : "\r\n"); }

Tcp80Answer execute_tcp80(ControllerState& state, std::string_view command, std::string_view operands) {
  Outcome outcome = run(state, command, operands);
  if (outcome.data) return {Tcp80Answer::Kind::data, std::move(*outcome.data)};
  if (outcome.refusal == Refusal::none) return {Tcp80Answer::Kind::accepted, "0000"};
  return {Tcp80Answer::Kind::error, "ERROR: " + std::string(command) + " is not successful(" +
                                        format("%04d", static_cast<int>(outcome.refusal)) + ")."};
}

}  // namespace pickcell::sim
