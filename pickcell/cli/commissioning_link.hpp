#pragma once
/// LINK of `pickcell robot`: every protocol, also the one that a cell cannot pick with.

#include <memory>
#include <string>

#include "pickcell/core/result.hpp"
#include "pickcell/robot/controller_link.hpp"

namespace pickcell::cli {

/// As parse_robot_link and open_controller_link; beyond them motoros://HOST[:PORT][/MODEL], MODEL gp7, gp8 or motomini:
/// MotoROS tells joints only, so poses and moves need it. Errors: usage.
[[nodiscard]] core::Result<std::unique_ptr<robot::ControllerLink>> open_commissioning_link(const std::string& link,
                                                                                           const std::string& where);

}  // namespace pickcell::cli
