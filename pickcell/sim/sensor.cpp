#include "pickcell/sim/sensor.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "pickcell/core/units.hpp"
#include "pickcell/sim/random.hpp"

namespace pickcell::sim {

namespace {

std::vector<float> gaussian_weights(double sigma_px) {
  const int reach = std::max(1, static_cast<int>(std::ceil(3 * sigma_px)));
  std::vector<float> weights;
  double sum = 0;
  for (int i = -reach; i <= reach; ++i) sum += std::exp(-0.5 * i * i / (sigma_px * sigma_px));
  for (int i = -reach; i <= reach; ++i)
    weights.push_back(static_cast<float>(std::exp(-0.5 * i * i / (sigma_px * sigma_px)) / sum));
  return weights;
}

/// out = row filtered; padded holds the row with its ends repeated.
void filter_row(float* row, int width, const std::vector<float>& weights, std::vector<float>& padded) {
  const int reach = static_cast<int>(weights.size() / 2);
  padded.resize(static_cast<std::size_t>(width + 2 * reach));
  std::fill_n(padded.begin(), reach, row[0]);
  std::copy_n(row, width, padded.begin() + reach);
  std::fill_n(padded.begin() + reach + width, reach, row[width - 1]);
  std::fill_n(row, width, 0.0F);
  for (std::size_t k = 0; k < weights.size(); ++k) {
    const float w = weights[k];
    const float* from = padded.data() + k;
    for (int x = 0; x < width; ++x) row[x] += w * from[x];
  }
}

/// Gaussian numbers to be read from any start: as many as a prime, so that rows do not repeat.
const std::vector<float>& noise_table() {
  static const std::vector<float> table = [] {
    Random random(77);
    std::vector<float> t(131071);
    for (float& v : t) v = static_cast<float>(random.normal());
    return t;
  }();
  return table;
}

}  // namespace

void blur(LightPlane& light, double sigma_px) {
  if (sigma_px <= 0) return;
  const std::vector<float> weights = gaussian_weights(sigma_px);
  const int reach = static_cast<int>(weights.size() / 2), w = light.width(), h = light.height();
  std::vector<float> padded;
  for (int y = 0; y < h; ++y) filter_row(light.row(y), w, weights, padded);
  LightPlane out(w, h);
  for (int y = 0; y < h; ++y) {
    float* to = out.row(y);
    for (int k = -reach; k <= reach; ++k) {
      const float weight = weights[static_cast<std::size_t>(k + reach)];
      const float* from = light.row(std::clamp(y + k, 0, h - 1));
      for (int x = 0; x < w; ++x) to[x] += weight * from[x];
    }
  }
  light.swap(out);
}

void motion_blur(LightPlane& light, double length_px, double direction_deg) {
  const int steps = 1 + static_cast<int>(std::ceil(2 * length_px));
  if (steps < 2) return;
  const double a = core::rad_from_deg(direction_deg);
  const int w = light.width(), h = light.height();
  LightPlane out(w, h);
  for (int s = 0; s < steps; ++s) {
    const double along = length_px * ((s + 0.5) / steps - 0.5), dx = along * std::cos(a), dy = -along * std::sin(a);
    const int ix = static_cast<int>(std::floor(dx)), iy = static_cast<int>(std::floor(dy));
    const auto fx = static_cast<float>(dx - ix), fy = static_cast<float>(dy - iy);
    for (int y = 0; y < h; ++y) {
      const float *top = light.row(std::clamp(y + iy, 0, h - 1)), *bottom = light.row(std::clamp(y + iy + 1, 0, h - 1));
      for (int x = 0; x < w; ++x) {
        const int l = std::clamp(x + ix, 0, w - 1), r = std::clamp(x + ix + 1, 0, w - 1);
        out.at(x, y) += ((1 - fy) * ((1 - fx) * top[l] + fx * top[r]) + fy * ((1 - fx) * bottom[l] + fx * bottom[r])) /
                        static_cast<float>(steps);
      }
    }
  }
  light.swap(out);
}

image::Image expose(const LightPlane& light, const SensorSettings& settings, std::uint64_t seed) {
  const int w = light.width(), h = light.height();
  image::Image picture(w, h);
  const std::vector<float>& noise = noise_table();
  const double a = core::rad_from_deg(settings.gradient_deg);
  const double half = 0.5 * std::hypot(w, h);
  const auto gx = static_cast<float>(settings.gradient * std::cos(a) / half);
  const auto gy = static_cast<float>(-settings.gradient * std::sin(a) / half);
  const auto fall = static_cast<float>(settings.vignette / (half * half));
  const auto gain = static_cast<float>(255 * settings.gain), offset = static_cast<float>(settings.offset_grey);
  const auto dark2 = static_cast<float>(settings.noise_grey * settings.noise_grey);
  const auto shot2 = static_cast<float>(settings.shot_noise_grey * settings.shot_noise_grey / 255);
  const float cx = 0.5F * static_cast<float>(w - 1), cy = 0.5F * static_cast<float>(h - 1);
  Random random(seed);
  for (int y = 0; y < h; ++y) {
    const float *from = light.row(y), dy = static_cast<float>(y) - cy;
    std::uint8_t* to = picture.row(y);
    for (int x0 = 0; x0 < w; x0 += 4096) {  // the table is longer than any piece of a row
      const int x1 = std::min(w, x0 + 4096);
      const float* n = noise.data() + random.bits() % (noise.size() - 4096) - x0;
      for (int x = x0; x < x1; ++x) {
        const float dx = static_cast<float>(x) - cx;
        const float grey = from[x] * gain * (1 + gx * dx + gy * dy) * (1 - fall * (dx * dx + dy * dy)) + offset;
        const float noisy = grey + n[x] * std::sqrt(dark2 + shot2 * std::max(grey, 0.0F));
        to[x] = static_cast<std::uint8_t>(std::clamp(noisy + 0.5F, 0.0F, 255.0F));
      }
    }
  }
  return picture;
}

}  // namespace pickcell::sim
