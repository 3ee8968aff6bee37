#pragma once
/// One order to the arm: take it there, put it here.

#include <cstdint>
#include <string>

#include "pickcell/core/transform.hpp"

namespace pickcell::picks {

struct Pick {
  std::uint64_t detection_id = 0;
  std::string model;
  int part_class = 0;  ///< recipe number sent to the robot's job
  core::Transform<core::Base, core::Tool> T_base_grasp;
  core::Transform<core::Base, core::Tool> T_base_place;
  int place_slot = 0;  ///< index in the place pattern
};

}  // namespace pickcell::picks
