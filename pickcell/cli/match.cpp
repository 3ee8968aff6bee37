// pickcell match: find taught parts in pictures.

#include <CLI/CLI.hpp>
#include <chrono>
#include <filesystem>
#include <memory>
#include <ostream>
#include <set>

#include "pickcell/cli/match_output.hpp"
#include "pickcell/cli/model_input.hpp"
#include "pickcell/cli/subcommand.hpp"
#include "pickcell/cli/values.hpp"
#include "pickcell/image/codec.hpp"
#include "pickcell/image/pyramid.hpp"
#include "pickcell/matches/engine.hpp"
#include "pickcell/matches/limits.hpp"
#include "pickcell/matches/overlay.hpp"
#include "pickcell/matches/work.hpp"

namespace pickcell::cli {

namespace {

namespace fs = std::filesystem;

struct Options {
  std::string model, engine = "best", mask, angle, scale, min_score, roi, budget_ms, max_overlap = "0.3",
                     threads = "all", params, overlay;
  std::vector<std::string> images, more_models, sets;
  int max = 1;
  bool explain = false, json = false;
};

core::Result<double> one_number(const std::string& option, const std::string& text, double lo, double hi) {
  const auto numbers = parse_numbers(option, text);
  if (!numbers) return tl::unexpected(numbers.error());
  if (numbers->size() == 1 && (*numbers)[0] >= lo && (*numbers)[0] <= hi) return (*numbers)[0];
  return core::failure(core::ErrorCode::usage, option, "'" + text + "' is out of range",
                       "use a number from " + core::Json(lo).dump() + " to " + core::Json(hi).dump());
}

core::Status read_ranges(const Options& options, matches::SearchOptions& search) {
  if (!options.angle.empty()) {
    auto angle = parse_range("--angle", options.angle);
    if (!angle) return core::forward(angle);
    if (auto fine = matches::check_angle_range("--angle", *angle); !fine) return fine;
    search.angle_deg = *angle;
  }
  if (!options.scale.empty()) {
    auto scale = parse_range("--scale", options.scale);
    if (!scale) return core::forward(scale);
    if (auto fine = matches::check_scale_range("--scale", *scale); !fine) return fine;
    search.scale = *scale;
  }
  return {};
}

core::Result<matches::SearchOptions> search_options(const Options& options) {
  matches::SearchOptions search;
  search.max_matches = options.max;
  search.explain = options.explain;
  if (auto fine = read_ranges(options, search); !fine) return core::forward(fine);
  auto threads = parse_threads(options.threads);
  if (!threads) return core::forward(threads);
  search.threads = *threads;
  auto overlap = one_number("--max-overlap", options.max_overlap, 0, 1);
  if (!overlap) return core::forward(overlap);
  search.max_overlap = *overlap;
  if (!options.min_score.empty()) {
    auto score = one_number("--min-score", options.min_score, 0, 1);
    if (!score) return core::forward(score);
    search.min_score = *score;
  }
  if (!options.budget_ms.empty()) {
    auto budget = one_number("--budget-ms", options.budget_ms, 0.001, 1e7);
    if (!budget) return core::forward(budget);
    search.budget_ms = *budget;
  }
  if (!options.roi.empty()) {
    auto roi = parse_roi("--roi", options.roi);
    if (!roi) return core::forward(roi);
    search.roi = *roi;
  }
  return search;
}

core::Result<std::vector<matches::Model>> load_models(const Options& options, const matches::SearchOptions& search) {
  BareTemplate how;
  how.angle_deg = search.angle_deg.value_or(how.angle_deg);
  how.scale = search.scale.value_or(how.scale);
  std::vector<matches::Model> models;
  BareTemplate masked = how;
  masked.mask_file = options.mask;
  auto first = load_model_or_template(options.model, masked);
  if (!first) return core::forward(first);
  models.push_back(std::move(*first));
  for (const std::string& file : options.more_models) {
    auto model = load_model_or_template(file, how);
    if (!model) return core::forward(model);
    models.push_back(std::move(*model));
  }
  return models;
}

/// One run of the command over its pictures.
class Run {
 public:
  Run(const Options& options, Io& io, std::unique_ptr<matches::Engine> engine, matches::SearchOptions search,
      std::vector<matches::Model> models)
      : options_(options), io_(io), engine_(std::move(engine)), search_(std::move(search)), models_(std::move(models)) {
    for (const matches::Model& model : models_) pointers_.push_back(&model);
    engine_->prepare(pointers_, search_);  // time_ms is matching alone
  }

