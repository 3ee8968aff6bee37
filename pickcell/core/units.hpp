#pragma once
/// Inside the program lengths are metres, angles radians, times seconds. Everything else carries its unit in the name
/// and is converted here, at the edges.

#include <cmath>
#include <numbers>

namespace pickcell::core {

constexpr double kPi = std::numbers::pi;

constexpr double rad_from_deg(double deg) { return deg * (kPi / 180.0); }
constexpr double deg_from_rad(double rad) { return rad * (180.0 / kPi); }
constexpr double m_from_mm(double mm) { return mm * 1e-3; }
constexpr double mm_from_m(double m) { return m * 1e3; }

/// The same angle in (-180, 180].
inline double wrap_deg(double deg) {
  const double turned = std::remainder(deg, 360.0);
  return turned <= -180.0 ? turned + 360.0 : turned;
}

/// The same angle in (-pi, pi].
inline double wrap_rad(double rad) {
  const double turned = std::remainder(rad, 2 * kPi);
  return turned <= -kPi ? turned + 2 * kPi : turned;
}

}  // namespace pickcell::core
