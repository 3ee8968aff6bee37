#pragma once
/// `pickcell robot LINK status`: the controller in words, how fast it answers, what is missing for picks.

#include <optional>
#include <string>
#include <vector>

#include "pickcell/core/json.hpp"
#include "pickcell/core/result.hpp"
#include "pickcell/robot/controller_link.hpp"

namespace pickcell::cli {

struct RobotReport {
  std::string peer, identity;
  robot::RobotState state;
  std::vector<robot::Alarm> alarms;
  robot::CurrentJob job;
  std::optional<robot::CartesianPosition> in_base;   ///< empty where the protocol cannot tell
  std::optional<robot::CartesianPosition> in_frame;  ///< the asked-for frame, where the protocol knows it
  std::vector<std::int32_t> pulses;
  std::vector<double> answer_ms;            ///< of each status read, sorted
  std::vector<std::string> missing, to_do;  ///< what keeps picks from starting, and the remedy of each
};

/// Reads only; what the protocol does not have, or this controller refuses, is left out and named: only a lost link is
/// an error. `frame`: besides the base frame; 0: none. `job`: that picks
/// need. `reads`: of the status, timed.
[[nodiscard]] core::Result<RobotReport> read_report(robot::ControllerLink& link, int frame, const std::string& job,
                                                    int reads);
[[nodiscard]] core::Json report_json(const RobotReport& report);
[[nodiscard]] std::string report_words(const RobotReport& report);

}  // namespace pickcell::cli