  /// A picture that cannot be read or searched is reported, the others are still done; then 2.
  core::Result<int> all() {
    int code = 0;
    for (const std::string& image : options_.images) {
      const auto found = one(image);
      if (!found && options_.images.size() == 1) return tl::unexpected(found.error());
      if (!found) io_.err << "pickcell: " << found.error().line() << "\n";
      code = std::max(code, found ? (*found > 0 ? 0 : 1) : core::exit_code(found.error().code));
    }
    return code;
  }

 private:
  core::Result<std::size_t> one(const std::string& file) {
    const auto picture = image::load_grey(file);
    if (!picture) return tl::unexpected(picture.error());
    const auto start = std::chrono::steady_clock::now();
    auto found = search(picture->view());
    const double ms = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
    if (!found) {
      found.error().what = file + ": " + found.error().what;
      return core::forward(found);
    }
    const MatchedPicture matched{file, picture->width(), picture->height(), engine_->name(), ms, *found};
    if (options_.json)
      io_.out << to_json(matched, options_.explain).dump() << "\n" << std::flush;
    else
      print_words(matched, options_.explain, io_.out);
    if (auto drawn = draw(file, picture->view(), *found); !drawn) return core::forward(drawn);
    return found->matches.size();
  }

  /// A budget is that of the picture: its pyramid counts.
  core::Result<matches::FindResult> search(image::ImageView picture) {
    const double start_ms = matches::thread_cpu_ms();
    const auto left_ms = [&] { return *search_.budget_ms - (matches::thread_cpu_ms() - start_ms); };
    matches::SearchOptions rest = search_;
    const bool built = pyramid_.build_unless([&] { return search_.budget_ms && left_ms() <= 0; }, picture);
    if (search_.budget_ms) rest.budget_ms = left_ms();
    if (built && rest.budget_ms.value_or(1) > 0) return engine_->find(pyramid_, pointers_, rest);
    matches::FindResult nothing;
    nothing.complete = false;
    return nothing;
  }

  core::Status draw(const std::string& file, image::ImageView picture, const matches::FindResult& found) {
    if (options_.overlay.empty()) return {};
    std::error_code ignored;  // a folder that cannot be made shows when the file is written
    if (is_folder(options_)) fs::create_directories(options_.overlay, ignored);
    return image::save_png(overlay_file(options_, file), matches::draw_overlay(picture, found, pointers_));
  }

 public:
  /// A folder: it is one already, ends in a slash, or has no picture's name.
  static bool is_folder(const Options& options) {
    return fs::is_directory(options.overlay) || options.overlay.ends_with('/') ||
           fs::path(options.overlay).extension() != ".png";
  }
  static fs::path overlay_file(const Options& options, const std::string& image) {
    if (!is_folder(options)) return options.overlay;
    return fs::path(options.overlay) / (fs::path(image).filename().string() + ".png");
  }

