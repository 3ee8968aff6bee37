#include "pickcell/matches/rst/engine.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "pickcell/matches/limits.hpp"
#include "pickcell/matches/rotated_rect.hpp"
#include "pickcell/matches/similarity.hpp"

namespace pickcell::matches {
namespace {

constexpr int kMostMatches = 200;
constexpr std::size_t kMostRejected = 100;
constexpr std::size_t kCacheBytes = 256u << 20;  // of turned templates, all models together

core::Status bad(const std::string& what, const std::string& why, const std::string& remedy = "") {
  return core::failure(core::ErrorCode::usage, what, why, remedy);
}

core::Status check(const SearchOptions& o) {
  if (o.angle_deg)
    if (auto fine = check_angle_range("angle range", *o.angle_deg); !fine) return fine;
  if (o.scale)
    if (auto fine = check_scale_range("scale range", *o.scale); !fine) return fine;
  if (o.max_matches < 1 || o.max_matches > kMostMatches)
    return bad("number of matches", "it must lie in 1.." + std::to_string(kMostMatches));
  if (o.min_score && !(*o.min_score >= 0 && *o.min_score <= 1)) return bad("score limit", "it must lie in 0..1");
  if (!(o.max_overlap >= 0 && o.max_overlap <= 1)) return bad("overlap limit", "it must lie in 0..1");
  if (o.budget_ms && !(std::isfinite(*o.budget_ms) && *o.budget_ms > 0))
    return bad("time budget", "it must be positive");
  if (o.threads < 0) return bad("number of threads", "it must not be negative", "0 stands for all");
  return {};
}

core::Status check_roi(const SearchOptions& o, image::ImageView picture) {
  if (!o.roi) return {};
  const auto& r = *o.roi;
  if (r.w >= 1 && r.h >= 1 && r.x >= 0 && r.y >= 0 && r.x <= picture.width() - r.w && r.y <= picture.height() - r.h)
    return {};
  return bad(
      "region of interest", "it does not lie inside the picture",
      "the picture has " + std::to_string(picture.width()) + " x " + std::to_string(picture.height()) + " pixels");
}

core::Status check_size(const image::Pyramid& scene, const RstModel& m) {
  const int across = 2 * m.margin + 1;
  if (m.level < scene.levels() && scene.level(m.level).width() >= across && scene.level(m.level).height() >= across)
    return {};
  const image::ImageView picture = scene.level(0);
  return bad("model " + m.model->name,
             "its largest circle (" + std::to_string(across << m.level) + " pixels across) does not fit the picture (" +
                 std::to_string(picture.width()) + " x " + std::to_string(picture.height()) + ")",
             "teach from a picture of the same resolution, or search smaller scales");
}

/// The coarse angles from which step 4 reaches the range; empty: all.
AllowedShifts allowed_shifts(Range range, int alpha_deg) {
  AllowedShifts out;
  const int lines = 360 / alpha_deg;
  for (int m = 0; m < lines; ++m)
    if (angle_in_range(m * alpha_deg, range, alpha_deg / 2.0)) out.push_back(m);
  if (static_cast<int>(out.size()) == lines) out.clear();
  return out;
}

/// Whole degrees in the range; a range between two of them allows both.
std::vector<bool> allowed_degrees(Range range) {
  std::vector<bool> out(360);
  for (int a = 0; a < 360; ++a)
    out[static_cast<std::size_t>(a)] = angle_in_range(a, {std::floor(range.lo), std::ceil(range.hi)}, 0);
  return out;
}

/// What the grids leave open: a uniform error of one step each.
Eigen::Matrix4d grid_covariance(const RstModel& model) {
  const double step = model.scales.size() < 2
                          ? 0.1
                          : (model.scales.back() - model.scales.front()) / static_cast<double>(model.scales.size() - 1);
  return Eigen::Vector4d(1 / 12.0, 1 / 12.0, 1 / 12.0, step * step / 12).asDiagonal();
}

class StageClock {
 public:
  /// CPU time of this thread since it was last asked.
  double lap_ms() {
    const double now = thread_cpu_ms();
    return now - std::exchange(last_ms_, now);
  }

