#include "pickcell/matches/fit/match_score.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "pickcell/matches/fit/score_kernels.hpp"

namespace pickcell::matches {
namespace {

constexpr double kLeastField = 0.02;  // of the template's: weaker scene fields are no edges
constexpr double kLeastVariance = 25;
constexpr double kFewestPoints = 8;  // of a block

/// Mean of the blocks' correlations of edge directions. Points outside the picture find no edge.
double edges(LazyField& lazy, const EdgePoints& e, const LevelMap& m) {
  const image::View<std::int8_t> field = lazy.view();
  if (e.count == 0 || field.empty()) return 0;
  need_under(lazy, e, m);
  std::array<BlockEdges, kBlocks> blocks;
  sum_block_edges(field, e.columns(), m, e.blocks, blocks);
  double sum = 0, weight = 0;
  for (const BlockEdges& b : blocks) {
    const double own = static_cast<double>(b.own);
    if (own <= 0) continue;
    sum += own * static_cast<double>(b.both) / std::sqrt((static_cast<double>(b.scene) + kLeastField * own) * own);
    weight += own;
  }
  return weight > 0 ? sum / weight : 0;
}

/// Mean of the blocks' NCC over the points inside the picture.
double grey(image::ImageView level, const GreyPoints& p, const LevelMap& m, WeightedSamples& samples) {
  read_samples(level, p, m, samples);
  std::array<BlockMoments, kBlocks> blocks;
  sum_block_moments(p.columns(), samples.scene.data(), samples.weight.data(), p.blocks, blocks);
  double sum = 0, weight = 0;
  for (const BlockMoments& b : blocks) {
    const auto n = static_cast<double>(b.n);
    if (n < kFewestPoints) continue;
    const double s = static_cast<double>(b.s) / n, t = static_cast<double>(b.t) / n;
    const double var_s = std::max(0.0, static_cast<double>(b.ss) / n - s * s);
    const double var_t = std::max(0.0, static_cast<double>(b.tt) / n - t * t);
    const double together = static_cast<double>(b.st) / n - s * t;
    const double w = n * std::sqrt(var_t);
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
  return 0.2 * h.ncc + kEdgesInScore * by_edges + 0.2 * by_grey;
}

}  // namespace pickcell::matches
