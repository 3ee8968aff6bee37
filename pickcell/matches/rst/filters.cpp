#include "pickcell/matches/rst/filters.hpp"

#include <algorithm>
#include <cmath>
#include <tuple>

namespace pickcell::matches {
namespace {

constexpr int kChunk = 64;         // candidates of step 3 per piece of work
constexpr int kRadialChunk = 256;  // of step 2
constexpr int kRowChunk = 8;       // rows of step 1

int pieces_of(int work, int chunk) { return (work + chunk - 1) / chunk; }

/// What the workers of one step put down, in the order of the work.
struct Pieces {
  std::vector<std::vector<RstCandidate>> kept, dropped;
  std::vector<std::int64_t> compared;
  explicit Pieces(int n)
      : kept(static_cast<std::size_t>(n)),
        dropped(static_cast<std::size_t>(n)),
        compared(static_cast<std::size_t>(n)) {}

  void collect(RstStep& out) const {
    std::size_t all = 0;
    for (const auto& piece : kept) all += piece.size();
    out.kept.reserve(all);
    for (const auto& piece : kept) out.kept.insert(out.kept.end(), piece.begin(), piece.end());
    for (const auto& piece : dropped) out.dropped.insert(out.dropped.end(), piece.begin(), piece.end());
    out.report.survivors = static_cast<std::int64_t>(out.kept.size());
  }
  [[nodiscard]] std::int64_t total() const {
    std::int64_t sum = 0;
    for (const std::int64_t n : compared) sum += n;
    return sum;
  }
};

/// Brightness and contrast gates of Kim & de Araujo for a position that passed: how the picture's features follow from
/// the template's.
bool passes_gates(const RstTask& task, const float* means, std::ptrdiff_t stride, int scale,
                  const std::vector<std::vector<float>>& query_means) {
  const RstSettings& s = task.settings;
  if (s.t_contrast <= 0 && s.t_brightness >= 1) return true;
  const std::vector<float>& x = query_means[static_cast<std::size_t>(scale)];
  double mx = 0, my = 0, xx = 0, xy = 0;
  const auto n = static_cast<double>(x.size());
  for (std::size_t k = 0; k < x.size(); ++k) {
    mx += x[k] / n;
    my += means[static_cast<std::ptrdiff_t>(k) * stride] / n;
  }
  for (std::size_t k = 0; k < x.size(); ++k) {
    xx += (x[k] - mx) * (x[k] - mx);
    xy += (x[k] - mx) * (means[static_cast<std::ptrdiff_t>(k) * stride] - my);
  }
  const double beta = xy / xx, gamma = my - beta * mx;
  if (s.t_contrast > 0 && (std::abs(beta) <= s.t_contrast || std::abs(beta) >= 1 / s.t_contrast)) return false;
  return s.t_brightness >= 1 || std::abs(gamma) <= 255 * s.t_brightness;
}

bool better(const RstCandidate& a, const RstCandidate& b) {
  if (a.score != b.score) return a.score > b.score;
  return std::tie(a.y, a.x, a.scale, a.shift) < std::tie(b.y, b.x, b.scale, b.shift);
}

/// The candidate worth naming when a step drops many: the best about the watched place, or of all.
void keep_best_dropped(const RstTask& task, std::vector<RstCandidate>& dropped) {
  if (task.options.watch) {
    const double near = std::ldexp(1.5, task.model.level);
    std::erase_if(dropped, [&](const RstCandidate& c) {
      const Pose2d p = task.pose(c);
      return std::hypot(p.x_px - task.options.watch->x_px, p.y_px - task.options.watch->y_px) > near;
    });
  }
  if (dropped.empty()) return;
  std::iter_swap(dropped.begin(), std::min_element(dropped.begin(), dropped.end(), better));
  dropped.resize(1);
}

}  // namespace

Pose2d RstTask::pose(const RstCandidate& c) const {
  const double block = std::ldexp(1.0, model.level);
  return model.pose(block * c.x + (block - 1) / 2, block * c.y + (block - 1) / 2, c.shift * settings.angle_step_deg,
                    model.scales[static_cast<std::size_t>(c.scale)]);
}

RstPositions positions(const RstTask& task) {
  const int m = task.model.margin;
  RstPositions p{m, m, task.coarse.width() - 1 - m, task.coarse.height() - 1 - m};
  if (const auto& roi = task.options.roi) {
    const double block = std::ldexp(1.0, task.model.level);
    const double slack = std::hypot(task.model.ref_dx, task.model.ref_dy) * task.model.scales.back() + block;
    p.x_lo = std::max(p.x_lo, static_cast<int>(std::floor((roi->x - slack) / block)));
    p.y_lo = std::max(p.y_lo, static_cast<int>(std::floor((roi->y - slack) / block)));
    p.x_hi = std::min(p.x_hi, static_cast<int>(std::ceil((roi->x + roi->w + slack) / block)));
    p.y_hi = std::min(p.y_hi, static_cast<int>(std::ceil((roi->y + roi->h + slack) / block)));
  }
  return p;
}

namespace {

/// Step 1 on one row; keeps its memory from row to row.
class CircularRow {
 public:
  void run(const RstTask& task, const OffsetLists& circles, const RstPositions& p, int y,
           std::vector<RstCandidate>& kept, std::vector<RstCandidate>& dropped) {
    const int width = p.x_hi - p.x_lo + 1;
    const auto room = static_cast<std::size_t>((width + kRstBlock - 1) / kRstBlock * kRstBlock);
    const auto stride = static_cast<std::ptrdiff_t>(room);
    means_.resize(room * circles.inverse_length.size());
    best_.resize(room);
    scale_.resize(room);
    mean_lists(task.coarse.row(y) + p.x_lo, circles, width, means_.data(), stride);
    score_rings(means_.data(), stride, width, task.model.rings, best_.data(), scale_.data());
    for (int i = 0; i < width; ++i) {
      const auto at = static_cast<std::size_t>(i);
      const auto score = static_cast<double>(best_[at]);
      if (!task.options.explain && !(score > task.settings.t1)) continue;  // nearly all
      const RstCandidate c{p.x_lo + i, y, scale_[at], 0, score, 1};
      if (score > task.settings.t1 && passes_gates(task, means_.data() + i, stride, c.scale, task.model.ring_means))
        kept.push_back(c);
      else if (task.options.explain)
        dropped.push_back(c);
    }
  }

