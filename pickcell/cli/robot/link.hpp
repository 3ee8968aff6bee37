#pragma once
/// LINK on the command line and in CELL.toml: which protocol a robot is spoken to with. The one place that knows them.

#include <memory>
#include <string>

#include "pickcell/core/result.hpp"
#include "pickcell/robot/controller_link.hpp"

namespace pickcell::cli {

enum class RobotProtocol { tcp80, hses, motoros };

struct RobotAddress {
  RobotProtocol protocol = RobotProtocol::tcp80;
  std::string host;
  int port = 0;
  std::string model = {};  ///< motoros only: the arm, "" when it is not named
};

/// tcp80://HOST[:PORT] (80), hses://HOST[:PORT] (10040, files on the next one), motoros://HOST[:PORT][/MODEL] (50240,
/// state and I/O on the next two; MODEL gp7, gp8 or motomini: MotoROS tells joints only, poses and moves need it).
/// `where` stands in front of the error: a file's key or the command.
[[nodiscard]] core::Result<RobotAddress> parse_robot_link(const std::string& link, const std::string& where);

/// A client for the address, not connected yet. MotoROS knows no variables and no jobs: those calls are usage.
[[nodiscard]] core::Result<std::unique_ptr<robot::ControllerLink>> open_controller_link(const RobotAddress& address,
                                                                                        const std::string& where);

}  // namespace pickcell::cli