 private:
  double last_ms_ = thread_cpu_ms();
};

bool near_watched(const SearchOptions& options, const RstModel& model, const Pose2d& p) {
  if (!options.watch) return false;
  const double radius = 0.1 * std::min(model.pyramid.width(), model.pyramid.height());
  return std::hypot(p.x_px - options.watch->x_px, p.y_px - options.watch->y_px) <= std::max(radius, 2.0);
}

/// Those about the watched pose first, then those that came furthest; the best first. Not more than a reader can use.
void sort_rejected(const SearchOptions& options, const std::vector<const RstModel*>& models,
                   std::vector<Rejected>& rejected) {
  const auto watched = [&](const Rejected& r) {
    return near_watched(options, *models[static_cast<std::size_t>(r.match.model_index)], r.match.pose);
  };
  std::stable_sort(rejected.begin(), rejected.end(), [&](const Rejected& a, const Rejected& b) {
    const bool a_near = watched(a), b_near = watched(b);
    if (a_near != b_near) return a_near;
    return a.stage != b.stage ? a.stage > b.stage : a.match.score > b.match.score;
  });
  if (rejected.size() > kMostRejected) rejected.resize(kMostRejected);
}

}  // namespace

RstEngine::RstEngine(RstVariant variant, RstSettings settings, WorkBudget::CpuClock cpu_ms)
    : variant_(variant), settings_(std::move(settings)), cpu_ms_(std::move(cpu_ms)) {}

core::Result<RstModel*> RstEngine::prepared(const Model& model, Range scale) {
  auto& list = models_[&model];
  for (const auto& m : list)
    if (m->scale.lo == scale.lo && m->scale.hi == scale.hi) return m.get();
  auto fresh = prepare_rst_model(model, scale, settings_);
  if (!fresh) return core::forward(fresh);
  list.push_back(std::move(*fresh));
  if (settings_.refine_subpixel) refine_.prepare(*list.back());
  return list.back().get();
}

void RstEngine::prepare(std::span<const Model* const> models, const SearchOptions& options) {
  if (!check(options)) return;
  for (const Model* model : models) static_cast<void>(prepared(*model, options.scale.value_or(model->scale)));
}

void RstEngine::limit_cache() {
  std::size_t bytes = 0;
  for (const auto& [model, list] : models_)
    for (const auto& m : list) bytes += m->fine->bytes();
  if (bytes <= kCacheBytes) return;
  for (const auto& [model, list] : models_)
    for (const auto& m : list) m->fine->drop();
}

void RstEngine::note(const RstTask& task, int model_index, const std::vector<RstCandidate>& dropped, Stage stage,
                     FindResult& result) const {
  for (const RstCandidate& c : dropped) {
    Rejected r;
    r.match.model = task.model.model->name;
    r.match.model_index = model_index;
    r.match.pose = task.pose(c);
    r.match.score = std::clamp(c.score, 0.0, 1.0);
    r.match.visible = c.inside;
    r.match.covariance = grid_covariance(task.model);
    r.reason = c.inside < task.settings.min_inside ? RejectReason::border : RejectReason::score;
    r.stage = stage;
    result.rejected.push_back(std::move(r));
  }
}

core::Status RstEngine::search(const image::Pyramid& scene, RstModel& model, int model_index,
                               const SearchOptions& options, WorkBudget& budget, std::vector<Find>& finds,
                               FindResult& result) {
  if (auto fits = check_size(scene, model); !fits) return fits;
  const Range angles = options.angle_deg.value_or(model.model->angle_deg);
  StageClock clock;
  const RstTask task{model,
                     settings_,
                     variant_,
                     coarse_.make(scene, model.level, settings_),
                     options,
                     allowed_shifts(angles, settings_.angle_step_deg),
                     allowed_degrees(angles),
                     budget,
                     thread_count(options.threads)};
  const auto finished = [&](RstStep& step, Stage stage) {
    step.report.ms = clock.lap_ms();
    result.stages.push_back(step.report);
    note(task, model_index, step.dropped, stage, result);
  };
  RstStep one = circular_filter(task);
  finished(one, Stage::circular);
  RstStep two = radial_filter(task, std::move(one.kept));
  finished(two, Stage::radial);
  RstStep three = template_filter(task, std::move(two.kept));
  finished(three, Stage::templates);
  robust_filter(task, scene.level(0), model_index, suppressed(std::move(three.kept), settings_.suppress_px), finds,
                result);
  result.stages.back().ms = clock.lap_ms();
  return {};
}

void RstEngine::robust_filter(const RstTask& task, image::ImageView picture, int model_index,
                              const std::vector<RstCandidate>& candidates, std::vector<Find>& finds,
                              FindResult& result) {
  RobustSearch how;
  how.variant = variant_;
  how.level = task.model.level;
  how.alpha_deg = settings_.angle_step_deg;
  how.scales = static_cast<int>(task.model.scales.size());
  how.location = settings_.location;
  how.allowed_deg = &task.allowed_deg;
  const PlaceScore score = [&](const RobustPlace& p) {
    WindowScore s = score_window(picture, task.model.fine->get(p.angle_deg, p.scale), p.x, p.y);
    if (settings_.match_negative) s.ncc = std::abs(s.ncc);
    return s;
  };
  std::vector<RobustResult> found(candidates.size());
  parallel_for(static_cast<int>(candidates.size()), task.threads, [&](int i, int) {
    if (task.budget.spent()) return;
    const RstCandidate& c = candidates[static_cast<std::size_t>(i)];
    const RobustPlace start{c.x << how.level, c.y << how.level, c.shift * how.alpha_deg, c.scale};
    found[static_cast<std::size_t>(i)] = search_robustly(how, start, score);
  });
  StageReport report;
  report.stage = matches::name(Stage::robust);
  report.population = static_cast<std::int64_t>(candidates.size());
  const double limit = settings_.t4 ? std::max(*settings_.t4, task.options.min_score.value_or(0))
                                    : task.options.min_score.value_or(settings_.t3);
  for (const RobustResult& r : found) {
    report.ncc_count += r.ncc_count;
    if (r.ncc_count == 0) continue;
    Match m;
    m.model = task.model.model->name;
    m.model_index = model_index;
    m.pose = task.model.window_pose(r.place.x, r.place.y, r.place.angle_deg,
                                    task.model.scales[static_cast<std::size_t>(r.place.scale)]);
    m.score = std::clamp(r.ncc, 0.0, 1.0);
    m.visible = r.inside;
    m.covariance = grid_covariance(task.model);
    const bool wrong_angle = !task.allowed_deg[static_cast<std::size_t>(r.place.angle_deg)];
    const bool outside = r.inside < settings_.min_inside;
    if (r.ncc >= limit && !wrong_angle && !outside) {
      ++report.survivors;
      finds.push_back({&task.model, m, task.model.outline(m.pose)});
    } else if (task.options.explain) {
      result.rejected.push_back({m,
                                 wrong_angle ? RejectReason::limit
                                 : outside   ? RejectReason::border
                                             : RejectReason::score,
                                 Stage::robust});
    }
  }
  result.stages.push_back(std::move(report));
}

void RstEngine::merge(std::vector<Find> finds, const SearchOptions& options, FindResult& result) {
  std::stable_sort(finds.begin(), finds.end(),
                   [](const Find& a, const Find& b) { return a.match.score > b.match.score; });
  StageReport report;
  report.stage = matches::name(Stage::merge);
  report.population = static_cast<std::int64_t>(finds.size());
  std::vector<Find> kept;
  const auto drop = [&](Find& f, RejectReason reason) {
    if (options.explain) result.rejected.push_back({std::move(f.match), reason, Stage::merge});
  };
  for (Find& f : finds) {
    const auto& roi = options.roi;
    const Pose2d& p = f.match.pose;
    if (roi && (p.x_px < roi->x - 0.5 || p.y_px < roi->y - 0.5 || p.x_px > roi->x + roi->w - 0.5 ||
                p.y_px > roi->y + roi->h - 0.5))
      drop(f, RejectReason::limit);
    else if (std::any_of(kept.begin(), kept.end(),
                         [&](const Find& k) { return overlap(k.outline, f.outline) > options.max_overlap; }))
      drop(f, RejectReason::overlap);
    else if (static_cast<int>(kept.size()) >= options.max_matches)
      drop(f, RejectReason::limit);
    else
      kept.push_back(std::move(f));
  }
  report.survivors = static_cast<std::int64_t>(kept.size());
  result.stages.push_back(std::move(report));
  for (Find& f : kept) {
    if (settings_.refine_subpixel) refine_.run(*f.model, f.match);
    result.matches.push_back(std::move(f.match));
  }
  std::stable_sort(result.matches.begin(), result.matches.end(),
                   [](const Match& a, const Match& b) { return a.score > b.score; });
}

core::Result<FindResult> RstEngine::find(const image::Pyramid& scene, std::span<const Model* const> models,
                                         const SearchOptions& options) {
  if (models.empty() || std::find(models.begin(), models.end(), nullptr) != models.end())
    throw std::invalid_argument("a search needs models");
  if (auto ok = check(options); !ok) return core::forward(ok);
  if (auto ok = check_roi(options, scene.level(0)); !ok) return core::forward(ok);
  limit_cache();
  if (settings_.refine_subpixel) refine_.start(scene);
  WorkBudget budget(options.budget_ms, cpu_ms_);
  FindResult result;
  std::vector<Find> finds;
  std::vector<const RstModel*> used;
  for (std::size_t i = 0; i < models.size(); ++i) {
    auto model = prepared(*models[i], options.scale.value_or(models[i]->scale));
    if (!model) return core::forward(model);
    if (i > 0 && budget.spent()) break;
    used.push_back(*model);
    if (auto ok = search(scene, **model, static_cast<int>(i), options, budget, finds, result); !ok)
      return core::forward(ok);
  }
  merge(std::move(finds), options, result);
  result.complete = !budget.spent();
  sort_rejected(options, used, result.rejected);
  return result;
}

}  // namespace pickcell::matches
