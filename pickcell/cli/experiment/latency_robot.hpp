#pragma once
/// For `pickcell experiment latency`: how long it takes from the submission of a pick to the arm's first motion, over
/// loopback, with the real driver, a journal on the disk and the real job.

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "pickcell/cli/experiment/experiment.hpp"
#include "pickcell/cli/robot/link.hpp"
#include "pickcell/core/json.hpp"
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

/// Over both protocols: options.n picks each (50). Writes latency_robot.csv; gives for "tcp80" and "hses" {"picks",
/// "submit_median_ms","submit_p99_ms","median_ms","p99_ms","worst_ms"}, the last three until the arm moves.
[[nodiscard]] core::Result<core::Json> measure_robot_latencies(const ExperimentOptions& options);
/// The same for people, a line per protocol.
[[nodiscard]] std::string robot_latency_words(const core::Json& latencies);

/// Of sorted values; 0 when there are none.
[[nodiscard]] double latency_at(const std::vector<double>& sorted_ms, double share);

}  // namespace pickcell::cli
