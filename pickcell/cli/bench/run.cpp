#include "pickcell/cli/bench/run.hpp"

#include "pickcell/cli/bench/absent.hpp"
#include "pickcell/image/codec.hpp"
#include "pickcell/matches/teach.hpp"
#include "pickcell/matches/work.hpp"

namespace pickcell::cli {

namespace {

struct TemplatePictures {
  image::Image picture;
  image::Image mask;
};

core::Result<TemplatePictures> load_template(const Dataset& set, const DatasetTemplate& part) {
  TemplatePictures out;
  auto picture = image::load_grey(set.folder / part.file);
  if (!picture) return core::forward(picture);
  if (auto fits = check_size(set.folder / part.file, part.size_px, picture->width(), picture->height()); !fits)
    return core::forward(fits);
  out.picture = std::move(*picture);
  if (!part.mask) return out;
  auto mask = image::load_grey(set.folder / *part.mask);
  if (!mask) return core::forward(mask);
  out.mask = std::move(*mask);
  return out;
}

core::Result<matches::Taught> teach_one(const Dataset& set, const DatasetTemplate& part,
                                        const TemplatePictures& pictures) {
  matches::TeachInput input;
  input.name = part.id;
  input.picture = pictures.picture.view();
  if (part.mask) input.mask = pictures.mask.view();
  input.scale = set.scale;
  return matches::teach(input);
}

}  // namespace

core::Result<Models> teach_templates(const Dataset& set, BenchRun& run) {
  std::vector<bool> needed(set.templates.size(), false);
  for (const std::size_t i : chosen_images(set, run.options.every)) {
    needed[set.images[i].template_index] = true;
    if (const auto other = run.options.absent ? absent_template(set, i) : std::nullopt) needed[*other] = true;
  }
  Models models(set.templates.size());
  for (std::size_t i = 0; i < models.size(); ++i) {
    if (!needed[i]) continue;
    auto pictures = load_template(set, set.templates[i]);
    if (!pictures) return core::forward(pictures);
    auto taught = teach_one(set, set.templates[i], *pictures);
    if (!taught) {
      run.untaught[i] = taught.error().why;
      continue;
    }
    run.teach_ms.push_back(taught->teach_ms);
    models[i] = std::make_unique<matches::Model>(std::move(taught->model));
  }
  return models;
}

core::Result<BenchRun> run_bench(const Dataset& set, const BenchOptions& options) {
  BenchRun run;
  run.options = options;
  run.options.threads = matches::thread_count(options.threads);
  auto engine = matches::make_engine(options.engine, options.settings);
  if (!engine) return core::forward(engine);
  run.isa = (*engine)->isa();
  auto models = teach_templates(set, run);
  if (!models) return core::forward(models);
  if (auto matched = match_images(set, *models, **engine, image::load_grey, run); !matched)
    return core::forward(matched);
  return run;
}

}  // namespace pickcell::cli
