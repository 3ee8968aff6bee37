#include "pickcell/matches/learn/rings.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <numbers>

namespace pickcell::matches {

namespace {

constexpr double kPi = std::numbers::pi;

int circle_samples(double radius) {
  return static_cast<int>(std::bit_ceil(static_cast<unsigned>(std::max(64.0, std::ceil(2 * kPi * radius)))));
}

/// Catmull-Rom: exact at pixels, and to the third order between them.
std::array<float, 4> cubic_weights(float t) {
  const float t2 = t * t, t3 = t2 * t;
  return {0.5f * (-t + 2 * t2 - t3), 0.5f * (2 - 5 * t2 + 3 * t3), 0.5f * (t + 4 * t2 - 3 * t3), 0.5f * (t3 - t2)};
}

Rings::Sample sample(const PartPicture& part, float x, float y) {
  const int width = part.grey.width(), height = part.grey.height();
  const float fx = std::floor(x), fy = std::floor(y);
  const int ix = static_cast<int>(fx) - 1, iy = static_cast<int>(fy) - 1;
  const auto wx = cubic_weights(x - fx), wy = cubic_weights(y - fy);
  float grey = 0, cover = 0;
  if (ix >= 0 && iy >= 0 && ix + 3 < width && iy + 3 < height) {
    for (int j = 0; j < 4; ++j) {
      const float* g = part.grey.row(iy + j) + ix;
      const float* c = part.cover.row(iy + j) + ix;
      grey += wy[static_cast<std::size_t>(j)] * (wx[0] * g[0] + wx[1] * g[1] + wx[2] * g[2] + wx[3] * g[3]);
      cover += wy[static_cast<std::size_t>(j)] * (wx[0] * c[0] + wx[1] * c[1] + wx[2] * c[2] + wx[3] * c[3]);
    }
    return {grey, cover};
  }
  for (int j = 0; j < 4; ++j)
    for (int i = 0; i < 4; ++i) {
      const int px = ix + i, py = iy + j;
      const bool seen = px >= 0 && py >= 0 && px < width && py < height;
      const float w = wx[static_cast<std::size_t>(i)] * wy[static_cast<std::size_t>(j)];
      grey += w * (seen ? part.grey.at(px, py) : static_cast<float>(part.ground.at(px, py)));
      cover += w * (seen ? part.cover.at(px, py) : static_cast<float>(part.cover_outside));
    }
  return {grey, cover};
}

}  // namespace

Rings::Rings(const PartPicture& part, double centre_x, double centre_y, double radius)
    : rings_(std::max(1, static_cast<int>(std::ceil(radius)))), angles_(circle_samples(radius)), fourier_(angles_) {
  directions_.resize(static_cast<std::size_t>(angles_));
  for (int a = 0; a < angles_; ++a)
    directions_[static_cast<std::size_t>(a)] = Sample(std::polar(1.0, 2 * kPi * a / angles_));
  samples_.resize(offset(rings_));
  for (int i = 0; i < rings_; ++i) {
    const auto r = static_cast<float>(this->radius(i));
    for (int a = 0; a < angles_; ++a) {
      const Sample d = direction(a);
      samples_[offset(i) + static_cast<std::size_t>(a)] =
          sample(part, static_cast<float>(centre_x) + r * d.real(), static_cast<float>(centre_y) + r * d.imag());
    }
  }
  spectrum_ = samples_;
  for (int i = 0; i < rings_; ++i) fourier_.forward(spectrum_.data() + offset(i));
}

void Rings::mean_of_turns(int period, std::vector<Sample>& out) const {
  out.assign(spectrum_.size(), Sample());
  const float scale = 1.0f / static_cast<float>(angles_);
  for (int i = 0; i < rings_; ++i) {
    const Sample* from = spectrum_.data() + offset(i);
    Sample* to = out.data() + offset(i);
    if (period == 0) {
      std::fill(to, to + angles_, from[0] * scale);
      continue;
    }
    to[0] = from[0] * scale;
    for (int n = period; n <= angles_ / 2; n += period) {
      to[n] = from[n] * scale;
      to[angles_ - n] = from[angles_ - n] * scale;
    }
    fourier_.inverse(to);
  }
}

}  // namespace pickcell::matches
