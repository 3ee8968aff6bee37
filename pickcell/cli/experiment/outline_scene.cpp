#include "pickcell/cli/experiment/outline_scene.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "pickcell/sim/shape.hpp"

namespace pickcell::cli {

namespace {

constexpr int kFine = 4;     // samples per pixel and direction
constexpr int kMargin = 14;  // pixels around the part in its template
constexpr double kPartGrey = 125;

using Raster = image::Plane<float>;

/// A raster of kFine samples per pixel, read at pixels: its sample i lies at (i + 0.5) / kFine - 0.5.
double read(const Raster& r, double x, double y) {
  const double u = std::clamp((x + 0.5) * kFine - 0.5, 0.0, r.width() - 1.001);
  const double v = std::clamp((y + 0.5) * kFine - 0.5, 0.0, r.height() - 1.001);
  const int i = static_cast<int>(u), j = static_cast<int>(v);
  const double fu = u - i, fv = v - j;
  const auto at = [&](int k, int l) { return static_cast<double>(r.at(i + k, j + l)); };
  return (1 - fv) * ((1 - fu) * at(0, 0) + fu * at(1, 0)) + fv * ((1 - fu) * at(0, 1) + fu * at(1, 1));
}

double place_of(int sample) { return (sample + 0.5) / kFine - 0.5; }

/// Blobs of 1.5 to 5 px, bright and dark, of height up to 1.
void add_blobs(Raster& r, double per_px, float height, std::mt19937_64& rng) {
  std::uniform_real_distribution<double> unit(0, 1);
  const int count = static_cast<int>(per_px * r.width() * r.height() / (kFine * kFine));
  for (int n = 0; n < count; ++n) {
    const double x = r.width() * unit(rng), y = r.height() * unit(rng), turn = std::numbers::pi * unit(rng);
    const double wide = kFine * (1.2 + 1.5 * unit(rng)), lengthy = wide * (1 + unit(rng));
    const auto tall = static_cast<double>(height) * (unit(rng) < 0.5 ? -1 : 1) * (0.4 + 0.6 * unit(rng));
    const int reach = static_cast<int>(3.5 * lengthy) + 1;
    for (int j = std::max(0, static_cast<int>(y) - reach); j < std::min(r.height(), static_cast<int>(y) + reach); ++j)
      for (int i = std::max(0, static_cast<int>(x) - reach); i < std::min(r.width(), static_cast<int>(x) + reach);
           ++i) {
        const double p = (std::cos(turn) * (i - x) + std::sin(turn) * (j - y)) / lengthy;
        const double q = (std::cos(turn) * (j - y) - std::sin(turn) * (i - x)) / wide;
        r.at(i, j) += static_cast<float>(tall * std::exp(-0.5 * (p * p + q * q)));
      }
  }
}

/// In units of half the longer side; nothing about them repeats when turned.
sim::Shape outline_of(OutlineKind kind) {
  using namespace sim;
  switch (kind) {
    case OutlineKind::flat:
    case OutlineKind::plain:
    case OutlineKind::marked:
      return cut(rectangle(2, 1.3, 0.2), {rectangle(0.5, 0.5, 0.1).moved(0.9, 0.5), circle(0.16).moved(-0.6, 0.2)});
    case OutlineKind::textured:
      return polygon({{-1, -0.5}, {-0.2, -0.8}, {0.9, -0.6}, {1, 0.1}, {0.3, 0.8}, {-0.6, 0.7}}).grown(0.05);
    case OutlineKind::thin:
      return join({capsule({-0.95, 0}, {0.95, 0}, 0.055), capsule({0.95, 0}, {0.95, 0.6}, 0.055),
                   capsule({-0.95, 0}, {-0.5, -0.5}, 0.055)});
    case OutlineKind::gear:
      return cut(gear(14, 0.82, 1),
                 {circle(0.2), circle(0.16).moved(0.48, 0.1), rectangle(0.5, 0.16).moved(-0.2, 0.45)});
    case OutlineKind::bracket:
      return cut(join({rectangle(0.55, 1.7).moved(-0.7, 0), rectangle(1.9, 0.5).moved(0, -0.6)}),
                 {circle(0.14).moved(-0.7, 0.55), circle(0.12).moved(0.7, -0.6)});
  }
  return circle(1);
}

double texture_of(OutlineKind kind) {
  switch (kind) {
    case OutlineKind::flat:
    case OutlineKind::thin:
      return 0;
    case OutlineKind::textured:
      return 55;
    default:
      return 6;
  }
}

}  // namespace

const char* name(OutlineKind kind) {
  constexpr const char* kNames[kOutlineKinds] = {"flat", "plain", "marked", "textured", "thin", "gear", "bracket"};
  return kNames[static_cast<int>(kind)];
}

OutlineScene::OutlineScene(OutlineKind kind, int side_px, std::uint64_t seed) : side_(side_px + 2 * kMargin) {
  std::mt19937_64 rng(seed);
  distance_.resize(kFine * side_, kFine * side_);
  inside_.resize(kFine * side_, kFine * side_);
  const double unit_px = side_px / 2.0, middle = (side_ - 1) / 2.0;
  const sim::Shape outline = outline_of(kind);
  const sim::Shape marks =
      sim::join({sim::lettering("K7", 0.45, 0.1).moved(0.05, -0.1), sim::rectangle(0.5, 0.12).moved(-0.5, -0.45)});
  for (int j = 0; j < distance_.height(); ++j)
    for (int i = 0; i < distance_.width(); ++i) {
      const sim::Point2 p((place_of(i) - middle) / unit_px, -(place_of(j) - middle) / unit_px);
      distance_.at(i, j) = static_cast<float>(unit_px * outline.distance(p));
      inside_.at(i, j) = 0;
    }
  if (texture_of(kind) > 0) add_blobs(inside_, 0.02, static_cast<float>(texture_of(kind)), rng);
  for (int j = 0; j < distance_.height(); ++j)
    for (int i = 0; i < distance_.width(); ++i) {
      const sim::Point2 p((place_of(i) - middle) / unit_px, -(place_of(j) - middle) / unit_px);
      const double marked =
          kind == OutlineKind::marked ? std::clamp(0.5 - kFine * unit_px * marks.distance(p), 0.0, 1.0) : 0;
      inside_.at(i, j) =
          static_cast<float>(std::clamp(kPartGrey + static_cast<double>(inside_.at(i, j)) - 70 * marked, 15.0, 240.0));
    }
  const int sizes[2][2] = {{side_, side_}, {kWidth, kHeight}};
  for (std::size_t g = 0; g < 2; ++g) {
    grounds_[g].resize(kFine * sizes[g][0], kFine * sizes[g][1]);
    grounds_[g].fill(0);
    add_blobs(grounds_[g], 0.02, 1, rng);
  }
}

double OutlineScene::distance_px(double x, double y) const { return read(distance_, x, y); }

matches::Model OutlineScene::model(const Ground& ground, double outside_px) const {
  matches::Model m;
  m.name = "part";
  m.ref_x_px = m.ref_y_px = (side_ - 1) / 2.0;
  const Raster light = draw({m.ref_x_px, m.ref_y_px, 0, 1}, ground, grounds_[0], side_, side_);
  m.picture.resize(side_, side_);
  m.mask.resize(side_, side_);
  for (int y = 0; y < side_; ++y)
    for (int x = 0; x < side_; ++x) {
      m.picture.at(x, y) = static_cast<std::uint8_t>(std::lround(light.at(x, y)));
      m.mask.at(x, y) = distance_px(x, y) <= outside_px ? 255 : 0;
    }
  m.scale = {0.9, 1.1};
  return m;
}

Raster OutlineScene::draw(const matches::Pose2d& pose, const Ground& ground) const {
  return draw(pose, ground, grounds_[1], kWidth, kHeight);
}

Raster OutlineScene::draw(const matches::Pose2d& pose, const Ground& ground, const Raster& texture, int width,
                          int height) const {
  const double a = pose.angle_deg * std::numbers::pi / 180;
  const double c = std::cos(a) / pose.scale, s = std::sin(a) / pose.scale;
  const double middle = (side_ - 1) / 2.0;
  Raster fine(kFine * width, kFine * height);
  for (int j = 0; j < fine.height(); ++j)
    for (int i = 0; i < fine.width(); ++i) {
      const double dx = place_of(i) - pose.x_px, dy = place_of(j) - pose.y_px;
      const double tx = middle + c * dx - s * dy, ty = middle + s * dx + c * dy;
      const double under =
          std::clamp(ground.grey + ground.texture_grey * static_cast<double>(texture.at(i, j)), 8., 247.);
      const bool near = tx > -0.5 && ty > -0.5 && tx < side_ - 0.5 && ty < side_ - 0.5;
      const double on = near ? std::clamp(0.5 - kFine * pose.scale * distance_px(tx, ty), 0.0, 1.0) : 0;
      fine.at(i, j) = static_cast<float>(on > 0 ? on * read(inside_, tx, ty) + (1 - on) * under : under);
    }
  // Lens and pixel in one pass along each direction: a pixel is the mean of kFine samples of the blurred light.
  constexpr int kReach = 3 * kFine / 2 + kFine;
  std::array<double, 2 * kReach + kFine> kernel{};
  double sum = 0;
  for (std::size_t k = 0; k < kernel.size(); ++k) {
    for (int n = 0; n < kFine; ++n) {
      const double d = (static_cast<double>(k) - kReach - n) / (kFine * kBlur_px);
      kernel[k] += std::exp(-0.5 * d * d);
    }
    sum += kernel[k];
  }
  const auto blurred = [&](int pixel, int length, auto sample) {
    double v = 0;
    for (std::size_t k = 0; k < kernel.size(); ++k)
      v += kernel[k] *
           static_cast<double>(sample(std::clamp(kFine * pixel + static_cast<int>(k) - kReach, 0, length - 1)));
    return static_cast<float>(v / sum);
  };
  Raster wide(width, fine.height()), out(width, height);
  for (int j = 0; j < fine.height(); ++j)
    for (int x = 0; x < width; ++x) wide.at(x, j) = blurred(x, fine.width(), [&](int i) { return fine.at(i, j); });
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) out.at(x, y) = blurred(y, fine.height(), [&](int j) { return wide.at(x, j); });
  return out;
}

}  // namespace pickcell::cli