 private:
  const Options& options_;
  Io& io_;
  std::unique_ptr<matches::Engine> engine_;
  matches::SearchOptions search_;
  std::vector<matches::Model> models_;
  std::vector<const matches::Model*> pointers_;
  image::Pyramid pyramid_;
};

core::Status check_overlay(const Options& options) {
  const std::string ending = fs::path(options.overlay).extension().string();
  if (ending == ".jpg" || ending == ".jpeg" || ending == ".bmp")
    return core::failure(core::ErrorCode::usage, "--overlay " + options.overlay, "overlays are PNG files",
                         "write OUT.png, or name a folder");
  if (options.overlay.empty() || options.images.size() == 1 || Run::is_folder(options)) return {};
  return core::failure(core::ErrorCode::usage, "--overlay",
                       "one file for " + std::to_string(options.images.size()) + " pictures", "name a folder");
}

/// No picture is drawn over another one, and none over what the command reads.
core::Status check_overlay_files(const Options& options) {
  if (options.overlay.empty()) return {};
  std::vector<std::string> inputs = options.images;
  inputs.insert(inputs.end(), options.more_models.begin(), options.more_models.end());
  inputs.push_back(options.model);
  inputs.push_back(options.mask);
  std::set<fs::path> files;
  for (const std::string& image : options.images) {
    const fs::path file = Run::overlay_file(options, image);
    if (!files.insert(file).second)
      return core::failure(core::ErrorCode::usage, "--overlay",
                           "two of the pictures are called " + fs::path(image).filename().string(),
                           "search them one folder at a time");
    if (auto fine = check_not_input(file, inputs); !fine) return fine;
  }
  return {};
}

core::Result<int> run(const Options& options, Io& io) {
  auto search = search_options(options);
  if (!search) return core::forward(search);
  if (auto fine = check_overlay(options); !fine) return core::forward(fine);
  if (auto fine = check_overlay_files(options); !fine) return core::forward(fine);
  const auto settings = parse_settings(options.sets, options.params);
  if (!settings) return tl::unexpected(settings.error());
  auto engine = matches::make_engine(options.engine, *settings);
  if (!engine) return core::forward(engine);
  auto models = load_models(options, *search);
  if (!models) return core::forward(models);
  return Run(options, io, std::move(*engine), std::move(*search), std::move(*models)).all();
}

Runner add(CLI::App& app) {
  auto o = std::make_shared<Options>();
  app.add_option("MODEL", o->model, "a PART.pcm, or a bare picture of the part")->required();
  app.add_option("IMAGE", o->images, "pictures to search")->required();
  app.add_option("-m,--model", o->more_models, "one more model; may be given several times")->allow_extra_args(false);
  app.add_option("--engine", o->engine, "best, rst or erst")->capture_default_str();
  app.add_option("--mask", o->mask, "mask of a bare picture: 128 and brighter is part")->type_name("FILE");
  app.add_option("--angle", o->angle, "angles to search, degrees (default: the model's)")->type_name("lo,hi");
  app.add_option("--scale", o->scale, "sizes to search (default: the model's)")->type_name("lo,hi");
  app.add_option("--max", o->max, "most matches in a picture")->capture_default_str()->check(CLI::Range(1, 200));
  app.add_option("--min-score", o->min_score, "threshold 0..1 (default: the model's)");
  app.add_option("--roi", o->roi, "search centres in this part of the picture")->type_name("x,y,w,h");
  app.add_option("--max-overlap", o->max_overlap, "of two matches' rectangles")->capture_default_str();
  app.add_option("--budget-ms", o->budget_ms, "time after which what was found so far is reported");
  app.add_option("--threads", o->threads, "number of threads, or all")->capture_default_str();
  app.add_option("--set", o->sets, "engine setting; may be given several times")
      ->type_name("KEY=VALUE")
      ->allow_extra_args(false);
  app.add_option("--params", o->params, "engine settings from a TOML file")->type_name("FILE.toml");
  app.add_option("--overlay", o->overlay, "draw what was found")->type_name("OUT.png|DIR");
  app.add_flag("--explain", o->explain, "also report what was turned down, and why");
  app.add_flag("--json", o->json, "one JSON object per picture");
  return [o](Io& io) { return run(*o, io); };
}

const Registration registered({"match", "find taught parts in pictures", add});

}  // namespace

}  // namespace pickcell::cli
