#pragma once
/// Contacts by their numbers: group * 10 + bit (docs/yaskawa-protocols 2.5). Whole groups of eight are read and
/// written.

#include <cstdint>
#include <optional>

#include "pickcell/sim/controller_state.hpp"

namespace pickcell::sim {

/// Eight contacts; `group` is the contact number / 10. Empty: there is no such group on this controller.
[[nodiscard]] std::optional<std::uint8_t> read_group(const ControllerState& state, int group);
/// Only network inputs can be written; false otherwise. Changed contacts are noted as events for the plant.
[[nodiscard]] bool write_group(ControllerState& state, int group, std::uint8_t value);
/// DOUT: a general output, noted as event when it changes. n from 1.
void set_output(ControllerState& state, int n, bool on);

}  // namespace pickcell::sim
