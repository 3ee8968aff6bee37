#include "pickcell/robot/tcp80_codec.hpp"

#include <charconv>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <utility>
#include <variant>

namespace pickcell::robot {

using core::ErrorCode;

namespace {

std::string_view trim(std::string_view text) {
  constexpr std::string_view kBlank = " \t";
  const auto first = text.find_first_not_of(kBlank);
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(kBlank) - first + 1);
}

template <class T>
std::optional<T> number(std::string_view text) {
  T value{};
  const auto [end, problem] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (problem != std::errc{} || end != text.data() + text.size()) return std::nullopt;
  return value;
}

std::optional<double> real(std::string_view text) {
  const auto value = number<double>(text);
  if (!value || !std::isfinite(*value)) return std::nullopt;
  return value;
}

auto malformed(std::string_view what, std::string_view line) {
  return core::failure(ErrorCode::link, "answer to " + std::string(what),
                       "not understood: \"" + tcp80_shown(line) + "\"",
                       "check that the address is a Yaskawa Ethernet Server");
}

/// Takes fields one after the other; remembers whether any was wrong.
class Reader {
 public:
  explicit Reader(std::span<const std::string_view> fields) : fields_(fields) {}
  double real() {
    const auto value = robot::real(take());
    good_ &= value.has_value();
    return value.value_or(0);
  }
  std::int32_t integer(std::int32_t lowest = std::numeric_limits<std::int32_t>::min(),
                       std::int32_t highest = std::numeric_limits<std::int32_t>::max()) {
    const auto value = number<std::int32_t>(take());
    good_ &= value && *value >= lowest && *value <= highest;
    return value.value_or(0);
  }
  [[nodiscard]] bool good() const { return good_; }

 private:
  std::string_view take() { return used_ < fields_.size() ? fields_[used_++] : std::string_view{}; }
  std::span<const std::string_view> fields_;
  std::size_t used_ = 0;
  bool good_ = true;
};

void append_fixed(std::string& out, double value, int decimals) {
  if (!std::isfinite(value)) throw std::invalid_argument("a position must be finite");
  char text[400];
  const auto [end, problem] = std::to_chars(text, text + sizeof text, value, std::chars_format::fixed, decimals);
  if (problem != std::errc{}) throw std::invalid_argument("a position is too large");
  out.append(text, end);
}

void check_numbers(int tool, int frame) {
  if (tool < 0 || tool > kMaxTool) throw std::invalid_argument("tool number outside 0..63");
  if (frame < 0 || frame > kMaxFrame) throw std::invalid_argument("frame number outside 0..65");
}

void check_speed(double speed) {
  if (!(speed > 0)) throw std::invalid_argument("no speed for a move");
}

void read_pose(Reader& reader, CartesianPosition& p, bool seven_axes) {
  p.x_mm = reader.real(), p.y_mm = reader.real(), p.z_mm = reader.real();
  p.rx_deg = reader.real(), p.ry_deg = reader.real(), p.rz_deg = reader.real();
  if (seven_axes) p.re_deg = reader.real();
  p.form = tcp80_form(reader.integer(0, 255));
  p.tool = reader.integer(0, kMaxTool);
}

}  // namespace

std::string tcp80_shown(std::string_view line) {
  constexpr std::size_t kMost = 120;
  std::string shown;
  for (const char c : line.substr(0, kMost)) shown += c >= ' ' && c <= '~' ? c : '?';
  return line.size() > kMost ? shown + "..." : shown;
}

core::Status Tcp80LineSplitter::feed(std::string_view bytes) {
  for (const char c : bytes) {
    const bool line_feed_of_crlf = c == '\n' && after_cr_;
    if (c == '\0' || line_feed_of_crlf) {
      after_cr_ = after_cr_ && c == '\0';
      continue;
    }
    after_cr_ = c == '\r';
    if (c == '\r' || c == '\n') {
      lines_.push_back(std::move(partial_));
      partial_.clear();
    } else if (partial_.size() < kMaxLineBytes) {
      partial_ += c;
    } else {
      return core::failure(ErrorCode::link, "robot link", "a line of more than 16384 bytes without an end",
                           "check that the address is a Yaskawa Ethernet Server");
    }
  }
  return {};
}

