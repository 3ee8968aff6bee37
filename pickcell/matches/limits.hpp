#pragma once
/// Ranges that make sense, the same for teaching, searching and model files.

#include <string>

#include "pickcell/core/result.hpp"
#include "pickcell/matches/model.hpp"

namespace pickcell::matches {

constexpr double kMinScale = 0.1;
constexpr double kMaxScale = 10;

/// Finite, lo <= hi, both within +-720 degrees, at most 360 wide. what: the option or field, for the error.
[[nodiscard]] core::Status check_angle_range(const std::string& what, Range deg);
/// Finite, lo <= hi, within kMinScale..kMaxScale.
[[nodiscard]] core::Status check_scale_range(const std::string& what, Range scale);

/// How far beyond the asked-for range an answer may lie. A range of a single value says how the part is meant to lie:
/// tilt and lens move it a little.
constexpr double kAngleTolerance_deg = 0.5, kFixedAngleTolerance_deg = 2;
constexpr double kScaleTolerance = 0.005, kFixedScaleTolerance = 0.02;  ///< of the scale

/// Whether an answer may have this angle (degrees), this scale.
[[nodiscard]] bool angle_answers(double angle_deg, Range range);
[[nodiscard]] bool scale_answers(double scale, Range range);
/// Blur takes a scale further than noise a turn: so far beyond its range (of the scale) a find may still be one in it.
constexpr double kMostGrowthHeld = 0.025;
/// The nearest angle (degrees), scale, that an answer may have.
[[nodiscard]] double nearest_angle(double angle_deg, Range range);
[[nodiscard]] double nearest_scale(double scale, Range range);
/// Whether a find may become an answer, at its place or held within its ranges. Degrees.
[[nodiscard]] bool may_answer(double angle_deg, Range angles_deg, double scale, Range scales);

/// Whether the angle lies in the range, which may cross 180, widened by slack at both ends. Degrees.
[[nodiscard]] bool angle_in_range(double angle_deg, Range range, double slack_deg);

}  // namespace pickcell::matches
