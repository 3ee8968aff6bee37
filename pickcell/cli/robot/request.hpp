#pragma once
/// What `pickcell robot` was asked, and what its actions answer.

#include <optional>
#include <string>
#include <vector>

#include "pickcell/cli/robot/moves.hpp"
#include "pickcell/core/json.hpp"
#include "pickcell/core/result.hpp"
#include "pickcell/robot/controller_link.hpp"

namespace pickcell::cli {

struct RobotOptions {
  std::string link, action;
  std::vector<std::string> words;
  bool json = false;
  int frame = 0;
  int reads = 50;
  int history = 0;
  std::string job = "VISPICK", output, box;
  int home_variable = 0;
  bool line = false;
  std::optional<int> tool;
  MoveLimits limits;
};

/// What a request has found out: for programs, and for people.
struct RobotAnswer {
  core::Json json;
  std::string words;
  std::vector<core::Error> refused;  ///< parts that the controller refused; the rest is there
};

/// Straight, in the directions of the base frame: words are an axis and a distance.
[[nodiscard]] core::Result<RobotAnswer> jog(robot::ControllerLink& link, const RobotOptions& o);
/// To a place in the base frame, with the tool and form that the arm has.
[[nodiscard]] core::Result<RobotAnswer> go_to(robot::ControllerLink& link, const RobotOptions& o);
/// Joint move to a position variable.
[[nodiscard]] core::Result<RobotAnswer> home(robot::ControllerLink& link, const RobotOptions& o);

}  // namespace pickcell::cli