std::optional<std::string> Tcp80LineSplitter::next() {
  if (lines_.empty()) return std::nullopt;
  std::string line = std::move(lines_.front());
  lines_.pop_front();
  return line;
}

Tcp80LineKind tcp80_line_kind(std::string_view line) {
  line = trim(line);
  if (line.starts_with("OK:")) return Tcp80LineKind::ok;
  if (line.starts_with("NG:")) return Tcp80LineKind::refused;
  if (line.starts_with("ERROR:")) return Tcp80LineKind::error;
  return line == "0000" ? Tcp80LineKind::accepted : Tcp80LineKind::data;
}

std::optional<std::uint16_t> tcp80_fault_code(std::string_view line) {
  const auto open = line.rfind('(');
  if (open == std::string_view::npos) return std::nullopt;
  const auto close = line.find(')', open);
  if (close == std::string_view::npos) return std::nullopt;
  const std::string_view digits = trim(line.substr(open + 1, close - open - 1));
  std::uint16_t code = 0;
  const auto [end, problem] = std::from_chars(digits.data(), digits.data() + digits.size(), code, 16);
  if (problem != std::errc{} || end != digits.data() + digits.size() || digits.size() != 4) return std::nullopt;
  return code;
}

std::string tcp80_connect() { return "CONNECT Robot_access Keep-Alive:-1\r\n"; }

bool tcp80_keeps_alive(std::string_view banner) {
  return banner.find("Keep-Alive:") != std::string_view::npos || banner.find("KeepAlive:") != std::string_view::npos;
}

Tcp80Request tcp80_request(std::string_view command, std::string_view operands) {
  Tcp80Request request{std::string(command), {}, {}};
  if (!operands.empty()) request.operands = std::string(operands) + '\r';
  request.header = "HOSTCTRL_REQUEST " + request.command + ' ' + std::to_string(request.operands.size()) + "\r\n";
  return request;
}

std::string tcp80_read_variable(VariableType type, int number) {
  return std::to_string(static_cast<int>(type)) + ',' + std::to_string(number);
}

std::string tcp80_write_integer(VariableType type, int number, std::int32_t value) {
  return tcp80_read_variable(type, number) + ',' + std::to_string(value);
}

std::string tcp80_write_real(int number, double value) {
  std::string out = tcp80_read_variable(VariableType::real, number) + ',';
  append_fixed(out, value, 6);
  return out;
}

std::string tcp80_write_string(int number, std::string_view value) {
  constexpr std::size_t kMostBytes = 32;
  if (value.size() > kMostBytes || value.find_first_of(std::string_view("\r\n\0", 3)) != std::string_view::npos)
    throw std::invalid_argument("a string has at most 32 bytes and no line ends");
  return tcp80_read_variable(VariableType::string, number) + ',' + std::string(value);
}

std::string tcp80_write_position(int number, const VariablePosition& position) {
  const auto* cartesian = std::get_if<CartesianPosition>(&position);
  check_numbers(std::visit([](const auto& any) { return any.tool; }, position),
                cartesian ? cartesian->frame : kBaseFrame);
  return tcp80_read_variable(VariableType::position, number) + ',' + tcp80_position_fields(position);
}

Tcp80Move tcp80_move(const DirectMove& move) {
  check_speed(move.speed);
  check_numbers(move.target.tool, move.target.frame);
  const bool joint = move.kind == DirectMove::Kind::joint;
  std::string operands;
  if (!joint) operands = move.turning ? "1," : "0,";  // VR deg/s, V mm/s
  append_fixed(operands, move.speed, joint ? 2 : 1);
  const CartesianPosition& p = move.target;
  operands += ',' + std::to_string(p.frame);
  for (const double mm : {p.x_mm, p.y_mm, p.z_mm}) append_fixed(operands += ',', mm, 3);
  for (const double deg : {p.rx_deg, p.ry_deg, p.rz_deg}) append_fixed(operands += ',', deg, 4);
  if (p.re_deg) append_fixed(operands += ',', *p.re_deg, 4);
  operands += ',' + std::to_string(tcp80_form(p.form)) + ',' + std::to_string(p.tool) + ",0,0,0,0,0,0";
  return {joint ? "MOVJ" : move.kind == DirectMove::Kind::line ? "MOVL" : "IMOV", std::move(operands)};
}

