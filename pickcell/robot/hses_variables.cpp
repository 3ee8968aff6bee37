#include "pickcell/robot/hses_variables.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace pickcell::robot {

using core::ErrorCode;
using Repeat = HsesSession::Repeat;

namespace {

std::uint16_t instance(int number) {
  if (number < 0 || number > 65535) throw std::invalid_argument("number of a variable or contact out of range");
  return static_cast<std::uint16_t>(number);
}

struct Scalar {
  std::uint16_t command, plural;
  std::size_t bytes;
};
Scalar scalar(VariableType type) {
  switch (type) {
    case VariableType::byte:
      return {kHsesB, kHsesPluralB, 1};
    case VariableType::integer:
      return {kHsesI, kHsesPluralI, 2};
    case VariableType::double_integer:
      return {kHsesD, kHsesPluralD, 4};
    default:
      throw std::invalid_argument("not a variable of whole numbers");
  }
}

std::int32_t whole(VariableType type, HsesReader& in) {
  if (type == VariableType::byte) return in.u8();
  if (type == VariableType::integer) return static_cast<std::int16_t>(in.u16());
  return in.i32();
}

void append_whole(VariableType type, HsesWriter& out, std::int32_t value) {
  if (type == VariableType::byte)
    out.u8(static_cast<std::uint8_t>(value));
  else if (type == VariableType::integer)
    out.u16(static_cast<std::uint16_t>(value));
  else
    out.i32(value);
}

float real(double value) {
  const auto v = static_cast<float>(value);
  if (!std::isfinite(v)) throw std::invalid_argument("a value must be finite and within 32 bits");
  return v;
}

auto odd_size(const std::string& what) {
  return core::failure(ErrorCode::link, what, "the answer has not the size of its value",
                       "check that the address is a controller's High Speed Ethernet Server");
}

HsesPosition position_words(HsesReader& in) {
  HsesPosition p;
  p.type = in.u32(), p.form = in.u32(), p.tool = in.u32(), p.user = in.u32(), p.extended_form = in.u32();
  for (std::int32_t& axis : p.axes) axis = in.i32();
  return p;
}

HsesAxesPosition axes_words(HsesReader& in) {
  HsesAxesPosition p;
  p.type = in.u32();
  for (std::int32_t& axis : p.axes) axis = in.i32();
  return p;
}

bool base(HsesVariables::Axes which) { return which == HsesVariables::Axes::base; }

template <class Values, class Append>
HsesBytes elements(const Values& values, Append append) {
  HsesWriter out;
  for (const auto& v : values) append(out, v);
  return out.take();
}

}  // namespace

template <class Value, class Decode>
core::Result<std::vector<Value>> HsesVariables::read_many(std::uint16_t command, int first, int count,
                                                          const std::string& what, Decode decode) {
  const auto n = static_cast<std::uint32_t>(std::max(count, 0));
  return session_.read(hses_read_plural(command, instance(first), n), what,
                       [&](HsesView payload) -> core::Result<std::vector<Value>> {
                         auto found = parse_hses_plural(payload, command, n);
                         if (!found) return core::forward(found);
                         HsesReader in(*found);
                         std::vector<Value> values;
                         for (std::uint32_t i = 0; i < n; ++i) values.push_back(decode(in));
                         return values;
                       });
}

core::Status HsesVariables::write_many(std::uint16_t command, int first, std::size_t count, HsesBytes bytes,
                                       const std::string& what) {
  return session_.tell(hses_write_plural(command, instance(first), static_cast<std::uint32_t>(count), std::move(bytes)),
                       Repeat::yes, what);
}

core::Result<std::int32_t> HsesVariables::read_integer(VariableType type, int number) {
  const Scalar s = scalar(type);
  return session_.read(hses_get(s.command, instance(number), 1), "variable",
                       [&](HsesView payload) -> core::Result<std::int32_t> {
                         // The manual draws B and I as rows of 32 bits; real controllers answer with 1, 2 and 4 bytes.
                         if (payload.size() != s.bytes && payload.size() != 4) return odd_size("variable");
                         HsesReader in(payload);
                         return whole(type, in);
                       });
}

