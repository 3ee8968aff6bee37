#include "pickcell/matches/learn/part_picture.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <vector>

namespace pickcell::matches {

namespace {

constexpr double kSmooth_px = 1;        ///< less, and reading between pixels costs; more, and fine teeth are gone
constexpr double kLeastNoise = 0.15;    ///< of rounding to grey values, smoothed
constexpr double kMostNoise = 6;        ///< before smoothing
constexpr double kEvenGround = 0.8;     ///< of the picture's border: the part may touch it here and there
constexpr double kGroundVaries = 0.08;  ///< of the contrast

float weight_at(int i) { return static_cast<float>(std::exp(-i * i / (2 * kSmooth_px * kSmooth_px))); }

/// Gaussian, rows then columns; beyond the border the last value goes on, or `outside` where one is given.
image::Plane<float> smoothed(image::ImageView from, float scale, const float* outside) {
  const int reach = static_cast<int>(std::ceil(3.5 * kSmooth_px));
  const int width = from.width(), height = from.height();
  std::vector<float> weights;
  float sum = 0;
  for (int i = -reach; i <= reach; ++i) sum += weight_at(i);
  for (int i = -reach; i <= reach; ++i) weights.push_back(weight_at(i) / sum);
  image::Plane<float> along(width, height), out(width, height);
  const auto blended = [&](int last, int at, auto value) {
    float v = 0;
    for (int i = -reach; i <= reach; ++i) {
      const bool seen = at + i >= 0 && at + i <= last;
      v += weights[static_cast<std::size_t>(i + reach)] *
           (seen || !outside ? value(std::clamp(at + i, 0, last)) : *outside);
    }
    return v;
  };
  for (int y = 0; y < height; ++y) {
    const std::uint8_t* row = from.row(y);
    for (int x = 0; x < width; ++x)
      along.at(x, y) = blended(width - 1, x, [&](int i) { return scale * static_cast<float>(row[i]); });
  }
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) out.at(x, y) = blended(height - 1, y, [&](int i) { return along.at(x, i); });
  return out;
}

template <class T>
double percentile(std::vector<T>& values, double share) {
  if (values.empty()) return 0;
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), at, values.end());
  return static_cast<double>(*at);
}

/// Of white noise, before smoothing: what is left by a filter that takes steps and slopes away (Immerkaer 1996), in the
/// quieter half of the picture, so that edges and texture do not count; at most what a camera has.
double noise_of(image::ImageView picture) {
  std::vector<int> rest;
  for (int y = 1; y + 1 < picture.height(); ++y)
    for (int x = 1; x + 1 < picture.width(); ++x) {
      const std::uint8_t *a = picture.row(y - 1) + x, *b = picture.row(y) + x, *c = picture.row(y + 1) + x;
      rest.push_back(std::abs(a[-1] - 2 * a[0] + a[1] - 2 * (b[-1] - 2 * b[0] + b[1]) + c[-1] - 2 * c[0] + c[1]));
    }
  return std::min(kMostNoise, percentile(rest, 0.25) / (6 * 0.3186));
}

double contrast_of(const PartPicture& part) {
  std::vector<float> greys;
  for (int y = 0; y < part.grey.height(); ++y)
    for (int x = 0; x < part.grey.width(); ++x)
      if (part.cover.at(x, y) > 0.1f) greys.push_back(part.grey.at(x, y));
  return percentile(greys, 0.98) - percentile(greys, 0.02);
}

