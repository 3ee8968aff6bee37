#pragma once
/// What `pickcell robot LINK read|write` names: B010, I010, D010, R003, S010, P010, M100, contact 27010.

#include <optional>
#include <string>

#include "pickcell/core/json.hpp"
#include "pickcell/core/result.hpp"
#include "pickcell/robot/controller_link.hpp"

namespace pickcell::cli {

struct RobotName {
  enum class Kind { integer, real, string, position, reg, contact };
  Kind kind = Kind::integer;
  robot::VariableType type = robot::VariableType::byte;  ///< of an integer
  int number = 0;
  std::string text;  ///< as a person writes it: B010, 27010
};

/// Errors: usage.
[[nodiscard]] core::Result<RobotName> parse_robot_name(const std::string& word);

/// The value as JSON: a number; a string text; a contact true or false; a position an object with unit names.
[[nodiscard]] core::Result<core::Json> read_robot_value(robot::ControllerLink& link, const RobotName& name);
/// `value` as text: a number, at most 32 bytes for a string, 0 or 1, or x,y,z,rx,ry,rz[,tool[,frame]] in mm and
/// degrees. Out of range: usage.
[[nodiscard]] core::Status write_robot_value(robot::ControllerLink& link, const RobotName& name,
                                             const std::string& value);

/// x_mm, y_mm, z_mm, rx_deg, ry_deg, rz_deg, frame, tool, and form where it is not 0.
[[nodiscard]] core::Json position_json(const robot::CartesianPosition& position);

}  // namespace pickcell::cli
