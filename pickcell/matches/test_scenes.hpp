#pragma once
/// Pictures with known truth for the tests of matches: synthetic textures, drawn at any pose with supersampling.

#include <cstdint>
#include <vector>

#include "pickcell/image/image.hpp"
#include "pickcell/matches/match.hpp"
#include "pickcell/matches/model.hpp"

namespace pickcell::matches::testing {

/// A smooth, unrepeated texture defined at every real place: blobs and bars on grey, kept as a fine raster (four
/// samples per pixel and direction) and read by interpolation.
class Texture {
 public:
  /// Features of 3 to 12 px spread over width x height and a little beyond.
  Texture(int width, int height, unsigned seed);
  [[nodiscard]] double at(double x, double y) const;

 private:
  void add_blob(double x, double y, double angle, double lengthy, double wide, double height);
  int columns_, rows_;
  std::vector<float> raster_;
};

/// The texture at scale 1: pixel (x, y) is its mean over the pixel.
[[nodiscard]] image::Image draw_template(const Texture& t, int width, int height);

/// A model of it with the reference point at the centre, searched at all angles and scales 0.9 to 1.1.
[[nodiscard]] Model texture_model(const Texture& t, int width, int height);

/// Another texture as ground.
[[nodiscard]] image::Image draw_ground(int width, int height, unsigned seed);

/// Draws the template's texture (and only where its mask is) over the scene so that the model's reference point lies at
/// the pose. 4 x 4 supersampling, borders mixed by coverage. shape: where the part is, in template pixels.
void draw_part(image::Image& scene, const Texture& t, const Model& model, const Pose2d& pose);

void add_noise(image::Image& picture, double sigma_grey, unsigned seed);

/// Differences of two poses.
[[nodiscard]] double distance_px(const Pose2d& a, const Pose2d& b);
[[nodiscard]] double turn_deg(const Pose2d& a, const Pose2d& b);

}  // namespace pickcell::matches::testing