Tcp80Move tcp80_move(const PulseMove& move) {
  if (move.line) throw std::invalid_argument("TCP port 80: the operands of PMOVL are not known");
  check_speed(move.speed);
  check_numbers(move.target.tool, kBaseFrame);
  std::string operands;
  append_fixed(operands, move.speed, 2);
  for (const std::int32_t pulse : move.target.pulses) operands += ',' + std::to_string(pulse);
  operands += ",0,0,0,0,0,0," + std::to_string(move.target.tool);
  return {"PMOVJ", std::move(operands)};
}

std::string tcp80_position_fields(const VariablePosition& position) {
  if (const auto* pulse = std::get_if<PulsePosition>(&position)) {
    std::string out = "0";
    for (const std::int32_t p : pulse->pulses) out += ',' + std::to_string(p);
    return out + ',' + std::to_string(pulse->tool);
  }
  const auto& p = std::get<CartesianPosition>(position);
  std::string out = "1," + std::to_string(p.frame);
  for (const double mm : {p.x_mm, p.y_mm, p.z_mm}) append_fixed(out += ',', mm, 3);
  for (const double deg : {p.rx_deg, p.ry_deg, p.rz_deg}) append_fixed(out += ',', deg, 4);
  if (p.re_deg) append_fixed(out += ',', *p.re_deg, 4);
  return out + ',' + std::to_string(tcp80_form(p.form)) + ',' + std::to_string(p.tool);
}

int tcp80_form(const Form& f) {
  return int{f.no_flip} | f.elbow_below << 1 | f.back << 2 | f.r_over_180 << 3 | f.t_over_180 << 4 | f.s_over_180 << 5;
}

Form tcp80_form(int bits) {
  const auto bit = [bits](int n) { return (bits >> n & 1) != 0; };
  return {bit(0), bit(1), bit(2), bit(3), bit(4), bit(5)};
}

std::vector<std::string_view> tcp80_fields(std::string_view line) {
  std::vector<std::string_view> fields;
  for (;;) {
    const auto comma = line.find(',');
    fields.push_back(trim(line.substr(0, comma)));
    if (comma == std::string_view::npos) return fields;
    line.remove_prefix(comma + 1);
  }
}

core::Result<RobotState> parse_rstats(std::string_view line) {
  const auto fields = tcp80_fields(line);
  Reader reader(fields);
  const int d1 = reader.integer(0, 255), d2 = reader.integer(0, 255);
  if (fields.size() != 2 || !reader.good()) return malformed("RSTATS", line);
  const auto bit = [](int word, int n) { return (word >> n & 1) != 0; };
  RobotState state;
  state.step = bit(d1, 0), state.one_cycle = bit(d1, 1), state.continuous = bit(d1, 2), state.running = bit(d1, 3);
  state.speed_limited = bit(d1, 4), state.teach = bit(d1, 5), state.play = bit(d1, 6), state.remote = bit(d1, 7);
  state.hold_pendant = bit(d2, 1), state.hold_external = bit(d2, 2), state.hold_command = bit(d2, 3);
  state.alarm = bit(d2, 4), state.error = bit(d2, 5), state.servo = bit(d2, 6);
  return state;
}

core::Result<CartesianPosition> parse_rposc(std::string_view line, int frame) {
  const auto fields = tcp80_fields(line);  // 6 more with external axes, 1 more on arms with seven axes
  const std::size_t n = fields.size();
  if (n != 8 && n != 9 && n != 14 && n != 15) return malformed("RPOSC", line);
  Reader reader(fields);
  CartesianPosition p;
  p.frame = frame;
  read_pose(reader, p, n % 2 == 1);
  if (!reader.good()) return malformed("RPOSC", line);
  return p;
}

