#include "pickcell/matches/fields/template_pyramid.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "pickcell/image/pyramid.hpp"

namespace pickcell::matches {
namespace {

image::Plane<float> full_coverage(const Model& model) {
  image::Plane<float> out(model.picture.width(), model.picture.height());
  for (int y = 0; y < out.height(); ++y)
    for (int x = 0; x < out.width(); ++x) out.row(y)[x] = model.mask.empty() || model.mask.at(x, y) >= 128 ? 1.f : 0.f;
  return out;
}

image::Plane<float> halved(const image::Plane<float>& fine) {
  image::Plane<float> out(fine.width() / 2, fine.height() / 2);
  for (int y = 0; y < out.height(); ++y) {
    const float* a = fine.row(2 * y);
    const float* b = fine.row(2 * y + 1);
    for (int x = 0; x < out.width(); ++x) out.row(y)[x] = 0.25f * (a[2 * x] + a[2 * x + 1] + b[2 * x] + b[2 * x + 1]);
  }
  return out;
}

void measure_mask(TemplatePyramid& t) {
  const image::Plane<float>& m = t.levels.front().coverage;
  double n = 0;
  double sx = 0;
  double sy = 0;
  double sq = 0;
  for (int y = 0; y < m.height(); ++y)
    for (int x = 0; x < m.width(); ++x) {
      const double w = m.at(x, y);
      n += w;
      sx += w * x;
      sy += w * y;
      sq += w * (static_cast<double>(x) * x + static_cast<double>(y) * y);
    }
  if (n < 1) throw std::invalid_argument("a model's mask must hold a part");
  t.area_px = n;
  t.anchor_x_px = sx / n;
  t.anchor_y_px = sy / n;
  t.rms_radius_px = std::sqrt(std::max(0.25, sq / n - t.anchor_x_px * t.anchor_x_px - t.anchor_y_px * t.anchor_y_px));
}

std::vector<std::pair<int, int>> disc(int radius_px) {
  std::vector<std::pair<int, int>> out;
  for (int dy = -radius_px; dy <= radius_px; ++dy)
    for (int dx = -radius_px; dx <= radius_px; ++dx)
      if (dx * dx + dy * dy <= radius_px * radius_px + radius_px / 2) out.emplace_back(dx, dy);
  return out;
}

/// Whether any pixel under the disc has the value; outside the picture counts as not having it.
ByteMask any_under_disc(const ByteMask& mask, int radius_px, std::uint8_t value, std::uint8_t found) {
  ByteMask out(mask.width(), mask.height());
  const auto offsets = disc(radius_px);
  for (int y = 0; y < mask.height(); ++y)
    for (int x = 0; x < mask.width(); ++x)
      out.at(x, y) =
          std::any_of(offsets.begin(), offsets.end(),
                      [&](auto d) {
                        const int u = x + d.first;
                        const int v = y + d.second;
                        return u >= 0 && v >= 0 && u < mask.width() && v < mask.height() && mask.at(u, v) == value;
                      })
              ? found
              : static_cast<std::uint8_t>(1 - found);
  return out;
}

}  // namespace

TemplatePyramid build_template_pyramid(const Model& model, int min_side_px) {
  if (model.picture.empty()) throw std::invalid_argument("a model needs a picture");
  if (!model.mask.empty() &&
      (model.mask.width() != model.picture.width() || model.mask.height() != model.picture.height()))
    throw std::invalid_argument("a model's mask must have the size of its picture");
  image::Pyramid grey;
  grey.build(model.picture.view(), min_side_px);
  TemplatePyramid out;
  out.masked = !model.mask.empty();
  image::Plane<float> coverage = full_coverage(model);
  for (int l = 0; l < grey.levels(); ++l) {
    if (l > 0) coverage = halved(coverage);
    out.levels.push_back({image::Image(grey.level(l)), coverage});
  }
  measure_mask(out);
  return out;
}

ByteMask mask_above(const image::Plane<float>& coverage, float limit) {
  ByteMask out(coverage.width(), coverage.height());
  for (int y = 0; y < out.height(); ++y)
    for (int x = 0; x < out.width(); ++x) out.at(x, y) = coverage.at(x, y) > limit ? 1 : 0;
  return out;
}

ByteMask dilate(const ByteMask& mask, int radius_px) { return any_under_disc(mask, radius_px, 1, 1); }

ByteMask erode(const ByteMask& mask, int radius_px) { return any_under_disc(mask, radius_px, 0, 0); }

int count(const ByteMask& mask) {
  int n = 0;
  for (int y = 0; y < mask.height(); ++y)
    for (int x = 0; x < mask.width(); ++x) n += mask.at(x, y);
  return n;
}

}  // namespace pickcell::matches
