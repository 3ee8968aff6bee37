#pragma once
/// What parts lie on: procedural materials of tables and belts.

#include <cstdint>

#include "pickcell/image/image.hpp"

namespace pickcell::sim {

enum class Surface { plastic, wood, belt, metal, cloth };
constexpr int kSurfaces = 5;
[[nodiscard]] const char* name(Surface surface);

/// A piece of a surface as a raster, continued by mirroring. Immutable after construction; thread-safe.
class SurfaceTexture {
 public:
  SurfaceTexture(Surface surface, std::uint64_t seed, double w_mm, double h_mm, double px_per_mm = 3);
  /// Albedo 0..1, bilinear.
  [[nodiscard]] float sample(double x_mm, double y_mm) const;

 private:
  double px_per_mm_;
  image::Plane<float> albedo_;
};

}  // namespace pickcell::sim
