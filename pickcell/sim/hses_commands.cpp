#include "pickcell/sim/hses_commands.hpp"

#include <algorithm>
#include <array>
#include <cstdio>
#include <optional>
#include <utility>
#include <variant>
#include <vector>

#include "pickcell/core/date.hpp"
#include "pickcell/sim/controller_commands.hpp"
#include "pickcell/sim/hses_element_commands.hpp"
#include "pickcell/sim/hses_elements.hpp"
#include "pickcell/sim/position_solver.hpp"

namespace pickcell::sim {

namespace {

using hses_elements::Refused;
using robot::HsesAnswer;
using robot::HsesBytes;
using robot::HsesReader;
using robot::HsesRequest;
using robot::HsesService;
using robot::HsesWriter;

constexpr std::uint8_t kStatusRefused = 0x1F;
constexpr Refused kBadGroup = 0xB008, kBadSpeed = 0xB009;
constexpr int kMostAlarms = 4, kMostHistory = 100, kTasks = 16;

/// 2010 becomes 0x2010.
Refused in_hex(Refusal refusal) {
  int decimal = static_cast<int>(refusal);
  int value = 0;
  for (int shift = 0; decimal > 0; shift += 4, decimal /= 10) value |= decimal % 10 << shift;
  return static_cast<Refused>(value);
}

HsesAnswer settle(const HsesRequest& r, Refusal refusal) { return sim::settle(r, in_hex(refusal)); }

/// Attribute 0: all fields in a row; n: the nth.
HsesAnswer fields(const HsesRequest& r, const std::vector<HsesBytes>& parts) {
  if (!reads(r) || r.attribute > parts.size()) return hses_refusal(r, hses_elements::kBadAttribute);
  if (r.attribute > 0) return hses_done(r, parts[r.attribute - 1u]);
  HsesBytes all;
  for (const HsesBytes& part : parts) all.insert(all.end(), part.begin(), part.end());
  return hses_done(r, std::move(all));
}

HsesBytes word(std::uint32_t v) { return HsesWriter().u32(v).take(); }
HsesBytes text(std::string_view t, std::size_t size) { return HsesWriter().text(t, size).take(); }

// --- reading -------------------------------------------------------------------------------------------------------

HsesAnswer alarm_fields(const HsesRequest& r, const AlarmEntry* a) {
  const AlarmEntry none;
  const AlarmEntry& entry = a ? *a : none;
  return fields(
      r, {word(static_cast<std::uint32_t>(entry.code)), word(static_cast<std::uint32_t>(entry.data)), word(a ? 1 : 0),
          text(a ? core::utc(entry.unix_us, "%Y/%m/%d %H:%M") : "", 16), text(entry.text, 32)});
}

HsesAnswer alarm(ControllerState& s, const HsesRequest& r) {
  if (r.instance < 1 || r.instance > kMostAlarms) return hses_refusal(r, hses_elements::kBadInstance);
  const auto i = r.instance - 1u;
  return alarm_fields(r, i < s.alarms.size() ? &s.alarms[i] : nullptr);
}

/// Majors stand under 1-100, what RESET clears under 1001-1100; user and off-line alarms do not happen here.
HsesAnswer alarm_history(ControllerState& s, const HsesRequest& r) {
  const int kind = r.instance / 1000, n = r.instance % 1000;
  if (kind > 4 || n < 1 || n > kMostHistory) return hses_refusal(r, hses_elements::kBadInstance);
  std::vector<const AlarmEntry*> found;
  for (const AlarmEntry& a : s.alarm_history)
    if (kind <= 1 && (a.code >= kFirstMinorAlarm) == (kind == 1)) found.push_back(&a);
  return alarm_fields(r,
                      static_cast<std::size_t>(n) <= found.size() ? found[static_cast<std::size_t>(n) - 1] : nullptr);
}

HsesAnswer status(ControllerState& s, const HsesRequest& r) {
  if (r.instance != 1) return hses_refusal(r, hses_elements::kBadInstance);
  const auto bits = s.status_bits();
  return fields(r, {word(static_cast<std::uint32_t>(bits[0])), word(static_cast<std::uint32_t>(bits[1]))});
}

HsesAnswer running_job(ControllerState& s, const HsesRequest& r) {
  if (r.instance < 1 || r.instance > kTasks) return hses_refusal(r, hses_elements::kBadInstance);
  const bool master = r.instance == 1 && s.task.at.job;  // sub tasks do not run here
  constexpr std::uint32_t kFullSpeed = 10000;            // 0.01 %
  return fields(r, {text(master ? s.task.at.job->name : "", robot::kHsesJobNameBytes),
                    word(master ? static_cast<std::uint32_t>(s.task.at.line) : 0),
                    word(master ? static_cast<std::uint32_t>(s.task.step) : 0), word(master ? kFullSpeed : 0)});
}

bool pulses(const HsesRequest& r) { return r.instance == robot::kHsesRobotPulse; }
bool cartesian(const HsesRequest& r) { return r.instance == robot::kHsesRobotCartesian; }

HsesAnswer axis_names(ControllerState&, const HsesRequest& r) {
  static constexpr std::array<std::array<std::string_view, 8>, 2> kNames{
      {{"S", "L", "U", "R", "B", "T", "", ""}, {"X", "Y", "Z", "Rx", "Ry", "Rz", "", ""}}};
  if (!pulses(r) && !cartesian(r)) return hses_refusal(r, hses_elements::kBadInstance);
  std::vector<HsesBytes> parts;
  for (const std::string_view name : kNames[cartesian(r) ? 1 : 0]) parts.push_back(text(name, 4));
  return fields(r, parts);
}

HsesAnswer position(ControllerState& s, const HsesRequest& r) {
  if (!pulses(r) && !cartesian(r)) return hses_refusal(r, hses_elements::kBadInstance);
  Position p = present_position(s, 0);
  if (pulses(r)) {
    p = {};
    p.pulse = true;
    p.axis = pulses_from_joints(*s.arm, s.q);
    p.tool = s.tool;
  }
  const robot::HsesPosition w = hses_elements::position_words(p);
  std::vector<HsesBytes> parts{word(w.type), word(w.form), word(w.tool), word(w.user), word(w.extended_form)};
  for (const std::int32_t axis : w.axes) parts.push_back(word(static_cast<std::uint32_t>(axis)));
  return fields(r, parts);
}

/// The simulated servo follows without error and its unit of torque is not known: eight zeros.
HsesAnswer eight_zeros(ControllerState&, const HsesRequest& r) {
  if (!pulses(r)) return hses_refusal(r, hses_elements::kBadInstance);
  return fields(r, std::vector<HsesBytes>(8, word(0)));
}

HsesAnswer management_time(ControllerState& s, const HsesRequest& r) {
  static constexpr std::array<int, 7> kItems{1, 10, 11, 110, 111, 210, 211};
  if (std::find(kItems.begin(), kItems.end(), r.instance) == kItems.end())
    return hses_refusal(r, hses_elements::kBadInstance);
  const auto seconds = (s.unix_us - s.switched_on_unix_us) / 1'000'000 * (r.instance == 1 ? 1 : 0);
  std::array<char, 32> elapsed{};
  (void)std::snprintf(elapsed.data(), elapsed.size(), "%06lld:%02lld'%02lld", static_cast<long long>(seconds / 3600),
                      static_cast<long long>(seconds / 60 % 60), static_cast<long long>(seconds % 60));
  return fields(r, {text(core::utc(s.switched_on_unix_us, "%Y/%m/%d %H:%M"), 16), text(elapsed.data(), 12)});
}

HsesAnswer system_info(ControllerState& s, const HsesRequest& r) {
  const bool robot = r.instance == 11, application = r.instance == 101;
  if (!robot && !application) return hses_refusal(r, hses_elements::kBadInstance);
  const std::string model = robot ? "SIM-" + std::string(name(s.arm->model)) : "GENERAL";
  return fields(r, {text("PICKCELL-SIM 1.00", 24), text(model, 16), text("1.00", 8)});
}

// --- control -------------------------------------------------------------------------------------------------------

/// The number a control command carries, 1..most.
std::optional<std::uint32_t> choice(const HsesRequest& r, std::uint32_t most) {
  if (r.payload.size() != 4) return std::nullopt;
  const std::uint32_t v = HsesReader(r.payload).u32();
  return v >= 1 && v <= most ? std::optional(v) : std::nullopt;
}

/// What is wrong with a control command before it is looked at: 0, or the refusal.
Refused malformed(const HsesRequest& r, std::uint32_t most_instance, std::uint32_t most_value) {
  if (r.instance < 1 || r.instance > most_instance) return hses_elements::kBadInstance;
  if (!writes(r) || r.attribute > 1) return hses_elements::kBadAttribute;
  if (r.payload.size() != 4) return hses_elements::kBadLength;
  return choice(r, most_value) ? Refused{0} : hses_elements::kBadValue;
}

HsesAnswer reset(ControllerState& s, const HsesRequest& r) {
  if (const Refused bad = malformed(r, 2, 1); bad != 0) return hses_refusal(r, bad);
  return settle(r, r.instance == robot::kHsesResetAlarm ? reset_alarms(s) : cancel_error(s));
}

HsesAnswer power(ControllerState& s, const HsesRequest& r) {
  if (const Refused bad = malformed(r, 3, 2); bad != 0) return hses_refusal(r, bad);
  const bool on = choice(r, 2) == 1u;
  if (r.instance == robot::kHsesHold) return settle(r, set_hold(s, on));
  return settle(r, r.instance == robot::kHsesServo ? set_servo(s, on) : set_pendant_lock(s, on));
}

HsesAnswer cycle(ControllerState& s, const HsesRequest& r) {
  if (r.instance != 2) return hses_refusal(r, hses_elements::kBadInstance);
  if (const Refused bad = malformed(r, 2, 3); bad != 0) return hses_refusal(r, bad);
  return settle(r, set_cycle(s, static_cast<CycleMode>(*choice(r, 3))));
}

HsesAnswer message(ControllerState& s, const HsesRequest& r) {
  if (r.instance != 1) return hses_refusal(r, hses_elements::kBadInstance);
  if (!writes(r) || r.attribute > 1) return hses_refusal(r, hses_elements::kBadAttribute);
  HsesReader in(r.payload);
  return settle(r, show_message(s, in.text(r.payload.size())));  // clients fill up with NULs
}

HsesAnswer start_job(ControllerState& s, const HsesRequest& r) {
  if (const Refused bad = malformed(r, 1, 1); bad != 0) return hses_refusal(r, bad);
  return settle(r, start(s, {}));
}

HsesAnswer select(ControllerState& s, const HsesRequest& r) {
  const bool master = r.instance >= 10 && r.instance <= 15;
  if (r.instance != 1 && !master) return hses_refusal(r, hses_elements::kBadInstance);
  // With "set all" there are hosts that name the name (1) or the line (2) and send both.
  constexpr std::uint8_t kLine = 2;
  if (!writes(r) || r.attribute > (r.service == HsesService::set_all ? kLine : 0))
    return hses_refusal(r, hses_elements::kBadAttribute);
  if (r.payload.size() != robot::kHsesJobNameBytes + 4) return hses_refusal(r, hses_elements::kBadLength);
  HsesReader in(r.payload);
  const std::string job = in.text(robot::kHsesJobNameBytes);
  const std::uint32_t line = in.u32();
  if (line > 9999) return hses_refusal(r, hses_elements::kBadValue);
  if (master) return settle(r, set_master_job(s, job));
  return settle(r, select_job(s, job, static_cast<int>(line)));
}

// --- motion --------------------------------------------------------------------------------------------------------

struct Speed {
  std::optional<double> fraction;  ///< of the joints'
  LineSpeed line;
};

std::optional<Speed> speed_of(const robot::HsesSpeed& s, bool joint) {
  const auto value = static_cast<double>(s.value);
  if (joint && s.kind == 0 && s.value >= 1 && s.value <= 10000) return Speed{value / 10000, {}};
  if (!joint && s.kind == 1 && s.value >= 1 && s.value <= 15000) return Speed{{}, {false, value / 10}};
  if (!joint && s.kind == 2 && s.value >= 1 && s.value <= 1800) return Speed{{}, {true, value / 10}};
  return std::nullopt;
}

HsesAnswer go(ControllerState& s, const HsesRequest& r, const Position& target, const Speed& speed) {
  if (speed.fraction) return settle(r, move_joint(s, target, *speed.fraction));
  return settle(r, move_line(s, target, speed.line));
}

HsesAnswer move(ControllerState& s, const HsesRequest& r) {
  if (r.instance < 1 || r.instance > 3) return hses_refusal(r, hses_elements::kBadInstance);
  if (!writes(r) || r.attribute > 1) return hses_refusal(r, hses_elements::kBadAttribute);
  const auto data = robot::parse_hses_move(r.payload);
  if (!data) return hses_refusal(r, hses_elements::kBadLength);
  if (data->robot != 1 || data->station != 0) return hses_refusal(r, kBadGroup);
  const auto kind = static_cast<robot::HsesMoveKind>(r.instance);
  const auto speed = speed_of(data->speed, kind == robot::HsesMoveKind::joint);
  if (!speed) return hses_refusal(r, kBadSpeed);
  const auto parsed = hses_elements::position_from(s, data->target);
  if (const auto* refused = std::get_if<Refused>(&parsed)) return hses_refusal(r, *refused);
  const Position& target = std::get<Position>(parsed);
  if (target.pulse) return hses_refusal(r, hses_elements::kBadType);
  if (const auto in_base = from_tool_frame(s, target)) return go(s, r, *in_base, *speed);
  if (kind == robot::HsesMoveKind::line_by)
    return settle(r, move_by(s, target.frame, target.axis, target.tool, speed->line));
  return go(s, r, target, *speed);
}

HsesAnswer move_pulses(ControllerState& s, const HsesRequest& r) {
  if (r.instance < 1 || r.instance > 2) return hses_refusal(r, hses_elements::kBadInstance);
  if (!writes(r) || r.attribute > 1) return hses_refusal(r, hses_elements::kBadAttribute);
  const auto data = robot::parse_hses_pulse_move(r.payload);
  if (!data) return hses_refusal(r, hses_elements::kBadLength);
  if (data->robot != 1 || data->station != 0) return hses_refusal(r, kBadGroup);
  const auto speed = speed_of(data->speed, r.instance == 1);
  if (!speed) return hses_refusal(r, kBadSpeed);
  if (data->tool > 63) return hses_refusal(r, hses_elements::kBadTool);
  Position target;
  target.pulse = true;
  target.tool = static_cast<int>(data->tool);
  std::copy_n(data->pulses.begin(), target.axis.size(), target.axis.begin());  // the rest are axes this arm has not
  return go(s, r, target, *speed);
}

struct Command {
  std::uint16_t number;
  std::string_view name;  ///< of the command of TCP port 80 that does the same
  HsesAnswer (*run)(ControllerState&, const HsesRequest&);
};

constexpr std::array kCommands = {
    Command{robot::kHsesAlarm, "RALARM", alarm},
    Command{robot::kHsesAlarmHistory, "", alarm_history},
    Command{robot::kHsesStatus, "RSTATS", status},
    Command{robot::kHsesJob, "RJSEQ", running_job},
    Command{robot::kHsesAxisNames, "", axis_names},
    Command{robot::kHsesPosition, "RPOSC", position},
    Command{robot::kHsesPositionError, "", eight_zeros},
    Command{robot::kHsesTorque, "", eight_zeros},
    Command{robot::kHsesReset, "RESET", reset},
    Command{robot::kHsesPower, "HOLD", power},
    Command{robot::kHsesCycle, "CYCLE", cycle},
    Command{robot::kHsesMessage, "MDSP", message},
    Command{robot::kHsesStart, "START", start_job},
    Command{robot::kHsesSelect, "JSEQ", select},
    Command{robot::kHsesTime, "", management_time},
    Command{robot::kHsesSystem, "", system_info},
    Command{robot::kHsesMove, "MOVJ", move},
    Command{robot::kHsesMovePulse, "PMOVJ", move_pulses},
};

const Command* command(std::uint16_t number) {
  const auto* found =
      std::find_if(kCommands.begin(), kCommands.end(), [&](const Command& c) { return c.number == number; });
  return found == kCommands.end() ? nullptr : found;
}

std::string_view element_name(const HsesRequest& r) {
  const std::uint16_t plural_of = hses_elements::element_of(r.command);
  const std::uint16_t one = plural_of != 0 ? plural_of : r.command;
  const bool writing = writes(r) || r.service == HsesService::write_plural;
  if (one == robot::kHsesIo) return writing ? "IOWRITE" : "IOREAD";
  return writing ? "LOADV" : "SAVEV";
}

}  // namespace

HsesAnswer hses_done(const HsesRequest& request, HsesBytes payload) {
  HsesAnswer a;
  a.division = request.division;
  a.id = request.id;
  a.service = request.service;
  a.payload = std::move(payload);
  return a;
}

HsesAnswer hses_refusal(const HsesRequest& request, std::uint16_t added_status) {
  HsesAnswer a = hses_done(request);
  a.status = kStatusRefused;
  a.added_status = added_status;
  return a;
}

HsesAnswer execute_hses(ControllerState& state, const HsesRequest& request) {
  if (const Command* known = command(request.command)) return known->run(state, request);
  if (hses_elements::is_element(request.command)) return hses_element_command(state, request);
  return hses_plural_command(state, request);
}

std::string hses_command_name(const HsesRequest& request) {
  const Command* known = command(request.command);
  std::string_view name = known ? known->name : "";
  if (hses_elements::is_element(request.command) || hses_elements::element_of(request.command) != 0)
    name = element_name(request);
  if (request.command == robot::kHsesReset && request.instance == robot::kHsesCancelError) name = "CANCEL";
  if (request.command == robot::kHsesPower && request.instance == robot::kHsesServo) name = "SVON";
  if (request.command == robot::kHsesPower && request.instance == robot::kHsesLock) name = "HLOCK";
  if (request.command == robot::kHsesPosition && request.instance == robot::kHsesRobotPulse) name = "RPOSJ";
  if (request.command == robot::kHsesMove && request.instance == 2) name = "MOVL";
  if (request.command == robot::kHsesMove && request.instance == 3) name = "IMOV";
  if (!name.empty()) return std::string(name);
  std::array<char, 16> number{};
  (void)std::snprintf(number.data(), number.size(), "0x%02X", unsigned{request.command});
  return number.data();
}

}  // namespace pickcell::sim
