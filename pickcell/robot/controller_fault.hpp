#pragma once
/// The controller's four-digit refusals in words. TCP 80 writes the digits as text, HSES sends them as a 16-bit number:
/// 2060 in an ERROR line is added status 0x2060. Source: docs/yaskawa-protocols.md 2.7.

#include <cstdint>
#include <string_view>

namespace pickcell::robot {

struct ControllerFault {
  std::uint16_t code;  ///< the four digits read as hexadecimal
  std::string_view meaning;
  std::string_view remedy;  ///< may be empty
};

/// The words for a code; "unknown refusal" for one that is not in the table. Thread-safe.
[[nodiscard]] ControllerFault controller_fault(std::uint16_t code);

}  // namespace pickcell::robot
