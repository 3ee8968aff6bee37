#include "pickcell/cli/robot/names.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <optional>

#include "pickcell/cli/values.hpp"

namespace pickcell::cli {

using core::ErrorCode;
using core::Json;
using robot::VariableType;

namespace {

std::optional<int> whole(std::string_view text) {
  int v = 0;
  const auto [end, problem] = std::from_chars(text.data(), text.data() + text.size(), v);
  if (text.empty() || problem != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return v;
}

auto unknown(const std::string& word) {
  return core::failure(ErrorCode::usage, word, "names no variable or contact",
                       "B010, I010, D010, R003, S010, P010, M100, or a contact's number such as 27010");
}

auto unfit(const std::string& name, const std::string& value, const std::string& what) {
  return core::failure(ErrorCode::usage, name + "=" + value, "is not " + what, "give a value that fits");
}

std::string padded(char letter, int number) {
  const std::string digits = std::to_string(number);
  return letter + std::string(digits.size() < 3 ? 3 - digits.size() : 0, '0') + digits;
}

std::pair<double, double> range(VariableType type) {
  if (type == VariableType::byte) return {0, 255};
  if (type == VariableType::integer) return {-32768, 32767};
  return {std::numeric_limits<std::int32_t>::lowest(), std::numeric_limits<std::int32_t>::max()};
}

core::Status write_contact(robot::ControllerLink& link, const RobotName& name, bool on) {
  const int first = name.number / 10 * 10, bit = name.number % 10;
  auto group = link.read_contacts(first, 1);
  if (!group) return core::forward(group);
  const int mask = 1 << bit;
  group->front() = static_cast<std::uint8_t>(on ? group->front() | mask : group->front() & ~mask);
  return link.write_contacts(first, *group);
}

core::Status write_position(robot::ControllerLink& link, const RobotName& name, const std::string& value) {
  auto v = parse_numbers(name.text, value, 6, 8);
  if (!v) return core::forward(v);
  robot::CartesianPosition p;
  p.x_mm = (*v)[0], p.y_mm = (*v)[1], p.z_mm = (*v)[2];
  p.rx_deg = (*v)[3], p.ry_deg = (*v)[4], p.rz_deg = (*v)[5];
  const auto small = [](double n, int most) { return n == std::floor(n) && n >= 0 && n <= most; };
  if (v->size() > 6 && !small((*v)[6], robot::kMaxTool)) return unfit(name.text, value, "with a tool number 0-63");
  if (v->size() > 7 && !small((*v)[7], 65)) return unfit(name.text, value, "with a frame number 0-65");
  for (std::size_t i = 0; i < 3; ++i)
    if (std::abs((*v)[i]) > 100'000) return unfit(name.text, value, "within 100 m");
  for (std::size_t i = 3; i < 6; ++i)
    if (std::abs((*v)[i]) > 360) return unfit(name.text, value, "with angles within 360 degrees");
  if (v->size() > 6) p.tool = static_cast<int>((*v)[6]);
  if (v->size() > 7) p.frame = static_cast<int>((*v)[7]);
  return link.write_position_variable(name.number, p);
}

Json pulse_json(const robot::PulsePosition& p) {
  Json pulses = Json::array();
  for (const std::int32_t pulse : p.pulses) pulses.push(std::int64_t{pulse});
  return Json::object().set("pulses", pulses).set("tool", p.tool);
}

}  // namespace

core::Result<RobotName> parse_robot_name(const std::string& word) {
  if (word.empty()) return unknown(word);
  RobotName name;
  const char letter = word.front();
  const std::string_view digits = std::string_view(word).substr(letter == '#' ? 1 : 0);
  if (letter == '#' || (letter >= '0' && letter <= '9')) {
    const auto n = whole(digits);
    if (!n || *n < 10 || *n > 99999 || *n % 10 > 7) return unknown(word);
    name.kind = RobotName::Kind::contact;
    name.number = *n;
    name.text = std::to_string(*n);
    return name;
  }
  const auto n = whole(std::string_view(word).substr(1));
  if (!n || *n < 0 || *n > 999) return unknown(word);
  name.number = *n;
  name.text = padded(letter, *n);
  if (letter == 'B' || letter == 'I' || letter == 'D') {
    name.type = letter == 'B'   ? VariableType::byte
                : letter == 'I' ? VariableType::integer
                                : VariableType::double_integer;
  } else if (letter == 'R' || letter == 'P') {
    name.kind = letter == 'R' ? RobotName::Kind::real : RobotName::Kind::position;
  } else if (letter == 'S' || letter == 'M') {
    name.kind = letter == 'S' ? RobotName::Kind::string : RobotName::Kind::reg;
  } else {
    return unknown(word);
  }
  return name;
}

Json position_json(const robot::CartesianPosition& p) {
  Json out = Json::object();
  const auto mm = [](double v) { return std::round(v * 1e3) / 1e3; };  // what a controller tells
  const auto deg = [](double v) { return std::round(v * 1e4) / 1e4; };
  out.set("x_mm", mm(p.x_mm)).set("y_mm", mm(p.y_mm)).set("z_mm", mm(p.z_mm));
  out.set("rx_deg", deg(p.rx_deg)).set("ry_deg", deg(p.ry_deg)).set("rz_deg", deg(p.rz_deg));
  if (p.re_deg) out.set("re_deg", deg(*p.re_deg));
  out.set("frame", p.frame).set("tool", p.tool);
  Json form = Json::array();
  const robot::Form& f = p.form;
  for (const auto& [on, word] : std::initializer_list<std::pair<bool, const char*>>{{f.no_flip, "no_flip"},
                                                                                    {f.elbow_below, "elbow_below"},
                                                                                    {f.back, "back"},
                                                                                    {f.r_over_180, "r_over_180"},
                                                                                    {f.t_over_180, "t_over_180"},
                                                                                    {f.s_over_180, "s_over_180"}})
    if (on) form.push(word);
  if (!form.items().empty()) out.set("form", form);
  return out;
}

core::Result<Json> read_robot_value(robot::ControllerLink& link, const RobotName& name) {
  switch (name.kind) {
    case RobotName::Kind::integer: {
      auto v = link.read_integer(name.type, name.number);
      if (!v) return core::forward(v);
      return Json(std::int64_t{*v});
    }
    case RobotName::Kind::real: {
      auto v = link.read_real(name.number);
      if (!v) return core::forward(v);
      return Json(*v);
    }
    case RobotName::Kind::string: {
      auto v = link.read_string(name.number);
      if (!v) return core::forward(v);
      return Json(*v);
    }
    case RobotName::Kind::reg: {
      auto v = link.read_register(name.number);
      if (!v) return core::forward(v);
      return Json(std::int64_t{*v});
    }
    case RobotName::Kind::position: {
      auto v = link.read_position_variable(name.number);
      if (!v) return core::forward(v);
      if (const auto* pulse = std::get_if<robot::PulsePosition>(&*v)) return pulse_json(*pulse);
      return position_json(std::get<robot::CartesianPosition>(*v));
    }
    case RobotName::Kind::contact:
      break;
  }
  auto group = link.read_contacts(name.number / 10 * 10, 1);
  if (!group) return core::forward(group);
  return Json((group->front() >> name.number % 10 & 1) != 0);
}

core::Status write_robot_value(robot::ControllerLink& link, const RobotName& name, const std::string& value) {
  if (name.kind == RobotName::Kind::position) return write_position(link, name, value);
  if (name.kind == RobotName::Kind::string) {
    constexpr std::size_t kMostBytes = 32;
    const bool plain = std::all_of(value.begin(), value.end(), [](char c) { return c >= ' ' && c <= '~'; });
    if (value.size() > kMostBytes || !plain) return unfit(name.text, value, "at most 32 printable characters");
    return link.write_string(name.number, value);
  }
  auto numbers = parse_numbers(name.text, value, 1, 1);
  if (!numbers) return core::forward(numbers);
  const double v = numbers->front();
  if (name.kind == RobotName::Kind::real) {
    if (std::abs(v) > static_cast<double>(std::numeric_limits<float>::max()))
      return unfit(name.text, value, "within 32 bits");
    return link.write_real(name.number, v);
  }
  if (name.kind == RobotName::Kind::contact) {
    if (v != 0 && v != 1) return unfit(name.text, value, "0 or 1");
    return write_contact(link, name, v == 1);
  }
  if (name.kind == RobotName::Kind::reg) {
    if (v != std::floor(v) || v < 0 || v > 65535) return unfit(name.text, value, "a whole number from 0 to 65535");
    return link.write_register(name.number, static_cast<std::uint16_t>(v));
  }
  const auto [low, high] = range(name.type);
  if (v != std::floor(v) || v < low || v > high)
    return unfit(name.text, value,
                 "a whole number from " + std::to_string(static_cast<std::int64_t>(low)) + " to " +
                     std::to_string(static_cast<std::int64_t>(high)));
  return link.write_integer(name.type, name.number, static_cast<std::int32_t>(v));
}

}  // namespace pickcell::cli
