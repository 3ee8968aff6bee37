#pragma once
/// Pictures with exactly known poses for the experiments on the matcher: a smooth part defined at every real place,
/// drawn by area sampling. Independent of the matcher's own interpolation.

#include <cstdint>
#include <random>
#include <vector>

#include "pickcell/image/image.hpp"
#include "pickcell/matches/match.hpp"
#include "pickcell/matches/model.hpp"

namespace pickcell::cli {

/// A square part covered with blobs and bars (3 to 12 px), bright and dark, on a ground of other blobs.
class BlobScene {
 public:
  BlobScene(int part_side_px, int width, int height, std::uint64_t seed);

  /// The part at scale 1, angle 0, with its reference point at its centre; searched at all angles, scales 0.9 to 1.1.
  [[nodiscard]] matches::Model model() const;
  /// The ground with the part at the pose. 6 x 6 samples per pixel.
  [[nodiscard]] image::Plane<float> draw(const matches::Pose2d& pose) const;
  /// What a camera would deliver: noise of this standard deviation added, rounded to bytes.
  [[nodiscard]] static image::Image expose(const image::Plane<float>& light, double noise_grey, std::mt19937_64& rng);

 private:
  struct Blob {
    double x, y, cos, sin, long_px, wide_px, height;
  };
  static std::vector<Blob> blobs(int count, double width, double height, std::mt19937_64& rng);
  static double grey(const std::vector<Blob>& blobs, double x, double y);

  int side_;
  std::vector<Blob> part_;
  image::Plane<float> ground_;
};

}  // namespace pickcell::cli
