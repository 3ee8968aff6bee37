#include "pickcell/matches/coarse/search.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <tuple>

#include "pickcell/matches/limits.hpp"

namespace pickcell::matches {
namespace {

constexpr float kNothing = -1.f;
constexpr float kLeastShare = 0.5f;  // of a part in the picture: what of less agrees says little
constexpr int kLookEach = 32;        // peaks between two looks at the clock

double angle_deg_of(const CoarseTemplates& t, int k) { return 360.0 * k / t.angles; }

bool tile_wanted(const CoarseTemplates& t, const CoarseTile& tile, Range range) {
  const double slack = 180.0 / t.angles;
  for (int a = 0; a < 4; ++a)
    if (angle_in_range(angle_deg_of(t, tile.first_angle + a), range, slack)) return true;
  return false;
}

/// The tile's taps as offsets in the scene's plane.
void set_offsets(const CoarseTile& tile, const CoarseScene& scene, std::vector<std::int32_t>& out) {
  out.resize(tile.dx.size());
  for (std::size_t k = 0; k < out.size(); ++k) out[k] = tile.dy[k] * scene.stride() + tile.dx[k];
}

FourTemplates templates_of(const CoarseTile& tile, const std::vector<std::int32_t>& offsets) {
  return {offsets,
          tile.weights,
          {tile.bias[0], tile.bias[1], tile.bias[2], tile.bias[3]},
          {tile.norm[0], tile.norm[1], tile.norm[2], tile.norm[3]}};
}

/// For each position along one axis: one over the share of the weight that is in the picture.
void set_gain(const std::vector<float>& before, int reach, int cells, std::vector<float>& gain) {
  gain.assign(static_cast<std::size_t>(cells), 1.f);
  const auto share_before = [&](int cell) {
    return before[static_cast<std::size_t>(std::clamp(cell + reach, 0, 2 * reach + 1))];
  };
  for (int i = 0; i < cells; ++i) {
    if (i == reach && cells - reach > i) i = cells - reach;  // between, everything is inside
    gain[static_cast<std::size_t>(i)] = 1 / std::max(kLeastShare, share_before(cells - i) - share_before(-i));
  }
}

float gain_of(float column, float row) { return std::min(column * row, 1 / kLeastShare); }

}  // namespace

void CoarseSearch::make_up(const Map& map, int y, int x_lo, int x_hi, float* row) {
  const float row_gain = map.row_gain[static_cast<std::size_t>(y)];
  const float* column_gain = map.column_gain.data();
  for (int x = x_lo; x < x_hi; ++x) row[x] *= gain_of(column_gain[x], row_gain);
}

float CoarseSearch::made_up(const Map& map, int x, int y, float score) {
  return score * gain_of(map.column_gain[static_cast<std::size_t>(x)], map.row_gain[static_cast<std::size_t>(y)]);
}

CoarseSearch::Span CoarseSearch::positions(int cells, int low, int high, double factor, const double* box_lo,
                                           const double* box_hi) {
  Span s{std::max(0, -low), std::min(cells, cells - high)};
  if (box_lo) s.lo = std::max(s.lo, static_cast<int>(std::floor((*box_lo + 0.5) / factor - 0.5)));
  if (box_hi) s.hi = std::min(s.hi, static_cast<int>(std::ceil((*box_hi + 0.5) / factor - 0.5)) + 1);
  return s;
}

void CoarseSearch::fill(Map& map, const CoarseScene& scene, const CoarseTemplates& t, const CoarseTile& tile,
                        const CoarseRequest& request) {
  map.score.resize(scene.width + kKernelBlock, scene.height);
  map.row_best.assign(static_cast<std::size_t>(scene.height), kNothing);
  const auto* box = request.box ? &*request.box : nullptr;
  const auto columns = [&](const CoarseTile::Sides& s) {
    return positions(scene.width, s.left, s.right, t.factor, box ? &box->x0 : nullptr, box ? &box->x1 : nullptr);
  };
  const auto rows = [&](const CoarseTile::Sides& s) {
    return positions(scene.height, s.top, s.bottom, t.factor, box ? &box->y0 : nullptr, box ? &box->y1 : nullptr);
  };
  map.columns = columns(tile.found);
  map.rows = rows(tile.found);
  const Span xs = request.border ? columns(tile.named) : map.columns;
  const Span ys = request.border ? rows(tile.named) : map.rows;
  set_offsets(tile, scene, map.offsets);
  set_gain(tile.left_of, t.reach, scene.width, map.column_gain);
  set_gain(tile.above, t.reach, scene.height, map.row_gain);
  const FourTemplates four = templates_of(tile, map.offsets);
  if (ys.lo < ys.hi && xs.lo < xs.hi)
    best_of_four({scene.at(xs.lo, ys.lo), scene.stride(), xs.hi - xs.lo, ys.hi - ys.lo}, four,
                 map.score.row(ys.lo) + xs.lo, map.score.stride());
  for (int y = 0; y < scene.height; ++y) {
    float* row = map.score.row(y);
    if (y < ys.lo || y >= ys.hi || xs.lo >= xs.hi) {
      std::fill(row, row + scene.width, kNothing);
      continue;
    }
    std::fill(row, row + xs.lo, kNothing);
    std::fill(row + xs.hi, row + scene.width, kNothing);
    const bool whole_row = y >= t.reach && y < scene.height - t.reach;
    const int left_end = whole_row ? std::min(xs.hi, t.reach) : xs.hi;
    make_up(map, y, xs.lo, left_end, row);
    make_up(map, y, std::max({xs.lo, left_end, scene.width - t.reach}), xs.hi, row);
    map.row_best[static_cast<std::size_t>(y)] = *std::max_element(row + xs.lo, row + xs.hi);
  }
}

bool CoarseSearch::is_peak(const CoarseTemplates& t, const Peak& p) const {
  const int per_scale = t.angles / 4;
  const int scale = p.tile / per_scale;
  const int turn = p.tile % per_scale;
  // Equal neighbours: the earlier one in (tile, y, x) wins, so that a plateau gives one peak.
  const auto beaten_by = [&](int tile, int y, int x, bool earlier) {
    const Map& m = maps_[static_cast<std::size_t>(tile)];
    if (!m.searched) return false;
    const float other = m.score.at(x, y);
    return other > p.score || (other == p.score && earlier);
  };
  if (per_scale > 1) {
    const int before = scale * per_scale + (turn + per_scale - 1) % per_scale;
    const int after = scale * per_scale + (turn + 1) % per_scale;
    if (beaten_by(before, p.y, p.x, before < p.tile) || beaten_by(after, p.y, p.x, after < p.tile)) return false;
  }
  if (scale > 0 && beaten_by(p.tile - per_scale, p.y, p.x, true)) return false;
  if (scale + 1 < static_cast<int>(t.scales.size()) && beaten_by(p.tile + per_scale, p.y, p.x, false)) return false;
  const image::Plane<float>& own = maps_[static_cast<std::size_t>(p.tile)].score;
  for (int y = std::max(0, p.y - 1); y <= std::min(own.height() - 1, p.y + 1); ++y)
    for (int x = std::max(0, p.x - 1); x <= std::min(own.width() - kKernelBlock - 1, p.x + 1); ++x)
      if ((x != p.x || y != p.y) && beaten_by(p.tile, y, x, y < p.y || (y == p.y && x < p.x))) return false;
  return true;
}

void CoarseSearch::find_local_maxima(const CoarseTemplates& t, float limit, bool border) {
  all_.clear();
  for (std::size_t i = 0; i < t.tiles.size(); ++i) {
    const Map& m = maps_[i];
    if (!m.searched) continue;
    for (int y = 0; y < m.score.height(); ++y) {
      if (m.row_best[static_cast<std::size_t>(y)] <= limit) continue;
      const float* row = m.score.row(y);
      for (int x = 0; x < m.score.width() - kKernelBlock; ++x) {
        if (row[x] <= limit) continue;
        if (border && m.columns.has(x) && m.rows.has(y)) continue;
        const Peak p{row[x], static_cast<int>(i), y, x};
        if (is_peak(t, p)) all_.push_back(p);
      }
    }
  }
  std::sort(all_.begin(), all_.end(), [](const Peak& a, const Peak& b) {
    return a.score != b.score ? a.score > b.score : std::tie(a.tile, a.y, a.x) < std::tie(b.tile, b.y, b.x);
  });
}

void CoarseSearch::run(const CoarseScene& scene, const CoarseTemplates& t, const CoarseRequest& request,
                       WorkBudget& budget, std::pmr::vector<CoarseCandidate>& out) {
  if (maps_.size() < t.tiles.size()) maps_.resize(t.tiles.size());
  parallel_for(static_cast<int>(t.tiles.size()), request.threads, [&](int i, int) {
    const CoarseTile& tile = t.tiles[static_cast<std::size_t>(i)];
    Map& map = maps_[static_cast<std::size_t>(i)];
    map.searched = tile_wanted(t, tile, request.angle_deg) && !budget.spent();
    if (map.searched) fill(map, scene, t, tile, request);
  });
  float best = 0;
  for (std::size_t i = 0; i < t.tiles.size(); ++i)
    if (maps_[i].searched)
      for (float b : maps_[i].row_best) best = std::max(best, b);
  find_local_maxima(t, std::max(request.limit, request.relative_limit * best), request.border);

  const double near_cells = 0.25 * t.side;
  const auto near = [&](const Peak& p, const Peak& q) {
    const int dx = p.x - q.x, dy = p.y - q.y;
    return dx * dx + dy * dy <= near_cells * near_cells;
  };
  out.clear();
  taken_.clear();
  int looked = 0;
  for (const Peak& p : all_) {
    if (static_cast<int>(out.size()) >= request.candidates) break;
    if (++looked % kLookEach == 0 && budget.spent()) break;
    const auto here = std::count_if(taken_.begin(), taken_.end(), [&](const Peak& q) { return near(p, q); });
    if (here >= request.per_location) continue;
    taken_.push_back(p);
    const CoarseTile& tile = t.tiles[static_cast<std::size_t>(p.tile)];
    float four[4];
    each_of_four(scene.at(p.x, p.y), templates_of(tile, maps_[static_cast<std::size_t>(p.tile)].offsets), four);
    int which = -1;
    for (int a = 0; a < 4; ++a)
      if (angle_in_range(angle_deg_of(t, tile.first_angle + a), request.angle_deg, 180.0 / t.angles) &&
          (which < 0 || four[a] > four[which]))
        which = a;
    out.push_back({{(p.x + 0.5) * t.factor - 0.5, (p.y + 0.5) * t.factor - 0.5,
                    wrap_rad(2 * std::numbers::pi * (tile.first_angle + which) / t.angles),
                    t.scales[static_cast<std::size_t>(tile.scale_index)]},
                   made_up(maps_[static_cast<std::size_t>(p.tile)], p.x, p.y, four[which])});
  }
}

}  // namespace pickcell::matches