core::Result<std::vector<std::int32_t>> parse_rposj(std::string_view line) {
  const auto fields = tcp80_fields(line);
  Reader reader(fields);
  std::vector<std::int32_t> pulses;
  for (std::size_t i = 0; i < fields.size(); ++i) pulses.push_back(reader.integer());
  if ((fields.size() != 12 && fields.size() != 13) || !reader.good()) return malformed("RPOSJ", line);
  return pulses;
}

core::Result<std::vector<Alarm>> parse_ralarm(std::string_view line) {
  const auto fields = tcp80_fields(line);
  Reader reader(fields);
  std::vector<Alarm> alarms;
  for (std::size_t i = 0; i + 1 < fields.size(); i += 2) {
    const int code = reader.integer(), data = reader.integer();
    if (code == 0) continue;
    alarms.push_back(
        {code, data, (i == 0 ? "error " : "alarm ") + std::to_string(code) + " [" + std::to_string(data) + "]"});
  }
  if (fields.size() != 10 || !reader.good()) return malformed("RALARM", line);
  return alarms;
}

core::Result<CurrentJob> parse_rjseq(std::string_view line) {
  const auto fields = tcp80_fields(line);
  if (fields.size() != 3) return malformed("RJSEQ", line);
  Reader reader(std::span<const std::string_view>(fields).subspan(1));
  CurrentJob job{std::string(fields[0]), reader.integer(0, 9999), reader.integer(0, 9999)};
  if (!reader.good()) return malformed("RJSEQ", line);
  return job;
}

std::vector<std::string> parse_rjdir(std::string_view line) {
  std::vector<std::string> names;
  std::string name;
  for (const char c : line) {
    if (c != ',' && c != ' ' && c != '\t') {
      name += c;
    } else if (!name.empty()) {
      names.push_back(std::exchange(name, {}));
    }
  }
  if (!name.empty()) names.push_back(std::move(name));
  return names;
}

core::Result<std::int32_t> parse_integer_variable(std::string_view line, VariableType type) {
  const std::string_view text[] = {trim(line)};
  Reader reader(text);
  std::int32_t value = 0;
  if (type == VariableType::byte) {
    value = reader.integer(0, 255);
  } else if (type == VariableType::integer) {
    value = reader.integer(std::numeric_limits<std::int16_t>::min(), std::numeric_limits<std::int16_t>::max());
  } else {
    value = reader.integer();
  }
  if (!reader.good()) return malformed("SAVEV", line);
  return value;
}

core::Result<double> parse_real_variable(std::string_view line) {
  const auto value = real(trim(line));
  if (!value) return malformed("SAVEV", line);
  return *value;
}

core::Result<VariablePosition> parse_position_variable(std::string_view line, int number) {
  const auto all = tcp80_fields(line);
  std::span<const std::string_view> fields(all);
  const bool repeats = fields.size() >= 10 && fields[0] == "4" && fields[1] == std::to_string(number);
  if (repeats) fields = fields.subspan(2);
  Reader reader(fields);
  const int cartesian = reader.integer(0, 1);
  VariablePosition out;
  bool length_fits = false;
  if (cartesian == 1) {
    CartesianPosition p;
    p.frame = reader.integer(0, 255);
    read_pose(reader, p, fields.size() == 11);
    length_fits = fields.size() == 10 || fields.size() == 11;
    out = p;
  } else {
    PulsePosition p;
    for (auto& pulse : p.pulses) pulse = reader.integer();
    p.tool = reader.integer(0, kMaxTool);
    length_fits = fields.size() == 8;
    out = p;
  }
  if (!length_fits || !reader.good()) return malformed("SAVEV", line);
  return out;
}

core::Result<std::vector<std::uint8_t>> parse_ioread(std::string_view line, std::size_t groups) {
  const auto fields = tcp80_fields(line);
  Reader reader(fields);
  std::vector<std::uint8_t> bytes;
  for (std::size_t i = 0; i < fields.size(); ++i) bytes.push_back(static_cast<std::uint8_t>(reader.integer(0, 255)));
  if (fields.size() != groups || !reader.good()) return malformed("IOREAD", line);
  return bytes;
}

}  // namespace pickcell::robot
