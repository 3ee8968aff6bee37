#include "pickcell/sim/job_values.hpp"

#include <cmath>
#include <limits>

namespace pickcell::sim::job_values {

namespace {

using Kind = Operand::Kind;

template <class Array>
std::optional<double> at(const Array& values, int index) {
  if (index < 0 || static_cast<std::size_t>(index) >= values.size()) return std::nullopt;
  return static_cast<double>(values[static_cast<std::size_t>(index)]);
}

template <class Array>
bool put(Array& values, int index, double v) {
  using Number = typename Array::value_type;
  if (index < 0 || static_cast<std::size_t>(index) >= values.size()) return false;
  if constexpr (std::numeric_limits<Number>::is_integer) v = std::round(v);
  if (!(v >= static_cast<double>(std::numeric_limits<Number>::lowest()) &&
        v <= static_cast<double>(std::numeric_limits<Number>::max())))
    return false;
  values[static_cast<std::size_t>(index)] = static_cast<Number>(v);
  return true;
}

bool compare(double left, Compare how, double right) {
  switch (how) {
    case Compare::equal:
      return left == right;
    case Compare::not_equal:
      return left != right;
    case Compare::less:
      return left < right;
    case Compare::greater:
      return left > right;
    case Compare::less_equal:
      return left <= right;
    case Compare::greater_equal:
      return left >= right;
  }
  return false;
}

}  // namespace

std::optional<double> value(const ControllerState& s, const Operand& o) {
  switch (o.kind) {
    case Kind::number:
      return o.number;
    case Kind::B:
      return at(s.B, o.index);
    case Kind::I:
      return at(s.I, o.index);
    case Kind::D:
      return at(s.D, o.index);
    case Kind::R:
      return at(s.R, o.index);
    case Kind::IN:
      return at(s.inputs, o.index);
    case Kind::OT:
      return at(s.outputs, o.index);
    default:
      return std::nullopt;
  }
}

bool assign(ControllerState& s, const Operand& o, double v) {
  switch (o.kind) {
    case Kind::B:
      return put(s.B, o.index, v);
    case Kind::I:
      return put(s.I, o.index, v);
    case Kind::D:
      return put(s.D, o.index, v);
    case Kind::R:
      return put(s.R, o.index, v);
    default:
      return false;
  }
}

std::optional<bool> holds(const ControllerState& s, const Condition& condition) {
  bool result = !condition.any;
  for (const Condition::Term& term : condition.terms) {
    const auto left = value(s, term.left), right = value(s, term.right);
    if (!left || !right) return std::nullopt;
    const bool one = compare(*left, term.compare, *right);
    result = condition.any ? result || one : result && one;
  }
  return result;
}

}  // namespace pickcell::sim::job_values
