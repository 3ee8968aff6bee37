#include "pickcell/cli/experiment/paper_sample.hpp"

#include <algorithm>
#include <system_error>

#include "pickcell/cli/cell/report.hpp"
#include "pickcell/cli/cell/setup.hpp"
#include "pickcell/cli/cell/start_demo.hpp"
#include "pickcell/core/clock.hpp"
#include "pickcell/core/statistics.hpp"
#include "pickcell/image/codec.hpp"
#include "pickcell/image/pyramid.hpp"
#include "pickcell/matches/model_file.hpp"
#include "pickcell/matches/overlay.hpp"
#include "pickcell/matches/work.hpp"

namespace pickcell::cli {
namespace {

namespace fs = std::filesystem;

core::Result<CellFile> prepare_cell(const Sample& sample, const fs::path& folder, std::uint64_t seed) {
  std::error_code ignored;
  fs::remove_all(folder, ignored);  // a journal of an earlier run would resume it
  DemoOptions demo;
  demo.seed = seed;
  demo.now_unix_us = core::SimulatedClock().unix_us();  // the cell runs in simulated time
  demo.kinds = {sample.kind};
  demo.camera_width_px = 752;
  demo.camera_height_px = 580;
  demo.parts_per_pitch = 1;
  demo.template_px = DemoOptions::TemplateSize{sample.w, sample.h};
  auto path = prepare_demo(folder, demo);
  if (!path) return core::forward(path);
  auto file = load_cell_file(*path);
  if (file) file->cell.feed.empty_pitches_max = kLooksPerSample;
  return file;
}

/// The cell's last picture, searched again by an engine of its own: first to prepare it, then for the figures.
core::Status search_again(const image::Image& picture, const matches::Model& model, const std::string& engine,
                          const matches::Settings& settings, const fs::path& overlay, SampleOutcome& out) {
  auto made = matches::make_engine(engine, settings);
  if (!made) return core::forward(made);
  const matches::Model* one[] = {&model};
  image::Pyramid pyramid;
  for (int i = 0; i < 2; ++i) {
    const double start_ms = matches::thread_cpu_ms();
    pyramid.build(picture.view());
    auto found = (*made)->find(pyramid, one, {});
    if (!found) return core::forward(found);
    out.search_ms = matches::thread_cpu_ms() - start_ms;
    out.stages = found->stages;
    if (i == 0) continue;
    if (auto done = image::save_png(overlay, matches::draw_overlay(picture.view(), *found, one)); !done) return done;
  }
  return {};
}

}  // namespace

core::Result<SampleOutcome> pick_sample(const Sample& sample, const std::string& engine,
                                        const matches::Settings& settings, const fs::path& out, std::uint64_t seed) {
  const std::string name = std::string(sample.name) + "_" + engine;
  auto file = prepare_cell(sample, out / name, seed);
  if (!file) return core::forward(file);
  CellRunOptions how;
  how.engine = engine;
  how.engine_settings = settings;
  how.stop_after_picks = 1;
  auto setup = set_up_cell(*file, how);
  if (!setup) return core::forward(setup);
  setup->cell->open();
  setup->cell->wait_until_done();
  const core::TimePoint end = setup->clock->now();
  setup->cell->close();
  SampleOutcome result;
  const cell::Snapshot last = setup->cell->snapshot();
  result.placed = last.counters.placed > 0;
  result.looks = last.counters.frames;
  result.end = last.reason;
  const PlaceErrors places = judge_places(setup->plant->world, end, setup->cell->settings().planner);
  result.place_mm = core::median(places.mm);
  result.place_deg = core::median(places.deg);
  const auto shown = setup->cell->latest_frame();
  if (!shown || !shown->frame.picture) return result;
  auto model = matches::load_model(out / name / (std::string(sample.kind) + ".pcm"));
  if (!model) return core::forward(model);
  auto searched =
      search_again(*shown->frame.picture, *model, engine, settings, out / ("table3_" + name + ".png"), result);
  if (!searched) return core::forward(searched);
  return result;
}

}  // namespace pickcell::cli
