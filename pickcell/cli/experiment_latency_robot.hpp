#pragma once
/// For `pickcell experiment latency`: how long it takes from the submission of a pick to the arm's first motion, over
/// loopback, with the real driver, a journal on the disk and the real job.

#include <cstdint>
#include <filesystem>
#include <vector>

#include "pickcell/cli/robot_link.hpp"
#include "pickcell/core/result.hpp"

namespace pickcell::cli {

struct RobotLatency {
  RobotProtocol protocol = RobotProtocol::tcp80;
  std::vector<double> submit_ms;     ///< the call of submit(): intent durable, variables written and read back; sorted
  std::vector<double> to_motion_ms;  ///< from its begin until the arm has left its place; sorted
};

/// `picks` picks over tcp80 or hses in real time, after one that is not counted. The job polls its flag every 20 ms and
/// the simulated controller lives in ticks of 10 ms: that is in the figure. `folder`: for the journal; must exist.
[[nodiscard]] core::Result<RobotLatency> measure_robot_latency(RobotProtocol protocol, int picks,
                                                               const std::filesystem::path& folder);

/// Of sorted values; 0 when there are none.
[[nodiscard]] double latency_at(const std::vector<double>& sorted_ms, double share);

}  // namespace pickcell::cli
