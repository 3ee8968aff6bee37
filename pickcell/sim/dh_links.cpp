#include "pickcell/sim/dh_links.hpp"

#include "pickcell/core/units.hpp"

namespace pickcell::sim {

std::array<DhLink, 6> dh_links(const Arm& arm) {
  constexpr double kQuarter = core::kPi / 2;
  return {{{0, 0, arm.s_to_l_m, -kQuarter},
           {-kQuarter, 0, arm.l_to_u_m, core::kPi},
           {0, 0, arm.u_to_b_z_m, -kQuarter},
           {0, -arm.u_to_b_x_m, 0, kQuarter},
           {arm.b_zero_rad, 0, 0, -kQuarter},
           {0, -arm.b_to_flange_m, 0, core::kPi}}};
}

}  // namespace pickcell::sim
