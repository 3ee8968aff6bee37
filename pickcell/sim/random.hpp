#pragma once
/// Numbers by chance that are the same on every machine and compiler: std::distributions are not.

#include <cmath>
#include <cstdint>

#include "pickcell/core/units.hpp"

namespace pickcell::sim {

/// One round of splitmix64: a good hash of 64 bits.
constexpr std::uint64_t mix(std::uint64_t z) {
  z += 0x9e3779b97f4a7c15ULL;
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ULL;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebULL;
  return z ^ (z >> 31);
}

/// A stream of numbers that follows from its seed.
class Random {
 public:
  explicit Random(std::uint64_t seed) : state_(mix(seed)) {}

  std::uint64_t bits() { return mix(state_++); }
  /// In [0, 1).
  double unit() { return static_cast<double>(bits() >> 11) * 0x1.0p-53; }
  double uniform(double lo, double hi) { return lo + (hi - lo) * unit(); }
  /// In lo..hi, both included.
  int integer(int lo, int hi) { return lo + static_cast<int>(bits() % static_cast<std::uint64_t>(hi - lo + 1)); }
  /// Mean 0, standard deviation 1 (Box and Muller).
  double normal() { return std::sqrt(-2 * std::log(1 - unit())) * std::cos(2 * core::kPi * unit()); }

 private:
  std::uint64_t state_;
};

}  // namespace pickcell::sim