 private:
  std::vector<float> means_, best_;
  std::vector<std::int32_t> scale_;
};

}  // namespace

RstStep circular_filter(const RstTask& task) {
  RstStep out;
  out.report.stage = name(Stage::circular);
  const RstPositions p = positions(task);
  const int width = p.x_hi - p.x_lo + 1, rows = p.y_hi - p.y_lo + 1;
  if (width <= 0 || rows <= 0) return out;
  const OffsetLists circles = offsets_for(task.model.circles, task.coarse.stride());
  std::vector<CircularRow> workers(static_cast<std::size_t>(task.threads));
  const int n = pieces_of(rows, kRowChunk);
  Pieces pieces(n);
  parallel_for(n, task.threads, [&](int i, int worker) {
    const auto piece = static_cast<std::size_t>(i);
    for (int row = i * kRowChunk; row < std::min(rows, (i + 1) * kRowChunk); ++row) {
      if (task.budget.spent()) return;
      workers[static_cast<std::size_t>(worker)].run(task, circles, p, p.y_lo + row, pieces.kept[piece],
                                                    pieces.dropped[piece]);
      pieces.compared[piece] += static_cast<std::int64_t>(width) * static_cast<std::int64_t>(task.model.scales.size());
    }
  });
  pieces.collect(out);
  keep_best_dropped(task, out.dropped);
  out.report.population = static_cast<std::int64_t>(width) * rows;
  out.report.feature_count = pieces.total();
  return out;
}

namespace {

/// Radial features of candidates that stand together in a row are read in one go.
class RadialPiece {
 public:
  RadialPiece(const RstTask& task, std::span<const OffsetLists> lines) : task_(task), lines_(lines) {}

  /// candidates: in the order of rows.
  void run(std::span<const RstCandidate> candidates, std::vector<RstCandidate>& kept,
           std::vector<RstCandidate>& dropped, std::int64_t& compared) {
    for (RstCandidate c : candidates) {
      const std::size_t table = lines_.size() == 1 ? 0 : static_cast<std::size_t>(c.scale);
      read(c, table);
      const RadialQuery& query = task_.model.radial(c.scale).query;
      set_radial_features(means_.data() + (c.x - x_), kTogether, query.lines, features_);
      const bool negative = task_.settings.match_negative;
      const ShiftScore s = task_.variant == RstVariant::erst ? shift_by_ncc(query, features_, task_.shifts, negative)
                                                             : shift_by_dot(query, features_, task_.shifts, negative);
      compared += s.compared;
      c.shift = s.shift;
      c.score = s.ncc;
      if (c.score > task_.settings.t2)
        kept.push_back(c);
      else if (task_.options.explain)
        dropped.push_back(c);
    }
  }

