#include "pickcell/sim/surface.hpp"

#include <algorithm>
#include <cmath>

#include "pickcell/core/units.hpp"
#include "pickcell/sim/noise.hpp"
#include "pickcell/sim/random.hpp"

namespace pickcell::sim {

namespace {

double plastic(double x, double y, std::uint64_t seed) {
  return 0.40 + 0.03 * fractal_noise(x * 0.02, y * 0.02, 2, seed) +
         0.025 * fractal_noise(x * 1.3, y * 1.3, 2, seed + 7);
}

double wood(double x, double y, std::uint64_t seed) {
  const double plank = std::floor(y / 62.0);
  const auto s = seed + static_cast<std::uint64_t>(plank + 1000) * 31;
  const double ring = y * 0.16 + 2.2 * fractal_noise(x * 0.012, y * 0.05, 2, s);
  const double grain = 0.5 + 0.5 * std::sin(2 * core::kPi * ring);
  const double gap = std::abs(y - 62.0 * std::round(y / 62.0)) < 0.5 ? 0.4 : 1.0;
  return gap * (0.52 + 0.03 * value_noise(plank, 0.5, seed) + 0.09 * grain * grain * grain +
                0.08 * fractal_noise(x * 0.09, y * 1.6, 3, s + 5));
}

double belt(double x, double y, std::uint64_t seed) {
  const double weave = std::sin(2 * core::kPi * x / 1.9) * std::sin(2 * core::kPi * y / 1.9);
  return 0.20 + 0.018 * weave + 0.03 * fractal_noise(x * 0.015, y * 0.05, 3, seed) +
         0.03 * fractal_noise(x * 0.05, y * 0.9, 2, seed + 9) + 0.02 * value_noise(x * 1.7, y * 1.7, seed + 3);
}

double metal(double x, double y, std::uint64_t seed) {
  return 0.58 + 0.12 * fractal_noise(x * 0.03, y * 1.1, 3, seed) +
         0.08 * fractal_noise(x * 0.01, y * 0.012, 2, seed + 4);
}

double cloth(double x, double y, std::uint64_t seed) {
  const double bend = 0.4 * fractal_noise(x * 0.05, y * 0.05, 2, seed);
  const double warp = std::abs(std::sin(core::kPi * (x + bend) / 1.4)),
               weft = std::abs(std::sin(core::kPi * (y - bend) / 1.4));
  return 0.70 + 0.07 * (warp * weft - 0.4) + 0.08 * fractal_noise(x * 0.018, y * 0.018, 2, seed + 11) +
         0.03 * value_noise(x * 2, y * 2, seed + 2);
}

double albedo_of(Surface surface, double x, double y, std::uint64_t seed) {
  switch (surface) {
    case Surface::plastic:
      return plastic(x, y, seed);
    case Surface::wood:
      return wood(x, y, seed);
    case Surface::belt:
      return belt(x, y, seed);
    case Surface::metal:
      return metal(x, y, seed);
    case Surface::cloth:
      return cloth(x, y, seed);
  }
  return 0;
}

/// Scratches and stains: what a surface in use has.
void wear(image::Plane<float>& albedo, double px_per_mm, std::uint64_t seed) {
  Random random(seed);
  const int scratches = 2 + albedo.width() * albedo.height() / 60000;
  for (int i = 0; i < scratches; ++i) {
    double x = random.uniform(0, albedo.width()), y = random.uniform(0, albedo.height());
    double heading = random.uniform(0, 2 * core::kPi);
    const double change = random.uniform(-0.045, 0.06);
    const int length = static_cast<int>(px_per_mm * random.uniform(8, 45));
    for (int k = 0; k < length; ++k) {
      heading += 0.02 * random.normal();
      x += std::cos(heading), y += std::sin(heading);
      if (x < 0 || y < 0 || x >= albedo.width() - 1 || y >= albedo.height() - 1) break;
      albedo.at(static_cast<int>(x), static_cast<int>(y)) += static_cast<float>(change);
    }
  }
}

/// The index that mirroring folds back into 0..n-1, as a real number.
double folded(double u, int n) {
  const double period = 2.0 * (n - 1);
  const double turns = u / period;
  auto whole = static_cast<std::int64_t>(turns);  // rounded down below: std::floor is a slow call here
  whole -= static_cast<double>(whole) > turns ? 1 : 0;
  const double m = u - period * static_cast<double>(whole);
  return m <= n - 1 ? m : period - m;
}

}  // namespace

const char* name(Surface surface) {
  constexpr const char* kNames[kSurfaces] = {"plastic", "wood", "belt", "metal", "cloth"};
  return kNames[static_cast<int>(surface)];
}

SurfaceTexture::SurfaceTexture(Surface surface, std::uint64_t seed, double w_mm, double h_mm, double px_per_mm)
    : px_per_mm_(px_per_mm),
      albedo_(std::max(2, static_cast<int>(w_mm * px_per_mm)), std::max(2, static_cast<int>(h_mm * px_per_mm))) {
  for (int y = 0; y < albedo_.height(); ++y)
    for (int x = 0; x < albedo_.width(); ++x)
      albedo_.at(x, y) = static_cast<float>(albedo_of(surface, x / px_per_mm, y / px_per_mm, seed));
  wear(albedo_, px_per_mm, seed + 1);
}

float SurfaceTexture::sample(double x_mm, double y_mm) const {
  const double u = folded(x_mm * px_per_mm_, albedo_.width()), v = folded(y_mm * px_per_mm_, albedo_.height());
  const int x = std::min(static_cast<int>(u), albedo_.width() - 2),
            y = std::min(static_cast<int>(v), albedo_.height() - 2);
  const auto fu = static_cast<float>(u - x), fv = static_cast<float>(v - y);
  const float *a = albedo_.row(y) + x, *b = albedo_.row(y + 1) + x;
  return (1 - fv) * ((1 - fu) * a[0] + fu * a[1]) + fv * ((1 - fu) * b[0] + fu * b[1]);
}

}  // namespace pickcell::sim
