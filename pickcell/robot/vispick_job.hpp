#pragma once
/// The controller's half of the hand-over as an INFORM job, for the variables, contacts and window of a cell.
/// docs/inform/VISPICK.JBI is the one for the defaults. Source: docs/yaskawa-protocols.md 4.1 and 4.2.

#include <array>
#include <string>

namespace pickcell::robot {

struct VispickSettings {
  std::string name = "VISPICK";  ///< at most 32 characters, upper case letters, digits, _ and -
  int first_variable = 10;       ///< B, I, D and P variables from here to 13 further are the job's
  int tool = 1;
  int gripper_output = 1;                         ///< OT#(n): on closes
  int grip_sensor_input = 1;                      ///< IN#(n): on when something is in the gripper
  std::array<double, 3> home_mm = {300, 0, 250};  ///< base frame, tool straight down: clear of the camera; P000
  std::array<double, 3> window_min_mm = {100, -550, -320};  ///< of grasp and place
  std::array<double, 3> window_max_mm = {750, 550, 430};    ///< z: with the approach
  double approach_mm = 80;                                  ///< straight above grasp and place
  double home_pct = 20;                                     ///< to the home position, of the joints' speed
  double travel_pct = 30;                                   ///< to above the grasp, of the joints' speed
  double travel_mm_s = 300;
  double final_mm_s = 100;  ///< the last piece down
};

/// The job's text with CRLF line ends, as a controller wants it. Settings that cannot be throw std::invalid_argument.
[[nodiscard]] std::string vispick_job(const VispickSettings& settings);

}  // namespace pickcell::robot