/// Fits a plane to the border, twice, the second time to what the first one left near; says whether it is one.
bool find_ground(PartPicture& part) {
  const int last_x = part.grey.width() - 1, last_y = part.grey.height() - 1;
  const double near = std::max(4 * part.noise, kGroundVaries * part.contrast);
  std::vector<Eigen::Vector3d> at;
  std::vector<double> grey;
  const auto add = [&](int x, int y) {
    at.emplace_back(1, x - last_x / 2.0, y - last_y / 2.0);
    grey.push_back(static_cast<double>(part.grey.at(x, y)));
  };
  for (int x = 0; x <= last_x; ++x) add(x, 0), add(x, last_y);
  for (int y = 1; y < last_y; ++y) add(0, y), add(last_x, y);
  std::vector<double> sorted = grey;
  Eigen::Vector3d plane(percentile(sorted, 0.5), 0, 0);
  std::size_t on_it = 0;
  for (const double reach : {4 * near, 2 * near, near}) {
    Eigen::Matrix3d normal = Eigen::Matrix3d::Identity() * 1e-9;
    Eigen::Vector3d right = Eigen::Vector3d::Zero();
    on_it = 0;
    for (std::size_t i = 0; i < at.size(); ++i) {
      if (std::abs(grey[i] - plane.dot(at[i])) > reach) continue;
      normal += at[i] * at[i].transpose();
      right += at[i] * grey[i];
      ++on_it;
    }
    if (on_it < at.size() / 2) break;
    plane = normal.ldlt().solve(right);
  }
  part.ground = {plane[0] - plane[1] * last_x / 2.0 - plane[2] * last_y / 2.0, plane[1], plane[2]};
  return static_cast<double>(on_it) >= kEvenGround * static_cast<double>(at.size());
}

/// An uneven light on the ground is no part of what is compared.
void level_ground(PartPicture& part) {
  for (int y = 0; y < part.grey.height(); ++y)
    for (int x = 0; x < part.grey.width(); ++x) part.grey.at(x, y) -= static_cast<float>(part.ground.at(x, y));
  part.ground = {};
  part.contrast = contrast_of(part);
}

}  // namespace

PartPicture make_part_picture(image::ImageView picture, image::ImageView mask) {
  PartPicture part;
  part.masked = !mask.empty();
  part.grey = smoothed(picture, 1, nullptr);
  if (part.masked) {
    image::Image two(mask);
    for (int y = 0; y < two.height(); ++y)
      for (int x = 0; x < two.width(); ++x) two.at(x, y) = two.at(x, y) >= 128 ? 255 : 0;
    const float none = 0;
    part.cover = smoothed(two.view(), 1 / 255.0f, &none);
  } else {
    part.cover.resize(picture.width(), picture.height());
    part.cover.fill(1);
  }
  part.contrast = contrast_of(part);
  part.noise = std::max(kLeastNoise, noise_of(picture) / (2 * std::sqrt(3.14159265) * kSmooth_px));
  const bool even = find_ground(part);
  part.on_ground = !part.masked && even;
  part.cover_outside = part.on_ground ? 1 : 0;
  if (part.on_ground) level_ground(part);
  return part;
}

std::array<PartPicture::Point, 2> PartPicture::likely_centres() const {
  const Point middle{(grey.width() - 1) / 2.0, (grey.height() - 1) / 2.0};
  double weight = 0, sum_x = 0, sum_y = 0;
  const auto add = [&](double w, int x, int y) {
    weight += w;
    sum_x += w * x;
    sum_y += w * y;
  };
  const double doubt = std::pow(3 * noise + 0.02 * contrast, 2);
  for (int y = 1; y + 1 < grey.height(); ++y)
    for (int x = 1; x + 1 < grey.width(); ++x) {
      if (masked) {
        add(static_cast<double>(cover.at(x, y)), x, y);
        continue;
      }
      const double gx = static_cast<double>(grey.at(x + 1, y) - grey.at(x - 1, y));
      const double gy = static_cast<double>(grey.at(x, y + 1) - grey.at(x, y - 1));
      const double g = gx * gx + gy * gy;
      if (g > doubt) add(g / (g + 25 * doubt), x, y);
    }
  const Point found = weight > 0 ? Point{sum_x / weight, sum_y / weight} : middle;
  return {found, masked ? found : middle};
}

double PartPicture::radius(Point centre) const {
  const double far = std::max(6 * noise, 0.15 * contrast);
  double most = 0;
  for (int y = 0; y < grey.height(); ++y)
    for (int x = 0; x < grey.width(); ++x) {
      const bool part = masked      ? cover.at(x, y) > 0.5f
                        : on_ground ? std::abs(static_cast<double>(grey.at(x, y)) - ground.at(x, y)) > far
                                    : true;
      if (part) most = std::max(most, std::hypot(x - centre.x, y - centre.y));
    }
  return most;
}

}  // namespace pickcell::matches
