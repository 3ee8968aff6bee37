#pragma once
/// Experiment table3's question about SP6: does a long part in a square template take longer where the ground lets more
/// candidates through?

#include <cstdint>
#include <string>
#include <vector>

#include "pickcell/cli/experiment/paper_sample.hpp"
#include "pickcell/core/result.hpp"
#include "pickcell/sim/surface.hpp"

namespace pickcell::cli {

/// One sample on one ground: taught on one piece of it, searched by `rst` on another, pictures of 752 x 580.
struct GroundOutcome {
  sim::Surface ground = sim::Surface::belt;
  std::size_t sample = 0;          ///< place in kSamples
  double search_ms = 0;            ///< CPU time, one thread, everything prepared; the median of the pictures
  std::vector<double> candidates;  ///< into steps 2, 3 and 4, the mean of the pictures
  int found = 0, pictures = 0;     ///< centre within 10 % of the shorter side
};

/// Every sample on every ground, in the order of the grounds.
[[nodiscard]] core::Result<std::vector<GroundOutcome>> search_on_grounds(std::size_t samples, std::uint64_t seed);

/// In Markdown: SP6 beside the mean of all samples, by ground.
[[nodiscard]] std::string ground_table(const std::vector<GroundOutcome>& all);

}  // namespace pickcell::cli