core::Status HsesVariables::write_integer(VariableType type, int number, std::int32_t value) {
  HsesWriter out;
  append_whole(type, out, value);
  return session_.tell(hses_set_one(scalar(type).command, instance(number), out.take()), Repeat::yes, "variable");
}

core::Result<std::vector<std::int32_t>> HsesVariables::read_integers(VariableType type, int first, int count) {
  return read_many<std::int32_t>(scalar(type).plural, first, count, "variables",
                                 [type](HsesReader& in) { return whole(type, in); });
}

core::Status HsesVariables::write_integers(VariableType type, int first, const std::vector<std::int32_t>& values) {
  return write_many(scalar(type).plural, first, values.size(),
                    elements(values, [type](HsesWriter& out, std::int32_t v) { append_whole(type, out, v); }),
                    "variables");
}

core::Result<double> HsesVariables::read_real(int number) {
  return session_.read(hses_get(kHsesR, instance(number), 1), "variable R",
                       [](HsesView payload) -> core::Result<double> {
                         if (payload.size() != 4) return odd_size("variable R");
                         const float v = HsesReader(payload).f32();
                         if (!std::isfinite(v)) return odd_size("variable R");
                         return static_cast<double>(v);
                       });
}

core::Status HsesVariables::write_real(int number, double value) {
  return session_.tell(hses_set_one(kHsesR, instance(number), HsesWriter().f32(real(value)).take()), Repeat::yes,
                       "variable R");
}

core::Result<std::vector<double>> HsesVariables::read_reals(int first, int count) {
  return read_many<double>(kHsesPluralR, first, count, "variables R",
                           [](HsesReader& in) { return static_cast<double>(in.f32()); });
}

core::Status HsesVariables::write_reals(int first, const std::vector<double>& values) {
  return write_many(kHsesPluralR, first, values.size(),
                    elements(values, [](HsesWriter& out, double v) { out.f32(real(v)); }), "variables R");
}

core::Result<std::string> HsesVariables::read_string(int number) {
  auto text = session_.read(hses_get(kHsesS32, instance(number), 1), "variable S", parse_hses_string);
  if (text || text.error().code != ErrorCode::refused) return text;
  return session_.read(hses_get(kHsesS16, instance(number), 1), "variable S", parse_hses_string);
}

core::Status HsesVariables::write_string(int number, const std::string& value) {
  const bool fits = value.size() <= kHsesShortString;
  return session_.tell(hses_set_one(fits ? kHsesS16 : kHsesS32, instance(number),
                                    hses_string(value, fits ? kHsesShortString : kHsesLongString)),
                       Repeat::yes, "variable S");
}

core::Result<std::vector<std::string>> HsesVariables::read_strings(int first, int count) {
  return read_many<std::string>(kHsesPluralS, first, count, "variables S",
                                [](HsesReader& in) { return in.text(kHsesShortString); });
}

core::Status HsesVariables::write_strings(int first, const std::vector<std::string>& values) {
  return write_many(
      kHsesPluralS, first, values.size(),
      elements(values, [](HsesWriter& out, const std::string& v) { out.bytes(hses_string(v, kHsesShortString)); }),
      "variables S");
}

core::Result<VariablePosition> HsesVariables::read_position(int number) {
  return session_.read(hses_get(kHsesP, instance(number)), "variable P",
                       [](HsesView payload) -> core::Result<VariablePosition> {
                         auto raw = parse_hses_position(payload);
                         if (!raw) return core::forward(raw);
                         return variable_position(*raw);
                       });
}

core::Status HsesVariables::write_position(int number, const VariablePosition& position) {
  return session_.tell(hses_set_all(kHsesP, instance(number), hses_payload(hses_position(position))), Repeat::yes,
                       "variable P");
}

