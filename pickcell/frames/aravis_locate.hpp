#pragma once
/// Which camera is meant by a name, and is it free?

#include <cstdint>
#include <optional>
#include <string>

#include "pickcell/core/result.hpp"

namespace pickcell::frames {

struct Located {
  std::string open_name;                      ///< what Aravis opens without searching
  std::optional<std::uint32_t> gige_address;  ///< unset for USB3 Vision
  std::string shown;                          ///< for messages: "GV01 at 127.0.0.1"
};

/// As connect_aravis; also refuses a GigE Vision camera that is held. About a second at most.
[[nodiscard]] core::Result<Located> locate_aravis(const std::string& name);

}  // namespace pickcell::frames
