#include "pickcell/cli/replay/run.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <set>
#include <system_error>
#include <utility>

#include "pickcell/cell/cell.hpp"
#include "pickcell/cell/fate.hpp"
#include "pickcell/cell/vision.hpp"
#include "pickcell/cli/cell/calibration.hpp"
#include "pickcell/cli/cell/models.hpp"
#include "pickcell/cli/cell/setup.hpp"
#include "pickcell/core/clock.hpp"
#include "pickcell/image/codec.hpp"
#include "pickcell/matches/engine.hpp"

namespace pickcell::cli {

using cell::RecordedFind;
using cell::RecordedFrame;
using cell::RecordedRun;
using core::ErrorCode;
using core::failure;
namespace fs = std::filesystem;

namespace {

/// Of another cell's calibration: its age says something about its use, nothing about the pictures.
constexpr double kAnyAgeDays = 1e9;

/// The eye of a replay, with what its answers are held against.
struct Eye {
  cell::Vision vision;
  picks::PlannerSettings planner;
  std::map<std::string, PartTraits> parts;
  std::int64_t not_before_unix_us = 0;  ///< when its calibration may first be used
};

/// The files of the run, of --cell, or, for a run that kept none, of its cell as it is now.
core::Result<cell::CellConfig> cell_of(const RecordedRun& run, Replay& out) {
  const auto& kept = run.info().kept;
  const fs::path path = out.options.cell ? *out.options.cell : kept ? kept->cell : run.info().cell_file;
  std::error_code ignored;
  if (!out.options.cell && !kept && !fs::exists(path, ignored))
    return failure(ErrorCode::unreadable, run.folder().string(),
                   "it was recorded without its models, and its cell " + path.string() + " is gone",
                   "name a cell with --cell CELL.toml");
  auto file = read_cell_file(path);
  if (!file) return core::forward(file);
  const bool own = kept && !out.options.cell;
  out.cell = own ? "recorded" : path.string();
  if (!out.options.cell && !kept)
    out.notes.push_back("the run kept no models: those that " + path.string() + " names now were used");
  if (own)
    if (auto fits = cell::read_from(file->cell, *kept); !fits) return core::forward(fits);
  return std::move(file->cell);
}

PartTraits traits_of(const matches::Model& model) {
  constexpr double kLeastPx = 3, kOfShorterSide = 0.1;
  const int shorter_px = std::min(model.picture.width(), model.picture.height());
  return {std::max(kLeastPx, kOfShorterSide * shorter_px), model.learnt.symmetry_order};
}

core::Result<Eye> open_eye(const RecordedRun& run, Replay& out) {
  auto config = cell_of(run, out);
  if (!config) return core::forward(config);
  auto calibration = load_calibration(config->calibration);
  if (!calibration) return core::forward(calibration);
  auto models = load_models(*config);
  if (!models) return core::forward(models);
  auto engine = matches::make_engine(run.info().engine, {});
  if (!engine) {
    engine.error().what = (run.folder() / "run.toml").string() + ": " + engine.error().what;
    return core::forward(engine);
  }
  calibration->threads = out.options.threads;
  const bool of_then = out.cell == "recorded";
  if (!of_then) calibration->max_age_days = kAnyAgeDays;
  std::map<std::string, PartTraits> parts;
  for (const matches::Model& model : *models) parts[model.name] = traits_of(model);
  picks::PlannerSettings planner = cell::settings_from(*config, *models).planner;
  out.engine = (*engine)->name();
  return Eye{cell::Vision(std::move(*engine), std::move(*models), std::move(*calibration)), std::move(planner),
             std::move(parts), of_then ? 0 : core::RealClock().unix_us()};
}

core::Result<frames::Frame> load_frame(const RecordedRun& run, const RecordedFrame& recorded) {
  const fs::path path = run.folder() / recorded.file;
  auto picture = image::load_grey(path);
  if (!picture) return core::forward(picture);
  if (picture->width() != recorded.width_px || picture->height() != recorded.height_px)
    return failure(ErrorCode::unreadable, path.string(),
                   std::to_string(picture->width()) + "x" + std::to_string(picture->height()) +
                       " pixels, and the log says " + std::to_string(recorded.width_px) + "x" +
                       std::to_string(recorded.height_px),
                   "the picture is not of this run: restore it from its archive");
  frames::Frame frame;
  frame.picture = std::make_shared<const image::Image>(std::move(*picture));
  frame.sequence = static_cast<std::uint64_t>(recorded.sequence);
  frame.exposed_unix_us = recorded.exposed_unix_us;
  frame.camera_id = recorded.camera_id;
  frame.T_base_flange = recorded.T_base_flange;
  return frame;
}

/// As run_log.cpp records it.
RecordedFind as_recorded(const cell::Sight::Seen& seen, const cell::Sight& sight, const picks::Plan& plan) {
  const cell::Fate fate = cell::fate_of(seen, plan);
  RecordedFind out{
      static_cast<std::int64_t>(seen.detection_id), seen.match.model, seen.match.pose, seen.match.score, {},
      fate.state == cell::DetectionState::rejected, fate.code,        fate.why};
  for (const poses::PartPose& part : sight.parts)
    if (part.detection_id == seen.detection_id) out.place = cell::place_of(part);
  return out;
}

/// Parts that the cell had given up on were not planned with; a picture does not show that, the record does.
void give_up_as_recorded(cell::Sight& sight, const std::vector<RecordedFind>& recorded, const Eye& eye) {
  std::vector<RecordedFind> now;
  for (const cell::Sight::Seen& seen : sight.seen) now.push_back(as_recorded(seen, sight, {}));
  for (const FindChange& pair : compare(recorded, now, eye.parts, {})) {
    if (!pair.recorded || !pair.now || pair.recorded->code != std::string(cell::kGaveUp)) continue;
    const auto id = static_cast<std::uint64_t>(pair.now->id);
    std::erase_if(sight.parts, [&](const poses::PartPose& part) { return part.detection_id == id; });
    for (cell::Sight::Seen& seen : sight.seen)
      if (seen.detection_id == id && !seen.rejection)
        seen.rejection = cell::Rejection{*pair.recorded->code, pair.recorded->why};
  }
}

void note(Replay& out, const RecordedFrame& frame, std::vector<FindChange> finds) {
  for (const FindChange& find : finds) {
    out.finds_recorded += find.recorded.has_value();
    out.finds_same += find.change == Change::same;
    out.finds_changed += find.change == Change::changed;
    out.finds_lost += find.change == Change::lost;
    out.finds_new += find.change == Change::added;
    out.most_px = std::max(out.most_px, find.off_px);
    out.most_deg = std::max({out.most_deg, std::abs(find.off_deg), std::abs(find.off_base_deg.value_or(0))});
    out.most_mm = std::max(out.most_mm, find.off_mm.value_or(0));
  }
  std::erase_if(finds, [](const FindChange& find) { return find.change == Change::same; });
  if (finds.empty()) {
    ++out.same;
    return;
  }
  const Tolerance& t = out.options.tolerance;
  std::stable_sort(finds.begin(), finds.end(),
                   [&](const FindChange& a, const FindChange& b) { return a.weight(t) > b.weight(t); });
  out.changed.push_back({frame.sequence, frame.file, std::move(finds)});
}

void note_once(Replay& out, const std::string& text) {
  if (std::find(out.notes.begin(), out.notes.end(), text) == out.notes.end()) out.notes.push_back(text);
}

core::Status search(RecordedRun& run, const RecordedFrame& recorded, frames::Frame frame, Eye& eye, Replay& out) {
  if (eye.vision.rides_on_arm() && !frame.T_base_flange)
    return failure(ErrorCode::unreadable, run.folder().string(),
                   "its camera is on the arm, and where the arm was is not recorded for frame " +
                       std::to_string(recorded.sequence),
                   "record the run again with this version");
  frame.exposed_unix_us = std::max(frame.exposed_unix_us, eye.not_before_unix_us);
  const auto then = run.finds(recorded);
  if (!then) return tl::unexpected(then.error());
  auto sight = eye.vision.look(frame, 1);
  if (!sight) return core::forward(sight);
  if (sight->unfit) note_once(out, "the calibration does not fit the pictures: " + sight->unfit->line());
  give_up_as_recorded(*sight, *then, eye);
  const picks::Plan plan = picks::plan_picks(sight->parts, eye.planner, {});
  std::vector<RecordedFind> now;
  for (const cell::Sight::Seen& seen : sight->seen) now.push_back(as_recorded(seen, *sight, plan));
  out.recorded_ms.push_back(recorded.match_ms);
  out.now_ms.push_back(sight->match_ms);
  note(out, recorded, compare(*then, now, eye.parts, out.options.tolerance));
  return {};
}

/// What a reader must know about the log itself.
void note_gaps(const RecordedRun& run, Replay& out) {
  if (run.open_end())
    out.notes.push_back("the run's log was not closed (power cut, or it still goes on): what it holds was searched");
  if (run.info().format < 2)
    out.notes.push_back(
        "recorded in format 1, without codes of rejections: only whether a part was turned down is compared");
  std::set<std::string> logged;
  for (const RecordedFrame& frame : run.frames()) logged.insert(frame.file);
  std::size_t unlogged = 0;
  std::error_code problem;
  for (const fs::directory_entry& entry : fs::directory_iterator(run.folder() / "frames", problem))
    unlogged += !logged.contains("frames/" + entry.path().filename().string());
  if (unlogged > 0)
    out.notes.push_back("pictures in frames/ that are not in the log: " + std::to_string(unlogged) +
                        " (the run was cut off after they were written)");
}

}  // namespace

core::Result<Replay> replay(const ReplayOptions& options, const std::function<void(const core::Error&)>& unreadable) {
  auto run = RecordedRun::open(options.run);
  if (!run) return core::forward(run);
  const std::vector<RecordedFrame>& frames = run->frames();
  if (frames.empty())
    return failure(ErrorCode::unreadable, options.run.string(), "the run ended before it looked at a picture",
                   "name another run");
  if (std::all_of(frames.begin(), frames.end(), [](const RecordedFrame& frame) { return frame.file.empty(); }))
    return failure(ErrorCode::unreadable, options.run.string(), "the run kept no pictures",
                   "record with --record, or record_frames = true in [cell]");
  Replay out;
  out.options = options;
  out.info = run->info();
  auto eye = open_eye(*run, out);
  if (!eye) return core::forward(eye);
  note_gaps(*run, out);
  for (std::size_t i = options.shard.index - 1; i < frames.size(); i += options.shard.count) {
    ++out.frames;
    if (frames[i].file.empty()) {
      ++out.without_picture;
      continue;
    }
    auto frame = load_frame(*run, frames[i]);
    if (!frame) {
      ++out.unreadable;
      unreadable(frame.error());
    } else if (auto searched = search(*run, frames[i], std::move(*frame), *eye, out); !searched) {
      return core::forward(searched);
    }
  }
  const Tolerance& t = options.tolerance;
  std::stable_sort(out.changed.begin(), out.changed.end(), [&](const ChangedFrame& a, const ChangedFrame& b) {
    return a.finds.front().weight(t) > b.finds.front().weight(t);
  });
  return out;
}

}  // namespace pickcell::cli
