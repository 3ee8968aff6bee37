#pragma once
/// Smooth noise in the plane, for materials: the same for a seed wherever and in whatever order it is asked for.

#include <cstdint>

namespace pickcell::sim {

/// Value noise in [-1, 1] with cells of size 1, smooth between them.
[[nodiscard]] double value_noise(double x, double y, std::uint64_t seed);

/// Sum of octaves of value noise, each of half the size and strength; about [-1, 1].
[[nodiscard]] double fractal_noise(double x, double y, int octaves, std::uint64_t seed);

}  // namespace pickcell::sim
