#pragma once
/// The arms in the notation of Denavit and Hartenberg, as MotoROS tells them.

#include <array>

#include "pickcell/sim/arm.hpp"

namespace pickcell::sim {

/// Link i takes frame i-1 to frame i: Rz(theta + q) * Tz(d) * Tx(a) * Rx(alpha), frame 0 the base, frame 6 the flange.
struct DhLink {
  double theta_rad, d_m, a_m, alpha_rad;
};

/// S, L, U, R, B, T.
[[nodiscard]] std::array<DhLink, 6> dh_links(const Arm& arm);

}  // namespace pickcell::sim
