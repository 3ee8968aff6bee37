#include "pickcell/cli/experiment/blob_scene.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace pickcell::cli {

namespace {

constexpr int kSamples = 6;  // per pixel and direction
constexpr double kGrey = 128;

}  // namespace

std::vector<BlobScene::Blob> BlobScene::blobs(int count, double width, double height, std::mt19937_64& rng) {
  std::uniform_real_distribution<double> unit(0, 1);
  std::vector<Blob> out;
  for (int i = 0; i < count; ++i) {
    const double angle = std::numbers::pi * unit(rng);
    const double wide = 1.5 + 2 * unit(rng);
    out.push_back({width * unit(rng), height * unit(rng), std::cos(angle), std::sin(angle), wide * (1 + 2 * unit(rng)),
                   wide, (unit(rng) < 0.5 ? -1 : 1) * (30 + 50 * unit(rng))});
  }
  return out;
}

double BlobScene::grey(const std::vector<Blob>& blobs, double x, double y) {
  double v = kGrey;
  for (const Blob& b : blobs) {
    const double dx = x - b.x, dy = y - b.y;
    const double u = (b.cos * dx + b.sin * dy) / b.long_px, w = (b.cos * dy - b.sin * dx) / b.wide_px;
    const double r2 = u * u + w * w;
    if (r2 < 16) v += b.height * std::exp(-0.5 * r2);
  }
  return std::clamp(v, 12.0, 243.0);
}

BlobScene::BlobScene(int part_side_px, int width, int height, std::uint64_t seed) : side_(part_side_px) {
  std::mt19937_64 rng(seed);
  part_ = blobs(std::max(12, side_ * side_ / 110), side_, side_, rng);
  const std::vector<Blob> clutter = blobs(width * height / 400, width, height, rng);
  ground_.resize(width, height);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) ground_.at(x, y) = static_cast<float>(kGrey);
  // Blob by blob: each touches few pixels.
  for (const Blob& b : clutter) {
    const int reach = static_cast<int>(4 * b.long_px) + 1;
    const int x0 = std::max(0, static_cast<int>(b.x) - reach), x1 = std::min(width, static_cast<int>(b.x) + reach);
    const int y0 = std::max(0, static_cast<int>(b.y) - reach), y1 = std::min(height, static_cast<int>(b.y) + reach);
    for (int y = y0; y < y1; ++y)
      for (int x = x0; x < x1; ++x) ground_.at(x, y) += static_cast<float>(0.5 * (grey({b}, x, y) - kGrey));
  }
}

matches::Model BlobScene::model() const {
  matches::Model m;
  m.name = "part";
  m.picture.resize(side_, side_);
  for (int y = 0; y < side_; ++y)
    for (int x = 0; x < side_; ++x) {
      double sum = 0;
      for (int j = 0; j < kSamples; ++j)
        for (int i = 0; i < kSamples; ++i)
          sum += grey(part_, x + (i + 0.5) / kSamples - 0.5, y + (j + 0.5) / kSamples - 0.5);
      m.picture.at(x, y) = static_cast<std::uint8_t>(std::lround(sum / (kSamples * kSamples)));
    }
  m.ref_x_px = m.ref_y_px = (side_ - 1) / 2.0;
  m.scale = {0.9, 1.1};
  return m;
}

image::Plane<float> BlobScene::draw(const matches::Pose2d& pose) const {
  image::Plane<float> out = ground_;
  const double a = pose.angle_deg * std::numbers::pi / 180;
  const double c = std::cos(a) / pose.scale, s = std::sin(a) / pose.scale;
  const double middle = (side_ - 1) / 2.0;
  const int reach = static_cast<int>(pose.scale * side_ * 0.75) + 2;
  const int x0 = std::max(0, static_cast<int>(pose.x_px) - reach);
  const int x1 = std::min(out.width(), static_cast<int>(pose.x_px) + reach);
  const int y0 = std::max(0, static_cast<int>(pose.y_px) - reach);
  const int y1 = std::min(out.height(), static_cast<int>(pose.y_px) + reach);
  for (int y = y0; y < y1; ++y)
    for (int x = x0; x < x1; ++x) {
      double sum = 0;
      int inside = 0;
      for (int j = 0; j < kSamples; ++j)
        for (int i = 0; i < kSamples; ++i) {
          const double dx = x + (i + 0.5) / kSamples - 0.5 - pose.x_px, dy = y + (j + 0.5) / kSamples - 0.5 - pose.y_px;
          const double tx = middle + c * dx - s * dy, ty = middle + s * dx + c * dy;
          if (tx < -0.5 || ty < -0.5 || tx > side_ - 0.5 || ty > side_ - 0.5) continue;
          sum += grey(part_, tx, ty);
          ++inside;
        }
      if (inside == 0) continue;
      const double ground = static_cast<double>(ground_.at(x, y));
      out.at(x, y) = static_cast<float>((sum + ground * (kSamples * kSamples - inside)) / (kSamples * kSamples));
    }
  return out;
}

image::Image BlobScene::expose(const image::Plane<float>& light, double noise_grey, std::mt19937_64& rng) {
  std::normal_distribution<double> noise(0, noise_grey);
  image::Image out(light.width(), light.height());
  for (int y = 0; y < out.height(); ++y)
    for (int x = 0; x < out.width(); ++x)
      out.at(x, y) = static_cast<std::uint8_t>(
          std::clamp(std::lround(static_cast<double>(light.at(x, y)) + (noise_grey > 0 ? noise(rng) : 0.0)), 0L, 255L));
  return out;
}

}  // namespace pickcell::cli
