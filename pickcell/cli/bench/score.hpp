#pragma once
/// What counts as found (docs/interfaces.md, bench): correct, strict, and which match belongs to which true pose.

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "pickcell/cli/bench/dataset.hpp"
#include "pickcell/matches/match.hpp"

namespace pickcell::cli {

/// Distance of a found pose from the true one; all parts >= 0.
struct PoseError {
  double position_px = 0;
  double angle_deg = 0;  ///< modulo the template's symmetry
  double scale_pct = 0;  ///< of the true scale
};

[[nodiscard]] PoseError pose_error(const matches::Pose2d& found, const TruthPose& truth, double symmetry_deg = 360);

/// Centre within max(3 px, 3 % of the template's diagonal), angle within 3 deg, scale within 5 %.
[[nodiscard]] bool is_correct(const PoseError& error, double diagonal_px);
/// Correct, and within 1 px and 1 deg.
[[nodiscard]] bool is_strict(const PoseError& error, double diagonal_px);

/// The paper's kind of finding: centre within 10 % of the template's shorter side, angle within 10 deg, any scale.
[[nodiscard]] bool is_loose(const PoseError& error, double shorter_side_px);

/// One match that found a true pose.
struct Hit {
  std::size_t match = 0;
  std::size_t truth = 0;
  PoseError error;
};

/// The outcome of one picture.
struct ImageScore {
  std::vector<Hit> hits;  ///< each match and each truth at most once
  std::size_t truths = 0;
  std::size_t matches = 0;
  bool correct = false;  ///< every truth is found and nothing else is reported
  bool strict = false;   ///< and every hit is strict
  std::string why;       ///< why not correct; empty otherwise
};

/// One pose is asked for: the best match decides (found: what the engine returned with --max 1, no threshold).
[[nodiscard]] ImageScore score_one(std::span<const matches::Match> found, const TruthPose& truth, double diagonal_px,
                                   double symmetry_deg);

/// Any number of poses, also none: matches in the order of their score take the nearest true pose that is still free
/// and for which they are correct.
[[nodiscard]] ImageScore score_instances(std::span<const matches::Match> found, std::span<const TruthPose> truths,
                                         double diagonal_px, double symmetry_deg);

}  // namespace pickcell::cli
