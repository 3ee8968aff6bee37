#include <algorithm>
#include <cmath>
#include <random>

#include "pickcell/matches/similarity.hpp"
#include "pickcell/matches/test_scenes.hpp"

namespace pickcell::matches::testing {
namespace {
constexpr int kSuper = 4;
constexpr int kRim = 4;  // pixels around the texture

std::uint8_t to_grey(double v) { return static_cast<std::uint8_t>(std::clamp(std::lround(v), 0L, 255L)); }

template <class F>
double mean_over_pixel(int x, int y, F f) {
  double sum = 0;
  for (int j = 0; j < kSuper; ++j)
    for (int i = 0; i < kSuper; ++i) sum += f(x + (i + 0.5) / kSuper - 0.5, y + (j + 0.5) / kSuper - 0.5);
  return sum / (kSuper * kSuper);
}
}  // namespace

Texture::Texture(int width, int height, unsigned seed)
    : columns_(kSuper * (width + 2 * kRim)),
      rows_(kSuper * (height + 2 * kRim)),
      raster_(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_), 120.f) {
  std::mt19937 rng(seed);
  std::uniform_real_distribution<double> u(0, 1);
  const int n = std::max(12, width * height / 150);
  for (int i = 0; i < n; ++i) {
    const double wide = 1.5 + 2 * u(rng);
    const double lengthy = wide * (1 + 2 * u(rng));
    const double height_grey = (u(rng) < 0.5 ? -1 : 1) * (40 + 60 * u(rng));
    // One draw a statement: compilers for different machines evaluate arguments in different orders.
    const double angle = u(rng) * 3.14159265;
    const double y = u(rng) * height;
    const double x = u(rng) * width;
    add_blob(x, y, angle, lengthy, wide, height_grey);
  }
  for (float& v : raster_) v = std::clamp(v, 5.f, 250.f);
}

void Texture::add_blob(double x, double y, double angle, double lengthy, double wide, double height) {
  const double c = std::cos(angle);
  const double s = std::sin(angle);
  const auto first = [](double v) { return std::max(0, static_cast<int>(kSuper * (v + kRim))); };
  for (int j = first(y - 3 * lengthy); j < std::min(rows_, first(y + 3 * lengthy)); ++j)
    for (int i = first(x - 3 * lengthy); i < std::min(columns_, first(x + 3 * lengthy)); ++i) {
      const double dx = static_cast<double>(i) / kSuper - kRim - x;
      const double dy = static_cast<double>(j) / kSuper - kRim - y;
      const double p = (c * dx + s * dy) / lengthy;
      const double q = (c * dy - s * dx) / wide;
      raster_[static_cast<std::size_t>(j) * static_cast<std::size_t>(columns_) + static_cast<std::size_t>(i)] +=
          static_cast<float>(height * std::exp(-0.5 * (p * p + q * q)));
    }
}

double Texture::at(double x, double y) const {
  const double u = std::clamp((x + kRim) * kSuper, 0.0, columns_ - 1.001);
  const double v = std::clamp((y + kRim) * kSuper, 0.0, rows_ - 1.001);
  const auto i = static_cast<std::size_t>(u);
  const auto j = static_cast<std::size_t>(v);
  const double fu = u - static_cast<double>(i);
  const double fv = v - static_cast<double>(j);
  const float* a = &raster_[j * static_cast<std::size_t>(columns_) + i];
  const float* b = a + columns_;
  return (1 - fv) * ((1 - fu) * a[0] + fu * a[1]) + fv * ((1 - fu) * b[0] + fu * b[1]);
}

image::Image draw_template(const Texture& t, int width, int height) {
  image::Image out(width, height);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      out.at(x, y) = to_grey(mean_over_pixel(x, y, [&](double u, double v) { return t.at(u, v); }));
  return out;
}

Model texture_model(const Texture& t, int width, int height) {
  Model m;
  m.name = "texture";
  m.picture = draw_template(t, width, height);
  m.ref_x_px = (width - 1) / 2.0;
  m.ref_y_px = (height - 1) / 2.0;
  m.scale = {0.9, 1.1};
  return m;
}

image::Image draw_ground(int width, int height, unsigned seed) {
  return draw_template(Texture(width, height, seed + 77), width, height);
}

void draw_part(image::Image& scene, const Texture& t, const Model& model, const Pose2d& pose) {
  const int w = model.picture.width();
  const int h = model.picture.height();
  const auto on_part = [&](double u, double v) {
    const int x = static_cast<int>(std::lround(u));
    const int y = static_cast<int>(std::lround(v));
    return x >= 0 && y >= 0 && x < w && y < h && (model.mask.empty() || model.mask.at(x, y) >= 128);
  };
  const double a = pose.angle_deg / kDegPerRad;
  const double c = std::cos(a) / pose.scale;
  const double s = std::sin(a) / pose.scale;
  for (int y = 0; y < scene.height(); ++y)
    for (int x = 0; x < scene.width(); ++x) {
      if (std::hypot(x - pose.x_px, y - pose.y_px) > 2 * std::hypot(w, h) * pose.scale) continue;
      double covered = 0;
      const double grey = mean_over_pixel(x, y, [&](double px, double py) {
        const double dx = px - pose.x_px;
        const double dy = py - pose.y_px;
        const double u = c * dx - s * dy + model.ref_x_px;
        const double v = s * dx + c * dy + model.ref_y_px;
        if (!on_part(u, v)) return 0.0;
        covered += 1.0 / (kSuper * kSuper);
        return t.at(u, v);
      });
      if (covered > 0) scene.at(x, y) = to_grey(grey + (1 - covered) * scene.at(x, y));
    }
}

void add_noise(image::Image& picture, double sigma_grey, unsigned seed) {
  std::mt19937 rng(seed);
  std::normal_distribution<double> n(0, sigma_grey);
  for (int y = 0; y < picture.height(); ++y)
    for (int x = 0; x < picture.width(); ++x) picture.at(x, y) = to_grey(picture.at(x, y) + n(rng));
}

double distance_px(const Pose2d& a, const Pose2d& b) { return std::hypot(a.x_px - b.x_px, a.y_px - b.y_px); }
double turn_deg(const Pose2d& a, const Pose2d& b) { return std::abs(wrap_deg(a.angle_deg - b.angle_deg)); }

}  // namespace pickcell::matches::testing
