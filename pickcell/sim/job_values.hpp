#pragma once
/// Reading and writing what an instruction names: variables, contacts, constants.

#include <optional>

#include "pickcell/sim/controller_state.hpp"

namespace pickcell::sim::job_values {

/// A number; empty when there is no such variable or contact.
[[nodiscard]] std::optional<double> value(const ControllerState& state, const Operand& operand);
/// Rounded for B, I and D. False when there is no such variable or the value does not fit.
[[nodiscard]] bool assign(ControllerState& state, const Operand& operand, double value);
/// Empty when a variable in it does not exist.
[[nodiscard]] std::optional<bool> holds(const ControllerState& state, const Condition& condition);

}  // namespace pickcell::sim::job_values