 private:
  static constexpr int kTogether = kRstBlock / 2;  // candidates stand in small groups

  void read(const RstCandidate& c, std::size_t table) {
    if (y_ == c.y && table_ == table && c.x >= x_ && c.x < x_ + kTogether) return;
    x_ = c.x;
    y_ = c.y;
    table_ = table;
    means_.resize(lines_[table].inverse_length.size() * kTogether);
    mean_lists(task_.coarse.row(y_) + x_, lines_[table], kTogether, means_.data(), kTogether);
  }

  const RstTask& task_;
  std::span<const OffsetLists> lines_;
  std::vector<float> means_;
  RadialFeatures features_;
  int x_ = -1, y_ = -1;
  std::size_t table_ = 0;
};

}  // namespace

RstStep radial_filter(const RstTask& task, std::vector<RstCandidate> candidates) {
  RstStep out;
  out.report.stage = name(Stage::radial);
  out.report.population = static_cast<std::int64_t>(candidates.size());
  std::vector<OffsetLists> lines;
  for (const RstRadial& r : task.model.radials) lines.push_back(offsets_for(r.lines, task.coarse.stride()));
  const int n = pieces_of(static_cast<int>(candidates.size()), kRadialChunk);
  Pieces pieces(n);
  parallel_for(n, task.threads, [&](int i, int) {
    if (task.budget.spent()) return;
    const auto piece = static_cast<std::size_t>(i);
    const std::size_t first = piece * kRadialChunk;
    RadialPiece(task, lines)
        .run(std::span<const RstCandidate>(candidates)
                 .subspan(first, std::min<std::size_t>(kRadialChunk, candidates.size() - first)),
             pieces.kept[piece], pieces.dropped[piece], pieces.compared[piece]);
  });
  pieces.collect(out);
  out.report.feature_count = pieces.total();
  return out;
}

namespace {

/// The best of the candidate and, with a tolerance of 1, its neighbours in scale and angle.
RstCandidate compare_template(const RstTask& task, const RstCandidate& c, std::int64_t& compared) {
  RstCandidate best = c;
  best.score = -2;
  const int tolerance = task.settings.step3_tolerance;
  const int lines = task.model.lines, scales = static_cast<int>(task.model.scales.size());
  for (int s = std::max(0, c.scale - tolerance); s <= std::min(scales - 1, c.scale + tolerance); ++s)
    for (int d = -tolerance; d <= tolerance; ++d) {
      const int shift = (c.shift + d + lines) % lines;
      if (d != 0 && !task.shifts.empty() &&
          std::find(task.shifts.begin(), task.shifts.end(), shift) == task.shifts.end())
        continue;
      const WindowScore w = score_window(task.coarse, task.model.window(s, shift), c.x, c.y);
      ++compared;
      const double ncc = task.settings.match_negative ? std::abs(w.ncc) : w.ncc;
      if (ncc > best.score) best = {c.x, c.y, s, shift, ncc, w.inside};
    }
  return best;
}

}  // namespace

RstStep template_filter(const RstTask& task, std::vector<RstCandidate> candidates) {
  RstStep out;
  out.report.stage = name(Stage::templates);
  out.report.population = static_cast<std::int64_t>(candidates.size());
  const int n = pieces_of(static_cast<int>(candidates.size()), kChunk);
  Pieces pieces(n);
  parallel_for(n, task.threads, [&](int i, int) {
    if (task.budget.spent()) return;
    const auto piece = static_cast<std::size_t>(i);
    const std::size_t first = piece * kChunk;
    for (std::size_t k = first; k < std::min(candidates.size(), first + kChunk); ++k) {
      const RstCandidate c = compare_template(task, candidates[k], pieces.compared[piece]);
      if (c.score > task.settings.t3 && c.inside >= task.settings.min_inside)
        pieces.kept[piece].push_back(c);
      else if (task.options.explain)
        pieces.dropped[piece].push_back(c);
    }
  });
  pieces.collect(out);
  out.report.ncc_count = pieces.total();
  return out;
}

std::vector<RstCandidate> suppressed(std::vector<RstCandidate> candidates, double radius_px) {
  std::sort(candidates.begin(), candidates.end(), better);
  if (radius_px <= 0) return candidates;
  std::vector<RstCandidate> out;
  for (const RstCandidate& c : candidates)
    if (std::none_of(out.begin(), out.end(),
                     [&](const RstCandidate& k) { return std::hypot(k.x - c.x, k.y - c.y) < radius_px; }))
      out.push_back(c);
  return out;
}

}  // namespace pickcell::matches
