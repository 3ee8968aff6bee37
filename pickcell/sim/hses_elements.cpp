#include "pickcell/sim/hses_elements.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "pickcell/sim/controller_commands.hpp"
#include "pickcell/sim/controller_contacts.hpp"

namespace pickcell::sim::hses_elements {

namespace {

using robot::HsesBytes;
using robot::HsesReader;
using robot::HsesView;
using robot::HsesWriter;

constexpr std::uint32_t kPulse = 0, kBase = 16, kRobot = 17, kUser = 18, kTool = 19, kMostTool = 63, kFormBits = 0xFF;
constexpr std::size_t kShortText = 16, kLongText = 32;
constexpr int kWritableRegisters = 600;

/// Bits 0 and 2 mean no-flip and back over TCP, back and no-flip over HSES.
int other_form(int bits) { return (bits & ~5) | (bits & 1) << 2 | (bits >> 2 & 1); }

bool in_range(int instance, std::size_t size) { return instance >= 0 && static_cast<std::size_t>(instance) < size; }

HsesBytes axis_words(const AxisPosition& p) {
  HsesWriter out;
  out.u32(p.type);
  for (const std::int32_t axis : p.axes) out.i32(axis);
  return out.take();
}

/// B, I, D: their own size, or a row of 32 bits as the manual draws them.
template <class Number>
std::optional<Number> whole(HsesView payload) {
  HsesReader in(payload);
  if (payload.size() == sizeof(std::int32_t)) {
    const std::int32_t v = in.i32();
    const bool fits = v >= std::numeric_limits<Number>::lowest() && v <= std::numeric_limits<Number>::max();
    return fits ? std::optional(static_cast<Number>(v)) : std::nullopt;
  }
  if constexpr (sizeof(Number) == 1)
    return static_cast<Number>(in.u8());
  else
    return static_cast<Number>(in.u16());
}

template <class Array>
Refused store_whole(Array& values, int instance, HsesView payload) {
  using Number = typename Array::value_type;
  if (!in_range(instance, values.size())) return kBadInstance;
  if (payload.size() != sizeof(Number) && payload.size() != sizeof(std::int32_t)) return kBadLength;
  const auto v = whole<Number>(payload);
  if (!v) return kBadValue;
  values[static_cast<std::size_t>(instance)] = *v;
  return 0;
}

Refused store_real(ControllerState& s, int instance, HsesView payload) {
  if (!in_range(instance, s.R.size())) return kBadInstance;
  if (payload.size() != 4) return kBadLength;
  const float v = HsesReader(payload).f32();
  if (!std::isfinite(v)) return kBadValue;
  s.R[static_cast<std::size_t>(instance)] = v;
  return 0;
}

Refused store_text(ControllerState& s, int instance, HsesView payload, std::size_t size) {
  if (!in_range(instance, s.S.size())) return kBadInstance;
  if (payload.size() > size) return kBadLength;
  s.S[static_cast<std::size_t>(instance)] =
      std::string(payload.begin(), std::find(payload.begin(), payload.end(), std::uint8_t{0}));
  return 0;
}

Refused store_position(ControllerState& s, int instance, HsesView payload) {
  if (!in_range(instance, s.P.size())) return kBadInstance;
  const auto words = robot::parse_hses_position(payload);
  if (!words) return kBadLength;
  const auto position = position_from(s, *words);
  if (const auto* refused = std::get_if<Refused>(&position)) return *refused;
  s.P[static_cast<std::size_t>(instance)] = std::get<Position>(position);
  return 0;
}

Refused store_axes(std::array<AxisPosition, 128>& values, int instance, HsesView payload) {
  if (!in_range(instance, values.size())) return kBadInstance;
  if (payload.size() != 36) return kBadLength;
  HsesReader in(payload);
  AxisPosition& p = values[static_cast<std::size_t>(instance)];
  p.type = in.u32();
  for (std::int32_t& axis : p.axes) axis = in.i32();
  return 0;
}

Refused store_register(ControllerState& s, int instance, HsesView payload) {
  if (!in_range(instance, s.M.size())) return kBadInstance;
  if (instance >= kWritableRegisters) return static_cast<Refused>(0x2120);
  return store_whole(s.M, instance, payload);
}

Refused store_contacts(ControllerState& s, int instance, HsesView payload) {
  if (!read_group(s, instance)) return kBadInstance;
  if (payload.size() != 1 && payload.size() != 4) return kBadLength;
  return write_group(s, instance, payload[0]) ? Refused{0} : Refused{0x2120};
}

}  // namespace

bool is_element(std::uint16_t command) {
  return (command >= robot::kHsesIo && command <= robot::kHsesEx) || command == robot::kHsesS32;
}

std::uint16_t element_of(std::uint16_t plural) {
  constexpr std::uint16_t kFirst = robot::kHsesPluralIo - robot::kHsesIo;
  if (plural < robot::kHsesPluralIo || plural > robot::kHsesPluralEx) return 0;
  return static_cast<std::uint16_t>(plural - kFirst);
}

std::variant<HsesBytes, Refused> read(const ControllerState& s, std::uint16_t command, int instance) {
  const auto i = static_cast<std::size_t>(std::max(instance, 0));
  const auto known = [&](const auto& values) { return in_range(instance, values.size()); };
  HsesWriter out;
  switch (command) {
    case robot::kHsesIo: {
      const auto group = read_group(s, instance);
      if (!group) return kBadInstance;
      return HsesBytes{*group};
    }
    case robot::kHsesRegister:
      if (!known(s.M)) return kBadInstance;
      return out.u16(s.M[i]).take();
    case robot::kHsesB:
      if (!known(s.B)) return kBadInstance;
      return out.u8(s.B[i]).take();
    case robot::kHsesI:
      if (!known(s.I)) return kBadInstance;
      return out.u16(static_cast<std::uint16_t>(s.I[i])).take();
    case robot::kHsesD:
      if (!known(s.D)) return kBadInstance;
      return out.i32(s.D[i]).take();
    case robot::kHsesR:
      if (!known(s.R)) return kBadInstance;
      return out.f32(s.R[i]).take();
    case robot::kHsesS16:
    case robot::kHsesS32:
      if (!known(s.S)) return kBadInstance;
      return out.text(s.S[i], command == robot::kHsesS16 ? kShortText : kLongText).take();
    case robot::kHsesP:
      if (!known(s.P)) return kBadInstance;
      if (!s.P[i]) return kUndefined;
      return robot::hses_payload(position_words(*s.P[i]));
    case robot::kHsesBp:
    case robot::kHsesEx:
      if (!known(s.BP)) return kBadInstance;
      return axis_words(command == robot::kHsesBp ? s.BP[i] : s.EX[i]);
    default:
      return kBadCommand;
  }
}

Refused write(ControllerState& s, std::uint16_t command, int instance, HsesView payload) {
  if (const Refusal refusal = may_write(s); refusal != Refusal::none) return 0x2100;
  switch (command) {
    case robot::kHsesIo:
      return store_contacts(s, instance, payload);
    case robot::kHsesRegister:
      return store_register(s, instance, payload);
    case robot::kHsesB:
      return store_whole(s.B, instance, payload);
    case robot::kHsesI:
      return store_whole(s.I, instance, payload);
    case robot::kHsesD:
      return store_whole(s.D, instance, payload);
    case robot::kHsesR:
      return store_real(s, instance, payload);
    case robot::kHsesS16:
      return store_text(s, instance, payload, kShortText);
    case robot::kHsesS32:
      return store_text(s, instance, payload, kLongText);
    case robot::kHsesP:
      return store_position(s, instance, payload);
    case robot::kHsesBp:
      return store_axes(s.BP, instance, payload);
    case robot::kHsesEx:
      return store_axes(s.EX, instance, payload);
    default:
      return kBadCommand;
  }
}

robot::HsesPosition position_words(const Position& p) {
  robot::HsesPosition words;
  words.form = static_cast<std::uint32_t>(other_form(p.form));
  words.tool = static_cast<std::uint32_t>(p.tool);
  words.extended_form = p.extended_form;
  std::copy(p.axis.begin(), p.axis.end(), words.axes.begin());
  std::copy(p.more_axes.begin(), p.more_axes.end(), words.axes.begin() + 6);
  if (p.pulse) return words;
  words.type = p.frame == 0 ? kBase : p.frame == 1 ? kRobot : p.frame == kToolFrame ? kTool : kUser;
  if (words.type == kUser) words.user = static_cast<std::uint32_t>(p.frame - 1);
  return words;
}

std::variant<Position, Refused> position_from(const ControllerState& s, const robot::HsesPosition& words) {
  Position p;
  p.pulse = words.type == kPulse;
  if (words.type == kRobot)
    p.frame = 1;
  else if (words.type == kTool)
    p.frame = kToolFrame;
  else if (words.type == kUser && (words.user < 1 || words.user > static_cast<std::uint32_t>(s.type.user_frames)))
    return kBadUserFrame;
  else if (words.type == kUser)
    p.frame = 1 + static_cast<int>(words.user);
  else if (words.type != kPulse && words.type != kBase)
    return kBadType;
  if (words.tool > kMostTool) return kBadTool;
  if (words.form > kFormBits) return kBadForm;
  p.form = other_form(static_cast<int>(words.form));
  p.tool = static_cast<int>(words.tool);
  p.extended_form = words.extended_form;
  std::copy_n(words.axes.begin(), p.axis.size(), p.axis.begin());
  std::copy_n(words.axes.begin() + 6, p.more_axes.size(), p.more_axes.begin());
  return p;
}

}  // namespace pickcell::sim::hses_elements
