#include "pickcell/sim/tcp80_variables.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdarg>
#include <cstdint>
#include <cstdio>
#include <limits>

#include "pickcell/sim/controller_contacts.hpp"
#include "pickcell/sim/tcp80_fields.hpp"

namespace pickcell::sim::tcp80 {

using tcp80_fields::number;
using tcp80_fields::whole;

namespace {

constexpr double kFarthest_mm = 999999.999, kWidest_deg = 360;
constexpr std::size_t kTextBytes = 16;

enum VariableType { kB = 0, kI = 1, kD = 2, kR = 3, kP = 4, kS = 7 };

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

}  // namespace

std::string format(const char* pattern, ...) {
  std::array<char, 256> text{};
  std::va_list args;
  va_start(args, pattern);
  const int n = std::vsnprintf(text.data(), text.size(), pattern, args);
  va_end(args);
  return {text.data(), static_cast<std::size_t>(std::clamp(n, 0, 255))};
}

std::string joined(const std::vector<std::string>& parts) {
  std::string out;
  for (const std::string& part : parts) out += (out.empty() ? "" : ",") + part;
  return out;
}

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

}  // namespace pickcell::sim::tcp80
