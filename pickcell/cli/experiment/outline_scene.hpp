#pragma once
/// Pictures with exactly known poses of parts that end inside the template, on grounds that are not the taught one:
/// what a cell sees on an unknown belt. Independent of the matcher's own interpolation.

#include <array>
#include <cstdint>
#include <random>
#include <vector>

#include "pickcell/image/image.hpp"
#include "pickcell/matches/match.hpp"
#include "pickcell/matches/model.hpp"

namespace pickcell::cli {

enum class OutlineKind { flat, plain, marked, textured, thin, gear, bracket };
constexpr int kOutlineKinds = 7;
[[nodiscard]] const char* name(OutlineKind kind);

/// What lies under the part.
struct Ground {
  double grey = 128;
  double texture_grey = 0;  ///< height of its blobs
};

/// One part, its inside and its outline taken from a seed, and a picture of noise-free light around it.
class OutlineScene {
 public:
  static constexpr int kWidth = 224, kHeight = 208;

  /// side_px: of the part's longer side at scale 1.
  OutlineScene(OutlineKind kind, int side_px, std::uint64_t seed);

  /// Taught at scale 1 with a mask whose edge lies outside_px outside the part's outline (inside when negative); the
  /// reference point is near its centre; searched at all angles, scales 0.9 to 1.1.
  [[nodiscard]] matches::Model model(const Ground& ground, double outside_px) const;
  /// 4 x 4 samples per pixel, blurred as by a lens (kBlur_px) before they are averaged.
  [[nodiscard]] image::Plane<float> draw(const matches::Pose2d& pose, const Ground& ground) const;

 private:
  static constexpr double kBlur_px = 0.5;
  [[nodiscard]] image::Plane<float> draw(const matches::Pose2d& pose, const Ground& ground,
                                         const image::Plane<float>& texture, int width, int height) const;
  [[nodiscard]] double distance_px(double x, double y) const;

  int side_;
  image::Plane<float> distance_;                ///< signed, of the outline: template pixels; fine raster
  image::Plane<float> inside_;                  ///< grey values of the part; the same raster
  std::array<image::Plane<float>, 2> grounds_;  ///< heights of blobs, -1 to 1: taught on, found on; fine rasters
};

}  // namespace pickcell::cli
