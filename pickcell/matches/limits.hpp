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

/// Whether the angle lies in the range, which may cross 180, widened by slack at both ends. Degrees.
[[nodiscard]] bool angle_in_range(double angle_deg, Range range, double slack_deg);

}  // namespace pickcell::matches
