#include "pickcell/picks/place_pattern.hpp"

#include <stdexcept>

namespace pickcell::picks {

core::Transform<core::Base, core::Part> PlacePattern::slot(int slot) const {
  if (slot < 0 || slot >= size()) throw std::out_of_range("place slot outside the pattern");
  const Eigen::Matrix3d R = core::rotation_z(angle_rad);
  const Eigen::Vector3d offset((slot % cols) * pitch_x_m, (slot / cols) * pitch_y_m, 0);
  return {R, origin_m + R * offset};
}

}  // namespace pickcell::picks
