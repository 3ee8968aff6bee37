#include "pickcell/sim/noise.hpp"

namespace pickcell::sim {

namespace {

double lattice(std::int64_t x, std::int64_t y, std::uint64_t seed) {
  std::uint64_t h = seed ^ (static_cast<std::uint64_t>(x) * 0x9e3779b97f4a7c15ULL) ^
                    (static_cast<std::uint64_t>(y) * 0xc2b2ae3d27d4eb4fULL);
  h = (h ^ (h >> 32)) * 0xbf58476d1ce4e5b9ULL;
  return static_cast<double>((h ^ (h >> 29)) >> 11) * 0x1.0p-52 - 1;
}

double ease(double t) { return t * t * (3 - 2 * t); }
double mixed(double a, double b, double t) { return a + (b - a) * t; }  // std::lerp is a slow call here

/// std::floor is a call into the library on a plain x86-64; this is called a hundred million times.
std::int64_t floor_of(double x) {
  const auto truncated = static_cast<std::int64_t>(x);
  return truncated - (static_cast<double>(truncated) > x ? 1 : 0);
}

}  // namespace

double value_noise(double x, double y, std::uint64_t seed) {
  const std::int64_t ix = floor_of(x), iy = floor_of(y);
  const double u = ease(x - static_cast<double>(ix)), v = ease(y - static_cast<double>(iy));
  const double top = mixed(lattice(ix, iy, seed), lattice(ix + 1, iy, seed), u);
  const double bottom = mixed(lattice(ix, iy + 1, seed), lattice(ix + 1, iy + 1, seed), u);
  return mixed(top, bottom, v);
}

double fractal_noise(double x, double y, int octaves, std::uint64_t seed) {
  double sum = 0, weight = 0.5;
  for (int i = 0; i < octaves; ++i) {
    sum += weight * value_noise(x, y, seed + static_cast<std::uint64_t>(i));
    x *= 2;
    y *= 2;
    weight *= 0.5;
  }
  return sum;
}

}  // namespace pickcell::sim
