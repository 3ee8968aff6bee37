#pragma once
/// MotoROS results and subcodes in words. Source: docs/yaskawa-protocols.md 3.1.

#include <cstdint>
#include <string>

namespace pickcell::robot {

struct MotoFault {
  std::string meaning;  ///< "not ready (5006): servo power is off"
  std::string remedy;
};

/// For a reply that is not success. Thread-safe.
[[nodiscard]] MotoFault moto_fault(std::int32_t result, std::int32_t subcode);
/// For an I/O result other than 0.
[[nodiscard]] MotoFault moto_io_fault(std::int32_t result);

}  // namespace pickcell::robot
