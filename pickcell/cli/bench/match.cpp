#include "pickcell/cli/bench/match.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>

#include "pickcell/cli/bench/absent.hpp"
#include "pickcell/cli/yardstick.hpp"
#include "pickcell/matches/work.hpp"

namespace pickcell::cli {

namespace {

using matches::FindResult;
using matches::SearchOptions;

/// So many matches are more than any set shows.
constexpr int kManyMatches = 200;
constexpr std::size_t kYardsticks = 9;

/// Spreads the yardsticks over a run of so many pictures.
class SpreadYardsticks {
 public:
  SpreadYardsticks(std::size_t pictures, std::vector<double>& out) : pictures_(pictures), out_(out) {}

  void after_picture(std::size_t index) {
    if (!Yardstick::available()) return;
    const std::size_t due = (kYardsticks * (index + 1) + pictures_ - 1) / pictures_;
    while (out_.size() < due) out_.push_back(*yardstick_.measure_ms());
  }

 private:
  std::size_t pictures_;
  std::vector<double>& out_;
  Yardstick yardstick_;
};

double wall_ms() {
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

/// Time of one search: CPU time of this thread, wall time when there are several.
class Stopwatch {
 public:
  explicit Stopwatch(int threads) : threads_(threads), start_ms_(now_ms()) {}
  [[nodiscard]] double ms() const { return now_ms() - start_ms_; }

 private:
  [[nodiscard]] double now_ms() const { return threads_ == 1 ? matches::thread_cpu_ms() : wall_ms(); }
  int threads_;
  double start_ms_;
};

/// A picture that could not be searched counts as not found.
ImageOutcome not_searched(const Dataset& set, std::size_t index, std::string why) {
  ImageOutcome out;
  out.image = index;
  out.score.truths = set.images[index].truths.size();
  out.score.why = std::move(why);
  return out;
}

/// One set being searched.
class Search {
 public:
  Search(const Dataset& set, const Models& models, matches::Engine& engine, const BenchOptions& options)
      : set_(set), models_(models), engine_(engine), options_(options) {}

  core::Result<ImageOutcome> picture(std::size_t index, image::ImageView view) {
    const DatasetImage& image = set_.images[index];
    const matches::Model& model = *models_[image.template_index];
    SearchOptions how = own_options(image);
    auto untimed = find(view, model, how);
    if (!untimed) return not_searched(set_, index, untimed.error().why);
    const Stopwatch watch(options_.threads);
    auto found = find(view, model, how);
    ImageOutcome out;
    out.ms = watch.ms();
    if (!found) return core::forward(found);
    out.image = index;
    for (const auto& stage : found_.stages) out.ncc_count += stage.ncc_count;
    out.stages = found_.stages;
    score(image, model, found_, out);
    if (options_.explain && !image.has_instances && !out.loose) {
      auto loss = explain_loss(engine_, pyramid_, model, image.truths.front(),
                               set_.templates[image.template_index].symmetry_deg, how);
      if (!loss) return core::forward(loss);
      out.loss = std::move(*loss);
    }
    if (auto absent = search_absent(index, view, out); !absent) return core::forward(absent);
    return out;
  }

 private:
  [[nodiscard]] SearchOptions own_options(const DatasetImage& image) const {
    SearchOptions how;
    how.threads = options_.threads;
    how.max_matches = image.has_instances ? kManyMatches : 1;
    if (!image.has_instances) how.min_score = 0;
    return how;
  }

  /// Into found_, whose memory is used again: as a cell does it.
  core::Status find(image::ImageView view, const matches::Model& model, const SearchOptions& how) {
    pyramid_.build(view);
    const matches::Model* one[] = {&model};
    return engine_.find_into(pyramid_, one, how, found_);
  }

  void score(const DatasetImage& image, const matches::Model& model, const FindResult& found, ImageOutcome& out) const {
    const double diagonal_px = std::hypot(model.picture.width(), model.picture.height());
    const double symmetry_deg = set_.templates[image.template_index].symmetry_deg;
    out.score = image.has_instances ? score_instances(found.matches, image.truths, diagonal_px, symmetry_deg)
                                    : score_one(found.matches, image.truths.front(), diagonal_px, symmetry_deg);
    if (!image.has_instances && !found.matches.empty())
      out.loose = is_loose(pose_error(found.matches.front().pose, image.truths.front(), symmetry_deg),
                           std::min(model.picture.width(), model.picture.height()));
    out.correct_at_threshold =
        out.score.correct && std::all_of(found.matches.begin(), found.matches.end(), [&](const auto& match) {
          return match.score >= model.learnt.suggested_min_score;
        });
  }

  core::Status search_absent(std::size_t index, image::ImageView view, ImageOutcome& out) {
    const auto other = options_.absent ? absent_template(set_, index) : std::nullopt;
    if (!other || !models_[*other]) return {};
    SearchOptions how;
    how.threads = options_.threads;
    const image::Image& part = models_[*other]->picture;
    if (part.width() > view.width() || part.height() > view.height()) {  // cannot be there, and engines refuse it
      out.false_accept = false;
      return {};
    }
    auto found = find(view, *models_[*other], how);
    if (!found) return core::forward(found);
    out.false_accept = !found_.matches.empty();
    return {};
  }

  const Dataset& set_;
  const Models& models_;
  matches::Engine& engine_;
  const BenchOptions& options_;
  image::Pyramid pyramid_;
  FindResult found_;
};

}  // namespace

core::Status check_size(const std::filesystem::path& file, const std::optional<PictureSize>& stated, int width,
                        int height) {
  if (!stated || (stated->width_px == width && stated->height_px == height)) return {};
  return core::failure(core::ErrorCode::unreadable, file.string(),
                       "is " + std::to_string(width) + "x" + std::to_string(height) + " px, but truth.json says " +
                           std::to_string(stated->width_px) + "x" + std::to_string(stated->height_px),
                       "the poses of truth.json belong to another picture");
}

std::vector<std::size_t> chosen_images(const Dataset& set, int every) {
  std::vector<std::size_t> out;
  for (std::size_t i = 0; i < set.images.size(); i += static_cast<std::size_t>(std::max(every, 1))) out.push_back(i);
  return out;
}

core::Status match_images(const Dataset& set, const Models& models, matches::Engine& engine, const LoadPicture& load,
                          BenchRun& run) {
  const std::vector<std::size_t> chosen = chosen_images(set, run.options.every);
  SpreadYardsticks yardsticks(chosen.size(), run.yardstick_ms);
  Search search(set, models, engine, run.options);
  for (std::size_t i = 0; i < chosen.size(); ++i) {
    const DatasetImage& image = set.images[chosen[i]];
    if (!models[image.template_index]) {
      run.images.push_back(
          not_searched(set, chosen[i], "the template cannot be taught: " + run.untaught[image.template_index]));
      continue;
    }
    auto picture = load(set.folder / image.file);
    if (!picture) return core::forward(picture);
    auto fits = check_size(set.folder / image.file, image.size_px, picture->width(), picture->height());
    if (!fits) return fits;
    auto outcome = search.picture(chosen[i], picture->view());
    if (!outcome) return core::forward(outcome);
    run.images.push_back(std::move(*outcome));
    yardsticks.after_picture(i);
  }
  return {};
}

}  // namespace pickcell::cli
