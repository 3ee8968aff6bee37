#include "pickcell/matches/match_score.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace pickcell::matches {
namespace {

constexpr int kBlocks = 4;            // per side
constexpr double kLeastField = 0.02;  // of the template's: weaker scene fields are no edges
constexpr double kLeastVariance = 25;
constexpr double kFewestPoints = 8;  // of a block

/// Lays the blocks over a box.
class Grid {
 public:
  Grid(float x_lo, float x_hi, float y_lo, float y_hi)
      : x_lo_(x_lo), y_lo_(y_lo), per_x_(kBlocks / (x_hi - x_lo + 1e-3f)), per_y_(kBlocks / (y_hi - y_lo + 1e-3f)) {}
  [[nodiscard]] std::size_t at(float x, float y) const {
    const int column = std::clamp(static_cast<int>((x - x_lo_) * per_x_), 0, kBlocks - 1);
    const int row = std::clamp(static_cast<int>((y - y_lo_) * per_y_), 0, kBlocks - 1);
    return static_cast<std::size_t>(row * kBlocks + column);
  }

 private:
  float x_lo_, y_lo_, per_x_, per_y_;
};

template <class Block>
using Blocks = std::array<Block, kBlocks * kBlocks>;

/// Mean of the blocks' correlations of edge directions. Points outside the picture find no edge.
double edges(LazyField& lazy, const EdgePoints& e, const LevelMap& m) {
  struct Block {
    double both = 0, scene = 0, own = 0;
  };
  const image::View<std::int8_t> field = lazy.view();
  if (e.count == 0 || field.empty()) return 0;
  need_under(lazy, e, m);
  const Grid grid(e.x_lo, e.x_hi, e.y_lo, e.y_hi);
  const float norm = 1 / (m.a * m.a + m.b * m.b);
  const float c = (m.a * m.a - m.b * m.b) * norm, s = 2 * m.a * m.b * norm;  // of twice the angle
  Blocks<Block> blocks{};
  for (std::size_t i = 0; i < static_cast<std::size_t>(e.count); ++i) {
    Block& b = blocks[grid.at(e.x[i], e.y[i])];
    b.own += static_cast<double>(e.c2[i] * e.c2[i] + e.s2[i] * e.s2[i]);
    const auto x = static_cast<int>(std::lrintf(m.x + m.a * e.x[i] + m.b * e.y[i]));
    const auto y = static_cast<int>(std::lrintf(m.y - m.b * e.x[i] + m.a * e.y[i]));
    if (x < 0 || y < 0 || 2 * x + 1 >= field.width() || y >= field.height()) continue;
    const float fc = static_cast<float>(field.at(2 * x, y)) / 127.f;
    const float fs = static_cast<float>(field.at(2 * x + 1, y)) / 127.f;
    b.both += static_cast<double>(fc * (e.c2[i] * c + e.s2[i] * s) + fs * (e.s2[i] * c - e.c2[i] * s));
    b.scene += static_cast<double>(fc * fc + fs * fs);
  }
  double sum = 0, weight = 0;
  for (const Block& b : blocks) {
    if (b.own <= 0) continue;
    sum += b.own * b.both / std::sqrt((b.scene + kLeastField * b.own) * b.own);
    weight += b.own;
  }
  return weight > 0 ? sum / weight : 0;
}

/// Mean of the blocks' NCC over the points inside the picture.
double grey(image::ImageView level, const GreyPoints& p, const LevelMap& m, WeightedSamples& samples) {
  struct Block {
    double n = 0, s = 0, ss = 0, t = 0, tt = 0, st = 0;
  };
  read_samples(level, p, m, samples);
  const Grid grid(p.x_lo, p.x_hi, p.y_lo, p.y_hi);
  Blocks<Block> blocks{};
  for (std::size_t i = 0; i < static_cast<std::size_t>(p.size()); ++i) {
    if (samples.weight[i] == 0.f) continue;
    Block& b = blocks[grid.at(p.qx[i], p.qy[i])];
    const double s = samples.scene[i], t = p.t[i];
    b.n += 1;
    b.s += s;
    b.ss += s * s;
    b.t += t;
    b.tt += t * t;
    b.st += s * t;
  }
  double sum = 0, weight = 0;
  for (const Block& b : blocks) {
    if (b.n < kFewestPoints) continue;
    const double var_s = std::max(0.0, b.ss / b.n - b.s / b.n * (b.s / b.n));
    const double var_t = std::max(0.0, b.tt / b.n - b.t / b.n * (b.t / b.n));
    const double together = b.st / b.n - b.s / b.n * (b.t / b.n);
    const double w = b.n * std::sqrt(var_t);
    sum += w * together / std::sqrt((var_s + kLeastVariance) * (var_t + kLeastVariance));
    weight += w;
  }
  return weight > 0 ? sum / weight : 0;
}

}  // namespace

double match_score(const SceneLevel& scene, const LevelModel& model, const Hypothesis& h, RefineScratch& scratch) {
  const LevelMap map = at_level(h.place, scene.level);
  const double by_edges = edges(*scene.field, model.edges, map);
  const double by_grey = model.grey.flat() ? by_edges : grey(scene.grey, model.grey, map, scratch.grey);
  return 0.2 * h.ncc + 0.6 * by_edges + 0.2 * by_grey;
}

}  // namespace pickcell::matches
