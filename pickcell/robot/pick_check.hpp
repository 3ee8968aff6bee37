#pragma once
/// The last check before a pick leaves for the controller.

#include <array>

#include "pickcell/core/result.hpp"
#include "pickcell/picks/pick.hpp"

namespace pickcell::robot {

/// Limits in the frame that the poses are in.
struct PickLimits {
  std::array<double, 3> box_min_mm{}, box_max_mm{};  ///< tool centre point, grasp, place and the approach above them
  double approach_mm = 80;                           ///< the job comes from straight above
  double max_tilt_deg = 15;                          ///< of the tool's axis against straight down
};

/// safety: a pose that is not finite, no rotation, tilted too far or outside the box; names the pose, the value and the
/// limit. usage: a part class the controller cannot hold.
[[nodiscard]] core::Status check_pick(const picks::Pick& pick, const PickLimits& limits);

}  // namespace pickcell::robot
