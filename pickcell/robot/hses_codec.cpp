#include "pickcell/robot/hses_codec.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <utility>
#include <variant>

namespace pickcell::robot {

using core::ErrorCode;

namespace {

constexpr std::uint32_t kPulse = 0, kBase = 16, kRobot = 17, kUser = 18;
constexpr std::size_t kStatusBytes = 8, kJobBytes = 44, kShortestPosition = 44, kMoveBytes = 104, kPulseMoveBytes = 88;
constexpr std::size_t kSubCodeInfo = 16, kSubCodeText = 96;
constexpr int kBaseAxes = 3, kStationAxes = 6;

auto malformed(const std::string& what, HsesView payload) {
  return core::failure(ErrorCode::link, "answer to " + what,
                       "not understood: " + std::to_string(payload.size()) + " bytes",
                       "check that the address is a controller's High Speed Ethernet Server");
}

HsesBytes word(std::uint32_t v) { return HsesWriter().u32(v).take(); }

HsesRequest request(std::uint16_t command, std::uint16_t instance, std::uint8_t attribute, HsesService service,
                    HsesBytes payload = {}) {
  HsesRequest r;
  r.command = command;
  r.instance = instance;
  r.attribute = attribute;
  r.service = service;
  r.payload = std::move(payload);
  return r;
}

std::int32_t scaled(double value, double per_unit) {
  const double v = std::round(value * per_unit);
  if (!std::isfinite(v) || v < std::numeric_limits<std::int32_t>::lowest() ||
      v > std::numeric_limits<std::int32_t>::max())
    throw std::invalid_argument("a position must be finite and within 32 bits");
  return static_cast<std::int32_t>(v);
}

void write_words(HsesWriter& out, const HsesPosition& p) {
  out.u32(p.type).u32(p.form).u32(p.tool).u32(p.user).u32(p.extended_form);
  for (const std::int32_t axis : p.axes) out.i32(axis);
}

void skip(HsesReader& in, int words) {
  for (int i = 0; i < words; ++i) (void)in.u32();
}

}  // namespace

HsesRequest hses_get(std::uint16_t command, std::uint16_t instance, std::uint8_t attribute) {
  return request(command, instance, attribute, attribute == 0 ? HsesService::get_all : HsesService::get_one);
}

HsesRequest hses_set_one(std::uint16_t command, std::uint16_t instance, HsesBytes payload, std::uint8_t attribute) {
  return request(command, instance, attribute, HsesService::set_one, std::move(payload));
}

HsesRequest hses_set_all(std::uint16_t command, std::uint16_t instance, HsesBytes payload) {
  return request(command, instance, 0, HsesService::set_all, std::move(payload));
}

HsesRequest hses_power(std::uint16_t what, bool on) { return hses_set_one(kHsesPower, what, word(on ? 1 : 2)); }

HsesRequest hses_select_job(std::string_view job, std::uint32_t line) {
  if (job.empty() || job.size() > kHsesJobNameBytes) throw std::invalid_argument("job names have 1 to 32 bytes");
  return hses_set_all(kHsesSelect, 1, HsesWriter().text(job, kHsesJobNameBytes).u32(line).take());
}

HsesRequest hses_select_master(std::string_view job, int task) {
  constexpr int kFirst = 10, kTasks = 6;
  if (task < 0 || task >= kTasks) throw std::invalid_argument("tasks are 0 to 5");
  HsesRequest r = hses_select_job(job, 0);
  r.instance = static_cast<std::uint16_t>(kFirst + task);
  return r;
}

HsesRequest hses_start() { return hses_set_one(kHsesStart, 1, word(1)); }

HsesRequest hses_cycle(std::uint32_t mode) { return hses_set_one(kHsesCycle, 2, word(mode)); }

HsesRequest hses_message(std::string_view text) {
  if (text.size() > kHsesMessageBytes) throw std::invalid_argument("a message has at most 30 bytes");
  return hses_set_one(kHsesMessage, 1, HsesWriter().text(text, text.size()).take());
}

HsesRequest hses_file(HsesService service, std::string_view name) {
  HsesRequest r = request(0, 0, 0, service, HsesWriter().text(name, name.size()).take());
  r.division = HsesDivision::file;
  return r;
}

HsesRequest hses_file_block(HsesService service, std::uint32_t block, HsesBytes data) {
  HsesRequest r = request(0, 0, 0, service, std::move(data));
  r.division = HsesDivision::file;
  r.ack = true;
  r.block = block;
  return r;
}

core::Result<RobotState> parse_hses_status(HsesView payload) {
  if (payload.size() != kStatusBytes) return malformed("status (0x72)", payload);
  HsesReader in(payload);
  const std::uint32_t d1 = in.u32(), d2 = in.u32();
  const auto bit = [](std::uint32_t w, int n) { return (w >> n & 1) != 0; };
  RobotState s;
  s.step = bit(d1, 0), s.one_cycle = bit(d1, 1), s.continuous = bit(d1, 2), s.running = bit(d1, 3);
  s.speed_limited = bit(d1, 4), s.teach = bit(d1, 5), s.play = bit(d1, 6), s.remote = bit(d1, 7);
  s.hold_pendant = bit(d2, 1), s.hold_external = bit(d2, 2), s.hold_command = bit(d2, 3);
  s.alarm = bit(d2, 4), s.error = bit(d2, 5), s.servo = bit(d2, 6);
  return s;
}

core::Result<HsesAlarmData> parse_hses_alarm(HsesView payload) {
  const bool sub_codes = payload.size() == kHsesAlarmWithSubCodeBytes;
  if (payload.size() != kHsesAlarmBytes && !sub_codes) return malformed("alarm (0x70)", payload);
  HsesReader in(payload);
  HsesAlarmData a;
  a.code = in.u32(), a.data = in.u32(), a.type = in.u32();
  a.time = in.text(16), a.name = in.text(32);
  if (sub_codes)
    a.sub_code_info = in.text(kSubCodeInfo), a.sub_code_data = in.text(kSubCodeText),
    a.sub_code_reverse = in.text(kSubCodeText);
  return a;
}

HsesBytes hses_payload(const HsesAlarmData& a) {
  HsesWriter out;
  out.u32(a.code).u32(a.data).u32(a.type).text(a.time, 16).text(a.name, 32);
  if (!a.sub_code_info.empty() || !a.sub_code_data.empty() || !a.sub_code_reverse.empty())
    out.text(a.sub_code_info, kSubCodeInfo).text(a.sub_code_data, kSubCodeText).text(a.sub_code_reverse, kSubCodeText);
  return out.take();
}

core::Result<HsesJobInfo> parse_hses_job(HsesView payload) {
  if (payload.size() != kJobBytes) return malformed("running job (0x73)", payload);
  HsesReader in(payload);
  HsesJobInfo j;
  j.name = in.text(kHsesJobNameBytes);
  j.line = in.u32(), j.step = in.u32(), j.speed_override = in.u32();
  return j;
}

HsesBytes hses_payload(const HsesJobInfo& j) {
  return HsesWriter().text(j.name, kHsesJobNameBytes).u32(j.line).u32(j.step).u32(j.speed_override).take();
}

core::Result<HsesPosition> parse_hses_position(HsesView payload) {
  if (payload.size() < kShortestPosition || payload.size() > kHsesPositionBytes || payload.size() % 4 != 0)
    return malformed("position", payload);
  HsesReader in(payload);
  HsesPosition p;
  p.type = in.u32(), p.form = in.u32(), p.tool = in.u32(), p.user = in.u32(), p.extended_form = in.u32();
  for (std::size_t i = 0; i < payload.size() / 4 - 5; ++i) p.axes[i] = in.i32();
  return p;
}

HsesBytes hses_payload(const HsesPosition& p) {
  HsesWriter out;
  write_words(out, p);
  return out.take();
}

core::Result<VariablePosition> variable_position(const HsesPosition& p) {
  const auto beyond = [&](const std::string& what) {
    return core::failure(ErrorCode::refused, "position data", what, "this program has no use for it");
  };
  if (p.tool > static_cast<std::uint32_t>(kMaxTool)) return beyond("tool number " + std::to_string(p.tool));
  if (p.type == kPulse) {
    PulsePosition out;
    std::copy_n(p.axes.begin(), out.pulses.size(), out.pulses.begin());
    out.tool = static_cast<int>(p.tool);
    return out;
  }
  CartesianPosition out;
  if (p.type == kBase)
    out.frame = kBaseFrame;
  else if (p.type == kRobot)
    out.frame = kRobotFrame;
  else if (p.type == kUser && p.user >= 1 && p.user <= 64)
    out.frame = kRobotFrame + static_cast<int>(p.user);
  else
    return beyond("type " + std::to_string(p.type) + ", user frame " + std::to_string(p.user));
  out.x_mm = p.axes[0] / 1e3, out.y_mm = p.axes[1] / 1e3, out.z_mm = p.axes[2] / 1e3;
  out.rx_deg = p.axes[3] / 1e4, out.ry_deg = p.axes[4] / 1e4, out.rz_deg = p.axes[5] / 1e4;
  if (p.axes[6] != 0) out.re_deg = p.axes[6] / 1e4;
  out.form = hses_form(p.form);
  out.tool = static_cast<int>(p.tool);
  return out;
}

HsesPosition hses_position(const VariablePosition& position) {
  HsesPosition p;
  const int tool = std::visit([](const auto& any) { return any.tool; }, position);
  if (tool < 0 || tool > kMaxTool) throw std::invalid_argument("tool number outside 0..63");
  if (const auto* pulse = std::get_if<PulsePosition>(&position)) {
    std::copy(pulse->pulses.begin(), pulse->pulses.end(), p.axes.begin());
    p.tool = static_cast<std::uint32_t>(pulse->tool);
    return p;
  }
  const auto& c = std::get<CartesianPosition>(position);
  if (c.frame < 0 || c.frame > kMaxFrame) throw std::invalid_argument("frame number outside 0..65");
  p.type = c.frame == kBaseFrame ? kBase : c.frame == kRobotFrame ? kRobot : kUser;
  p.user = c.frame > kRobotFrame ? static_cast<std::uint32_t>(c.frame - kRobotFrame) : 0;
  p.form = hses_form(c.form);
  p.tool = static_cast<std::uint32_t>(c.tool);
  p.axes = {scaled(c.x_mm, 1e3),
            scaled(c.y_mm, 1e3),
            scaled(c.z_mm, 1e3),
            scaled(c.rx_deg, 1e4),
            scaled(c.ry_deg, 1e4),
            scaled(c.rz_deg, 1e4),
            scaled(c.re_deg.value_or(0), 1e4),
            0};
  return p;
}

std::uint32_t hses_form(const Form& f) {
  return std::uint32_t{f.back} | std::uint32_t{f.elbow_below} << 1 | std::uint32_t{f.no_flip} << 2 |
         std::uint32_t{f.r_over_180} << 3 | std::uint32_t{f.t_over_180} << 4 | std::uint32_t{f.s_over_180} << 5;
}

Form hses_form(std::uint32_t bits) {
  const auto bit = [bits](int n) { return (bits >> n & 1) != 0; };
  Form f;
  f.back = bit(0), f.elbow_below = bit(1), f.no_flip = bit(2);
  f.r_over_180 = bit(3), f.t_over_180 = bit(4), f.s_over_180 = bit(5);
  return f;
}

core::Result<HsesMoveData> parse_hses_move(HsesView payload) {
  if (payload.size() != kMoveBytes) return malformed("move (0x8A)", payload);
  HsesReader in(payload);
  HsesMoveData m;
  m.robot = in.u32(), m.station = in.u32();
  m.speed.kind = in.u32(), m.speed.value = in.u32();
  m.target.type = in.u32();
  for (std::size_t i = 0; i < 7; ++i) m.target.axes[i] = in.i32();
  skip(in, 1);
  m.target.form = in.u32(), m.target.extended_form = in.u32();
  m.target.tool = in.u32(), m.target.user = in.u32();
  return m;
}

HsesRequest hses_move(HsesMoveKind kind, const HsesMoveData& m) {
  HsesWriter out;
  out.u32(m.robot).u32(m.station).u32(m.speed.kind).u32(m.speed.value).u32(m.target.type);
  for (std::size_t i = 0; i < 7; ++i) out.i32(m.target.axes[i]);
  out.u32(0).u32(m.target.form).u32(m.target.extended_form).u32(m.target.tool).u32(m.target.user);
  for (int i = 0; i < kBaseAxes + kStationAxes; ++i) out.u32(0);
  return request(kHsesMove, static_cast<std::uint16_t>(kind), 1, HsesService::set_all, out.take());
}

core::Result<HsesPulseMoveData> parse_hses_pulse_move(HsesView payload) {
  if (payload.size() != kPulseMoveBytes) return malformed("move (0x8B)", payload);
  HsesReader in(payload);
  HsesPulseMoveData m;
  m.robot = in.u32(), m.station = in.u32();
  m.speed.kind = in.u32(), m.speed.value = in.u32();
  for (std::int32_t& pulse : m.pulses) pulse = in.i32();
  m.tool = in.u32();
  return m;
}

HsesRequest hses_pulse_move(HsesMoveKind kind, const HsesPulseMoveData& m) {
  HsesWriter out;
  out.u32(m.robot).u32(m.station).u32(m.speed.kind).u32(m.speed.value);
  for (const std::int32_t pulse : m.pulses) out.i32(pulse);
  out.u32(m.tool);
  for (int i = 0; i < kBaseAxes + kStationAxes; ++i) out.u32(0);
  return request(kHsesMovePulse, static_cast<std::uint16_t>(kind), 1, HsesService::set_all, out.take());
}

core::Result<HsesSystemInfo> parse_hses_system(HsesView payload) {
  if (payload.size() != 48) return malformed("system information (0x89)", payload);
  HsesReader in(payload);
  HsesSystemInfo s;
  s.software = in.text(24), s.model = in.text(16), s.parameters = in.text(8);
  return s;
}

HsesBytes hses_payload(const HsesSystemInfo& s) {
  return HsesWriter().text(s.software, 24).text(s.model, 16).text(s.parameters, 8).take();
}

core::Result<HsesManagementTime> parse_hses_time(HsesView payload) {
  if (payload.size() != 28) return malformed("management time (0x88)", payload);
  HsesReader in(payload);
  HsesManagementTime t;
  t.start = in.text(16), t.elapsed = in.text(12);
  return t;
}

HsesBytes hses_payload(const HsesManagementTime& t) {
  return HsesWriter().text(t.start, 16).text(t.elapsed, 12).take();
}

core::Result<std::array<std::string, 8>> parse_hses_axis_names(HsesView payload) {
  if (payload.size() != 32) return malformed("axis names (0x74)", payload);
  HsesReader in(payload);
  std::array<std::string, 8> names;
  for (std::string& name : names) name = in.text(4);
  return names;
}

core::Result<std::array<std::int32_t, 8>> parse_hses_axes(HsesView payload) {
  if (payload.size() != 32) return malformed("axis data", payload);
  HsesReader in(payload);
  std::array<std::int32_t, 8> axes{};
  for (std::int32_t& axis : axes) axis = in.i32();
  return axes;
}

std::vector<std::string> parse_hses_file_list(std::string_view text) {
  std::vector<std::string> names;
  while (!text.empty()) {
    const std::size_t end = text.find_first_of("\r\n");
    if (end != 0) names.emplace_back(text.substr(0, end));
    if (end == std::string_view::npos) break;
    text.remove_prefix(end + 1);
  }
  return names;
}

}  // namespace pickcell::robot
