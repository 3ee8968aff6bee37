#include "pickcell/matches/best/engine.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <memory_resource>
#include <stdexcept>
#include <utility>

#include "pickcell/matches/best/selection.hpp"
#include "pickcell/matches/limits.hpp"

namespace pickcell::matches {
namespace {

constexpr int kMostMatches = 200;
constexpr double kForget = 0.995;       // of the finishing time, per call
constexpr double kSpread = 1.3;         // the next call may take a little longer
constexpr double kMostFinishing = 0.6;  // of the budget

core::Status check(const SearchOptions& o) {
  const auto bad = [](const std::string& what, const std::string& why, const std::string& remedy) {
    return core::failure(core::ErrorCode::usage, what, why, remedy);
  };
  if (o.angle_deg)
    if (auto fine = check_angle_range("angle range", *o.angle_deg); !fine) return fine;
  if (o.scale)
    if (auto fine = check_scale_range("scale range", *o.scale); !fine) return fine;
  if (o.max_matches < 1 || o.max_matches > kMostMatches)
    return bad("number of matches", "it must lie in 1.." + std::to_string(kMostMatches), "");
  if (o.min_score && !(*o.min_score >= 0 && *o.min_score <= 1)) return bad("score limit", "it must lie in 0..1", "");
  if (!(o.max_overlap >= 0 && o.max_overlap <= 1)) return bad("overlap limit", "it must lie in 0..1", "");
  if (o.budget_ms && !(std::isfinite(*o.budget_ms) && *o.budget_ms > 0))
    return bad("time budget", "it must be positive", "");
  if (o.threads < 0) return bad("number of threads", "it must not be negative", "0 stands for all");
  return {};
}

core::Status check_roi(const SearchOptions& o, int width, int height) {
  if (!o.roi) return {};
  const auto& r = *o.roi;
  if (r.w >= 1 && r.h >= 1 && r.x >= 0 && r.y >= 0 && r.x <= width - r.w && r.y <= height - r.h) return {};
  return core::failure(core::ErrorCode::usage, "region of interest", "it does not lie inside the picture",
                       "the picture has " + std::to_string(width) + " x " + std::to_string(height) + " pixels");
}

core::Status check_size(const BestModel& m, int width, int height) {
  const double w = (m.x_hi - m.x_lo) * m.scale.lo;
  const double h = (m.y_hi - m.y_lo) * m.scale.lo;
  if (std::min(w, h) <= std::min(width, height) && std::max(w, h) <= std::hypot(width, height)) return {};
  return core::failure(core::ErrorCode::usage, "model " + m.model->name,
                       "its part (" + std::to_string(std::lround(w)) + " x " + std::to_string(std::lround(h)) +
                           " pixels at the smallest scale) is larger than the picture (" + std::to_string(width) +
                           " x " + std::to_string(height) + ")",
                       "teach from a picture of the same resolution");
}

}  // namespace

BestEngine::BestEngine(BestSettings settings, WorkBudget::CpuClock cpu_ms)
    : settings_(std::move(settings)), cpu_ms_(std::move(cpu_ms)) {}

BestModel& BestEngine::prepared(const Model& model, Range scale) {
  auto& list = models_[&model];
  for (const auto& m : list)
    if (m->scale.lo == scale.lo && m->scale.hi == scale.hi) return *m;
  list.push_back(std::make_unique<BestModel>(prepare_model(model, scale, settings_)));
  return *list.back();
}

void BestEngine::prepare_wide(BestModel& model) const {
  if (model.wide.empty()) model.wide = build_coarse_bands(model.pyramid, settings_.wide.detail, model.scale);
}

void BestEngine::prepare_thorough(BestModel& model) const {
  if (model.thorough.empty())
    model.thorough = build_coarse_bands(model.pyramid, settings_.thorough.detail, model.scale);
}

void BestEngine::prepare(std::span<const Model* const> models, const SearchOptions& options) {
  if (!check(options)) return;
  for (const Model* model : models) {
    BestModel& own = prepared(*model, options.scale.value_or(model->scale));
    if (options.max_matches > 1 && settings_.effort != Effort::thorough) prepare_wide(own);
    if (settings_.effort != Effort::quick) prepare_thorough(own);
  }
}

std::optional<double> BestEngine::searching_ms(const SearchOptions& options) const {
  if (!options.budget_ms) return {};
  return *options.budget_ms - std::min(finishing_ms_, kMostFinishing * *options.budget_ms);
}

void BestEngine::note_finishing(const SearchOptions& options, double used_ms) {
  const double now_ms = kSpread * std::max(0.0, used_ms - *searching_ms(options));
  finishing_ms_ = std::max(now_ms, kForget * finishing_ms_);
}

core::Result<FindResult> BestEngine::find(const image::Pyramid& scene, std::span<const Model* const> models,
                                          const SearchOptions& options) {
  FindResult result;
  if (auto found = find_into(scene, models, options, result); !found) return core::forward(found);
  return result;
}

core::Status BestEngine::find_into(const image::Pyramid& scene, std::span<const Model* const> models,
                                   const SearchOptions& options, FindResult& result) {
  if (models.empty() || std::find(models.begin(), models.end(), nullptr) != models.end())
    throw std::invalid_argument("a search needs models");
  if (auto ok = check(options); !ok) return core::forward(ok);
  scene_.start(scene);
  if (auto ok = check_roi(options, scene_.width(), scene_.height()); !ok) return core::forward(ok);
  scratch_.resize(static_cast<std::size_t>(thread_count(options.threads)));

  const double start_ms = options.budget_ms ? cpu_ms_() : 0;
  WorkBudget budget(searching_ms(options), cpu_ms_, options.budget_ms);
  result.stages.clear();
  arena_.reset();
  Selection selection(scene_, options, settings_, scratch_[0], budget, &arena_);
  for (std::size_t i = 0; i < models.size(); ++i) {
    BestModel& model = prepared(*models[i], options.scale.value_or(models[i]->scale));
    if (auto ok = check_size(model, scene_.width(), scene_.height()); !ok) return core::forward(ok);
    if (i > 0 && budget.spent()) break;
    selection.add(model, static_cast<int>(i),
                  options.max_matches > 1 ? search_several(model, options, budget, result)
                                          : search(model, options, budget, result));
  }
  selection.finish(result);
  result.complete = !budget.spent();
  // Only now, so that explaining changes neither the answer nor whether it is complete.
  for (std::size_t i = 0; options.explain && i < models.size() && !budget.spent(); ++i) {
    BestModel& model = prepared(*models[i], options.scale.value_or(models[i]->scale));
    selection.add_at_border(model, static_cast<int>(i), search_border(model, options, budget, result));
  }
  selection.tell_rejected(result);
  result.longest_step_ms = budget.longest_step_ms();
  if (!result.complete) note_finishing(options, cpu_ms_() - start_ms);
  return {};
}

}  // namespace pickcell::matches
