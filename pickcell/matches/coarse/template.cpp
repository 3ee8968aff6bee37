#include "pickcell/matches/coarse/template.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "pickcell/matches/coarse/scene.hpp"
#include "pickcell/matches/fields/orientation_field.hpp"

namespace pickcell::matches {
namespace {

constexpr float kWeightOfOne = 100.f;    // weights are rounded to bytes
constexpr float kLeastMagnitude = 0.1f;  // weaker places add taps, not information
constexpr int kOutlineDilation_px = 2;   // the outline counts, although half of its gradient lies outside the mask
constexpr double kMostCells = 1e8;
constexpr int kWorkRounds = 3;
constexpr double kBandRatio = 1.42;   // 0.5 to 2 makes four bands
constexpr double kNamedShare = 0.5;   // a part at the border that shows less is not told from the ground
constexpr double kSquareRms = 0.816;  // rms radius of a square over its half side

/// A sample of the template's orientation tensor: place relative to the anchor (level-0 pixels) and value.
struct Sample {
  float x, y;
  float c2, s2, energy;
};

std::vector<Sample> samples_of(const TemplatePyramid& t, int level, int per_side) {
  const TemplateLevel& l = t.levels[static_cast<std::size_t>(level)];
  const ByteMask wanted = dilate(mask_above(l.coverage, 0.5f), kOutlineDilation_px);
  const double k = std::ldexp(1.0, level);
  std::vector<Sample> out;
  const std::size_t room = static_cast<std::size_t>(wanted.width()) + kTensorSlack;
  std::vector<float> c2(room), s2(room), energy(room);
  for (int y = 0; y < wanted.height(); ++y) {
    orientation_tensor_row(l.grey.view(), y, {c2.data(), s2.data(), energy.data()});
    for (int x = 0; x < wanted.width(); ++x) {
      if (!wanted.at(x, y)) continue;
      const auto i0 = static_cast<std::size_t>(x);
      for (int j = 0; j < per_side; ++j)
        for (int i = 0; i < per_side; ++i)
          out.push_back({static_cast<float>((x + (i + 0.5) / per_side) * k - 0.5 - t.anchor_x_px),
                         static_cast<float>((y + (j + 0.5) / per_side) * k - 0.5 - t.anchor_y_px), c2[i0], s2[i0],
                         energy[i0]});
    }
  }
  return out;
}

/// Square grid of cells about the anchor's.
struct Grid {
  int reach;
  int side;
  std::vector<float> c2, s2, energy;
  explicit Grid(int r) : reach(r), side(2 * r + 1), c2(size()), s2(size()), energy(size()) {}
  [[nodiscard]] std::size_t size() const { return static_cast<std::size_t>(side) * static_cast<std::size_t>(side); }
};

/// Byte weights of one template, two per cell. Adds the samples of each cell to area.
std::vector<std::int16_t> turned(const std::vector<Sample>& samples, double angle_rad, double cells_per_px,
                                 float sample_area, int reach, std::vector<float>& area) {
  Grid g(reach);
  const auto a = static_cast<float>(cells_per_px * std::cos(angle_rad));
  const auto b = static_cast<float>(cells_per_px * std::sin(angle_rad));
  for (const Sample& s : samples) {
    const int x = static_cast<int>(std::floor(a * s.x + b * s.y + 0.5f)) + reach;
    const int y = static_cast<int>(std::floor(-b * s.x + a * s.y + 0.5f)) + reach;
    if (x < 0 || y < 0 || x >= g.side || y >= g.side) continue;
    const auto i = static_cast<std::size_t>(y * g.side + x);
    g.c2[i] += s.c2;
    g.s2[i] += s.s2;
    g.energy[i] += s.energy;
    area[i] += 1;
  }
  const auto ca = static_cast<float>(std::cos(2 * angle_rad));
  const auto sa = static_cast<float>(std::sin(2 * angle_rad));
  std::vector<std::int16_t> out(2 * g.size());
  for (std::size_t i = 0; i < g.size(); ++i) {
    const float k = sample_area / (g.energy[i] * sample_area + kEdgeGrey * kEdgeGrey);
    const float c = k * (g.c2[i] * ca + g.s2[i] * sa);
    const float s = k * (g.s2[i] * ca - g.c2[i] * sa);
    if (std::hypot(c, s) < kLeastMagnitude) continue;
    out[2 * i] = static_cast<std::int16_t>(std::lrintf(kWeightOfOne * c));
    out[2 * i + 1] = static_cast<std::int16_t>(std::lrintf(kWeightOfOne * s));
  }
  return out;
}

/// Value below which the given share of the weight lies.
int weighted_quantile(const std::vector<int>& values, const std::vector<float>& weights, double share) {
  std::vector<std::size_t> order(values.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  std::sort(order.begin(), order.end(), [&](std::size_t p, std::size_t q) { return values[p] < values[q]; });
  double total = 0;
  for (float w : weights) total += w;
  double sum = 0;
  for (std::size_t i : order)
    if ((sum += weights[i]) >= share * total) return values[i];
  return 0;
}

using FourPlanes = std::vector<std::int16_t>[4];

/// The sum over the four templates of |weight| at a cell.
float magnitude_at(const FourPlanes& planes, std::size_t i) {
  float m = 0;
  for (const auto& p : planes) m += std::abs(static_cast<float>(p[2 * i])) + std::abs(static_cast<float>(p[2 * i + 1]));
  return m;
}

/// How far positions may lie outside so that a share of something on the grid of cells is still in the picture: along
/// each axis by itself, since what a corner cuts off is more.
CoarseTile::Sides sides_of(const std::vector<float>& on_cell, int reach, double share) {
  const int side = 2 * reach + 1;
  std::vector<int> xs, ys;
  std::vector<float> weights;
  for (int y = 0; y < side; ++y)
    for (int x = 0; x < side; ++x)
      if (const float w = on_cell[static_cast<std::size_t>(y * side + x)]; w > 0) {
        xs.push_back(x - reach);
        ys.push_back(y - reach);
        weights.push_back(w);
      }
  return {weighted_quantile(xs, weights, 1 - share), weighted_quantile(xs, weights, share),
          weighted_quantile(ys, weights, 1 - share), weighted_quantile(ys, weights, share)};
}

/// What is asked for is a share of the area; a part whose edges all lie in its other half is looked for there, too.
void set_sides(CoarseTile& tile, const FourPlanes& planes, const std::vector<float>& area, int reach,
               double min_visible) {
  std::vector<float> edges(area.size());
  for (std::size_t i = 0; i < edges.size(); ++i) edges[i] = magnitude_at(planes, i);
  const auto sides = [&](double share) {
    const CoarseTile::Sides a = sides_of(area, reach, share), e = sides_of(edges, reach, share);
    return CoarseTile::Sides{std::max(a.left, e.left), std::min(a.right, e.right), std::max(a.top, e.top),
                             std::min(a.bottom, e.bottom)};
  };
  tile.found = sides(min_visible);
  tile.named = sides(std::min(kNamedShare, min_visible));
}

/// tile.left_of, tile.above.
void set_shares(CoarseTile& tile, const FourPlanes& planes, int reach) {
  const int side = 2 * reach + 1;
  tile.left_of.assign(static_cast<std::size_t>(side) + 1, 0);
  tile.above.assign(static_cast<std::size_t>(side) + 1, 0);
  for (int y = 0; y < side; ++y)
    for (int x = 0; x < side; ++x) {
      const float m = magnitude_at(planes, static_cast<std::size_t>(y * side + x));
      tile.left_of[static_cast<std::size_t>(x) + 1] += m;
      tile.above[static_cast<std::size_t>(y) + 1] += m;
    }
  for (std::vector<float>* sums : {&tile.left_of, &tile.above}) {
    std::partial_sum(sums->begin(), sums->end(), sums->begin());
    if (const float all = sums->back(); all > 0)
      for (float& v : *sums) v /= all;
  }
}

/// Walks each row from the left: a cell with weight and its right neighbour make a tap.
CoarseTile make_tile(const FourPlanes& planes, int reach) {
  CoarseTile tile;
  const int side = 2 * reach + 1;
  double sum[4] = {};
  for (int y = 0; y < side; ++y)
    for (int x = 0; x < side; ++x) {
      const auto i = static_cast<std::size_t>(y * side + x);
      if (magnitude_at(planes, i) == 0) continue;
      tile.dx.push_back(static_cast<std::int16_t>(x - reach));
      tile.dy.push_back(static_cast<std::int16_t>(y - reach));
      const std::size_t cells = x + 1 < side ? 2 : 1;
      for (std::size_t a = 0; a < 4; ++a)
        for (std::size_t q = 0; q < 2; ++q) {
          const int c = q < cells ? planes[a][2 * (i + q)] : 0;
          const int s = q < cells ? planes[a][2 * (i + q) + 1] : 0;
          tile.weights.push_back(static_cast<std::int8_t>(c));
          tile.weights.push_back(static_cast<std::int8_t>(s));
          tile.bias[a] -= 128 * (c + s);
          sum[a] += std::hypot(c, s);
        }
      ++x;  // the neighbour is done
    }
  for (int a = 0; a < 4; ++a) tile.norm[a] = sum[a] > 0 ? static_cast<float>(1 / (127 * sum[a])) : 0.f;
  return tile;
}

double rim_cells(const TemplatePyramid& t, double factor) { return t.rms_radius_px / kSquareRms / factor; }

std::vector<double> scale_steps(Range scale, double rim, double step) {
  const int n = std::max(1, static_cast<int>(std::ceil((scale.hi - scale.lo) * rim / step)));
  std::vector<double> out;
  for (int i = 0; i < n; ++i) out.push_back(scale.lo * std::pow(scale.hi / scale.lo, (i + 0.5) / n));
  return out;
}

/// The scale of the range at which the template's own cells are counted.
double nominal(Range scale) { return std::clamp(1.0, scale.lo, scale.hi); }

int angle_count(double rim, const CoarseDetail& d) {
  return 4 * std::max(2, static_cast<int>(std::ceil(2 * std::numbers::pi * rim / d.angle_step / 4)));
}

/// About as many cells as the templates of a factor are made of, empty ones included.
double cells_to_fill(const TemplatePyramid& t, const CoarseDetail& d, Range scale, double factor) {
  const double side = std::hypot(t.width(), t.height()) * scale.hi / factor + 3;
  const double scales = static_cast<double>(scale_steps(scale, rim_cells(t, factor), d.scale_step).size());
  return angle_count(rim_cells(t, factor / nominal(scale)), d) * scales * side * side;
}

CoarseTemplates build_with_factor(const TemplatePyramid& t, const CoarseDetail& d, Range scale, double factor) {
  CoarseTemplates out;
  out.factor = factor;
  const double own_factor = factor / nominal(scale);
  const int level = std::min(field_level(std::max(1.0, own_factor)), static_cast<int>(t.levels.size()) - 1);
  const double rim = rim_cells(t, own_factor);
  out.angles = angle_count(rim, d);
  out.scales = scale_steps(scale, rim_cells(t, out.factor), d.scale_step);
  out.side = std::max(1, static_cast<int>(std::lround(std::sqrt(t.area_px) / out.factor)));

  const int per_side = own_factor < 2 ? 4 : 2;
  const std::vector<Sample> samples = samples_of(t, level, per_side);
  double furthest = 0;
  for (const Sample& s : samples) furthest = std::max(furthest, std::hypot(s.x, static_cast<double>(s.y)));
  out.reach = static_cast<int>(std::ceil(furthest * out.scales.back() / out.factor)) + 1;

  for (std::size_t s = 0; s < out.scales.size(); ++s) {
    const double cells_per_px = out.scales[s] / out.factor;
    const double sample_side = std::ldexp(cells_per_px, level) / per_side;
    for (int a0 = 0; a0 < out.angles; a0 += 4) {
      std::vector<std::int16_t> planes[4];
      std::vector<float> area((2 * static_cast<std::size_t>(out.reach) + 1) *
                              (2 * static_cast<std::size_t>(out.reach) + 1));
      for (int a = 0; a < 4; ++a)
        planes[a] = turned(samples, 2 * std::numbers::pi * (a0 + a) / out.angles, cells_per_px,
                           static_cast<float>(sample_side * sample_side), out.reach, area);
      CoarseTile tile = make_tile(planes, out.reach);
      tile.scale_index = static_cast<int>(s);
      tile.first_angle = a0;
      set_sides(tile, planes, area, out.reach, d.min_visible);
      set_shares(tile, planes, out.reach);
      out.tiles.push_back(std::move(tile));
    }
  }
  return out;
}

}  // namespace

double choose_factor(const TemplatePyramid& t, const CoarseDetail& d) {
  const double w = t.width();
  const double h = t.height();
  double f = std::min(std::sqrt(w * h) / d.side_cells, std::min(w, h) / d.short_cells);
  if (t.masked) f = std::min(f, std::sqrt(t.area_px) / d.mask_cells);
  return std::max(1.0, f);
}

double CoarseTemplates::work() const {
  double taps = 0;
  for (const CoarseTile& tile : tiles) taps += static_cast<double>(tile.dx.size());
  return 4 * taps * 640 * 480 / (factor * factor) * 1e-6;
}

CoarseTemplates build_coarse_templates(const TemplatePyramid& t, const CoarseDetail& d, Range scale) {
  double factor = std::max(1.0, nominal(scale) * choose_factor(t, d));
  // A wire of 800 pixels would ask for cells of one pixel, thousands of angles and minutes of building.
  for (double cells = 0; (cells = cells_to_fill(t, d, scale, factor)) > kMostCells;)
    factor *= 1.02 * std::pow(cells / kMostCells, 0.25);
  CoarseTemplates out = build_with_factor(t, d, scale, factor);
  for (int round = 0; round < kWorkRounds && out.work() > d.most_work; ++round) {
    factor *= std::pow(1.05 * out.work() / d.most_work, 0.2);
    out = build_with_factor(t, d, scale, factor);
  }
  return out;
}

std::vector<CoarseTemplates> build_coarse_bands(const TemplatePyramid& t, const CoarseDetail& d, Range scale) {
  const double ratio = scale.hi / scale.lo;
  const int n = std::max(1, static_cast<int>(std::ceil(std::log(ratio) / std::log(kBandRatio) - 1e-9)));
  std::vector<CoarseTemplates> out;
  for (int i = 0; i < n; ++i)
    out.push_back(build_coarse_templates(t, d,
                                         {scale.lo * std::pow(ratio, static_cast<double>(i) / n),
                                          i + 1 == n ? scale.hi : scale.lo * std::pow(ratio, (i + 1.0) / n)}));
  return out;
}

}  // namespace pickcell::matches
