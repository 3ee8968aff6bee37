#pragma once
/// Variables, registers and contacts as the High Speed Ethernet Server reads and writes them: one element as bytes,
/// many elements one after the other.

#include <cstdint>
#include <optional>
#include <variant>

#include "pickcell/robot/hses_codec.hpp"
#include "pickcell/sim/controller_state.hpp"

namespace pickcell::sim::hses_elements {

/// Added status of a refusal, 0 when there is none.
using Refused = std::uint16_t;
constexpr Refused kBadCommand = 0xA000, kBadInstance = 0xA001, kBadAttribute = 0xA002, kBadLength = 0x1013,
                  kBadValue = 0x1012, kUndefined = 0xB001, kBadType = 0xB007, kBadForm = 0xB00C, kBadTool = 0xB00D,
                  kBadUserFrame = 0xB00E;

/// The element's bytes, or why not. `command`: 0x78-0x81 or 0x8C.
[[nodiscard]] std::variant<robot::HsesBytes, Refused> read(const ControllerState& state, std::uint16_t command,
                                                           int instance);
/// 0 when written.
[[nodiscard]] Refused write(ControllerState& state, std::uint16_t command, int instance, robot::HsesView payload);
/// 0x300-0x309 as the command of one such element; 0 when it is none.
[[nodiscard]] std::uint16_t element_of(std::uint16_t plural_command);
/// True for 0x78-0x81 and 0x8C.
[[nodiscard]] bool is_element(std::uint16_t command);

/// Positions between the two ways to write them. Form bits 0 and 2 change places.
[[nodiscard]] robot::HsesPosition position_words(const Position& position);
[[nodiscard]] std::variant<Position, Refused> position_from(const ControllerState& state,
                                                            const robot::HsesPosition& words);

}  // namespace pickcell::sim::hses_elements