core::Result<std::vector<HsesPosition>> HsesVariables::read_positions(int first, int count) {
  return read_many<HsesPosition>(kHsesPluralP, first, count, "variables P", position_words);
}

core::Status HsesVariables::write_positions(int first, const std::vector<HsesPosition>& positions) {
  return write_many(kHsesPluralP, first, positions.size(),
                    elements(positions, [](HsesWriter& out, const HsesPosition& p) { out.bytes(hses_payload(p)); }),
                    "variables P");
}

core::Result<HsesAxesPosition> HsesVariables::read_axes(Axes which, int number) {
  return session_.read(hses_get(base(which) ? kHsesBp : kHsesEx, instance(number)), "variable BP or EX",
                       parse_hses_axes_position);
}

core::Status HsesVariables::write_axes(Axes which, int number, const HsesAxesPosition& position) {
  return session_.tell(hses_set_all(base(which) ? kHsesBp : kHsesEx, instance(number), hses_payload(position)),
                       Repeat::yes, "variable BP or EX");
}

core::Result<std::vector<HsesAxesPosition>> HsesVariables::read_many_axes(Axes which, int first, int count) {
  return read_many<HsesAxesPosition>(base(which) ? kHsesPluralBp : kHsesPluralEx, first, count, "variables BP or EX",
                                     axes_words);
}

core::Status HsesVariables::write_many_axes(Axes which, int first, const std::vector<HsesAxesPosition>& positions) {
  return write_many(base(which) ? kHsesPluralBp : kHsesPluralEx, first, positions.size(),
                    elements(positions, [](HsesWriter& out, const HsesAxesPosition& p) { out.bytes(hses_payload(p)); }),
                    "variables BP or EX");
}

core::Result<std::uint16_t> HsesVariables::read_register(int number) {
  return session_.read(hses_get(kHsesRegister, instance(number), 1), "register",
                       [](HsesView payload) -> core::Result<std::uint16_t> {
                         if (payload.size() != 2 && payload.size() != 4) return odd_size("register");
                         return HsesReader(payload).u16();
                       });
}

core::Status HsesVariables::write_register(int number, std::uint16_t value) {
  return session_.tell(hses_set_one(kHsesRegister, instance(number), HsesWriter().u16(value).take()), Repeat::yes,
                       "register");
}

core::Result<std::vector<std::uint16_t>> HsesVariables::read_registers(int first, int count) {
  return read_many<std::uint16_t>(kHsesPluralRegister, first, count, "registers",
                                  [](HsesReader& in) { return in.u16(); });
}

core::Status HsesVariables::write_registers(int first, const std::vector<std::uint16_t>& values) {
  return write_many(kHsesPluralRegister, first, values.size(),
                    elements(values, [](HsesWriter& out, std::uint16_t v) { out.u16(v); }), "registers");
}

core::Result<std::uint8_t> HsesVariables::read_group(int group) {
  return session_.read(hses_get(kHsesIo, instance(group), 1), "contacts",
                       [](HsesView payload) -> core::Result<std::uint8_t> {
                         if (payload.size() != 1 && payload.size() != 4) return odd_size("contacts");
                         return payload[0];
                       });
}

core::Status HsesVariables::write_group(int group, std::uint8_t value) {
  return session_.tell(hses_set_one(kHsesIo, instance(group), {value}), Repeat::yes, "contacts");
}

core::Result<std::vector<std::uint8_t>> HsesVariables::read_groups(int first, int count) {
  return read_many<std::uint8_t>(kHsesPluralIo, first, count, "contacts", [](HsesReader& in) { return in.u8(); });
}

core::Status HsesVariables::write_groups(int first, const std::vector<std::uint8_t>& values) {
  return write_many(kHsesPluralIo, first, values.size(), values, "contacts");
}

}  // namespace pickcell::robot
