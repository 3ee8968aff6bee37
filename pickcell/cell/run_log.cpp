#include "pickcell/cell/run_log.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <system_error>
#include <utility>

#include "pickcell/cell/recorded_run.hpp"
#include "pickcell/core/date.hpp"
#include "pickcell/core/file.hpp"
#include "pickcell/core/json.hpp"
#include "pickcell/image/codec.hpp"

namespace pickcell::cell {

using core::ErrorCode;
using core::failure;
namespace fs = std::filesystem;

namespace {

constexpr const char* kSchema = R"(
PRAGMA user_version = 2;
CREATE TABLE frame (
  sequence INTEGER PRIMARY KEY, exposed_unix_us INTEGER NOT NULL, camera_id TEXT NOT NULL, width_px INTEGER NOT NULL,
  height_px INTEGER NOT NULL, grab_ms REAL NOT NULL, match_ms REAL NOT NULL, file TEXT,
  T_base_flange TEXT) STRICT;
CREATE TABLE detection (
  id INTEGER PRIMARY KEY, frame INTEGER NOT NULL REFERENCES frame(sequence), part TEXT NOT NULL,
  x_px REAL NOT NULL, y_px REAL NOT NULL, angle_deg REAL NOT NULL, scale REAL NOT NULL, score REAL NOT NULL,
  sigma_x_px REAL, sigma_y_px REAL, sigma_deg REAL, visible REAL,
  base_x_mm REAL, base_y_mm REAL, base_z_mm REAL, base_angle_deg REAL,
  rejected INTEGER NOT NULL, reason TEXT NOT NULL, code TEXT NOT NULL) STRICT;
CREATE INDEX detection_of_frame ON detection(frame);
CREATE TABLE pick (
  sequence INTEGER PRIMARY KEY, detection INTEGER NOT NULL, slot INTEGER NOT NULL, outcome TEXT NOT NULL,
  reason INTEGER NOT NULL, text TEXT NOT NULL, t_submit_us INTEGER NOT NULL, t_end_us INTEGER) STRICT;
CREATE TABLE event (unix_us INTEGER NOT NULL, kind TEXT NOT NULL, text TEXT NOT NULL) STRICT;
)";

/// A TOML basic string: JSON's escapes are all valid TOML ones.
std::string quoted(const std::string& text) { return core::Json(text).dump(); }

std::string run_toml(const RunInfo& info) {
  return "format = " + std::to_string(kRunFormat) + "\nstarted = " + quoted(core::iso_utc(info.start_unix_us)) +
         "\ncell = " + quoted(info.cell_name) + "\ncell_file = " + quoted(info.cell_file.string()) +
         "\ncamera_id = " + quoted(info.camera_id) + "\nrobot_link = " + quoted(info.robot_link) +
         "\nengine = " + quoted(info.engine) + "\nsimulated = " + (info.simulated ? "true" : "false") + "\n";
}

/// The arm's pose at exposure, row by row; for a camera that is not on the arm nothing.
SqlValue flange_column(const frames::Frame& frame) {
  if (!frame.T_base_flange) return std::monostate{};
  const Eigen::Matrix4d M = frame.T_base_flange->matrix();
  core::Json rows = core::Json::array();
  for (int i = 0; i < 16; ++i) rows.push(M(i / 4, i % 4));
  return rows.dump();
}

core::Result<fs::path> new_folder(const fs::path& runs_dir, const std::string& name) {
  std::error_code problem;
  fs::create_directories(runs_dir, problem);
  for (int n = 1; !problem && n < 10'000; ++n) {
    const fs::path folder = runs_dir / (n == 1 ? name : name + "-" + std::to_string(n));
    if (fs::create_directory(folder, problem)) return folder;
  }
  return failure(ErrorCode::unreadable, runs_dir.string(), problem ? problem.message() : "too many runs in one second",
                 "the state folder must be writable");
}

SqlRow detection_row(const ShownFrame& shown, const Detection& d, const matches::Match* match,
                     const poses::PartPose* pose) {
  const auto sigma = [&](int i) -> SqlValue {
    if (!match) return std::monostate{};
    return std::sqrt(std::max(0.0, match->covariance(i, i)));
  };
  SqlRow row{static_cast<std::int64_t>(d.id),
             static_cast<std::int64_t>(shown.frame.sequence),
             d.part,
             d.x_px,
             d.y_px,
             d.angle_deg,
             d.scale,
             d.score,
             sigma(0),
             sigma(1),
             sigma(2),
             match ? SqlValue(match->visible) : SqlValue(std::monostate{})};
  if (pose) {
    const RecordedPlace place = place_of(*pose);
    for (const double v : {place.x_mm, place.y_mm, place.z_mm, place.angle_deg}) row.emplace_back(v);
  } else {
    row.resize(row.size() + 4);
  }
  row.emplace_back(static_cast<std::int64_t>(d.state == DetectionState::rejected));
  row.emplace_back(d.why);
  row.emplace_back(d.code);
  return row;
}

}  // namespace

core::Result<RunLog> RunLog::create(const fs::path& runs_dir, const RunInfo& info, bool record_frames) {
  auto folder = new_folder(runs_dir, core::utc(info.start_unix_us, "%Y%m%d-%H%M%S"));
  if (!folder) return core::forward(folder);
  std::error_code problem;
  fs::create_directory(*folder / "frames", problem);
  if (problem) return failure(ErrorCode::unreadable, (*folder / "frames").string(), problem.message());
  core::Result<std::string> kept;
  if (record_frames && info.files) kept = keep_files(*folder, *info.files);
  if (!kept) return core::forward(kept);
  if (auto written = core::write_file_atomically(*folder / "run.toml", run_toml(info) + *kept); !written)
    return core::forward(written);
  auto database = Database::open(*folder / "picks.db");
  if (!database) return core::forward(database);
  if (auto made = database->script(kSchema); !made) return core::forward(made);
  return RunLog(std::move(*folder), std::move(*database), record_frames);
}

core::Status RunLog::add_frame(const ShownFrame& shown, const std::vector<matches::Match>& found,
                               const std::vector<poses::PartPose>& poses) {
  SqlValue file = std::monostate{};
  if (record_frames_) {
    char name[32];
    std::snprintf(name, sizeof name, "%08llu.png", static_cast<unsigned long long>(shown.frame.sequence));
    if (auto saved = image::save_png(folder_ / "frames" / name, shown.frame.picture->view()); !saved) return saved;
    file = std::string("frames/") + name;
  }
  if (auto begun = database_.script("BEGIN"); !begun) return begun;
  auto added = database_.execute(
      "INSERT INTO frame VALUES (?1,?2,?3,?4,?5,?6,?7,?8,?9)",
      {static_cast<std::int64_t>(shown.frame.sequence), shown.frame.exposed_unix_us, shown.frame.camera_id.str(),
       std::int64_t{shown.frame.picture->width()}, std::int64_t{shown.frame.picture->height()}, shown.grab_ms,
       shown.match_ms, file, flange_column(shown.frame)});
  for (std::size_t i = 0; added && i < shown.detections.size(); ++i) {
    const Detection& d = shown.detections[i];
    const auto pose = std::find_if(poses.begin(), poses.end(), [&](const auto& p) { return p.detection_id == d.id; });
    added = database_.execute(
        "INSERT INTO detection VALUES (?1,?2,?3,?4,?5,?6,?7,?8,?9,?10,?11,?12,?13,?14,?15,?16,?17,?18,?19)",
        detection_row(shown, d, i < found.size() ? &found[i] : nullptr, pose == poses.end() ? nullptr : &*pose));
  }
  if (!added) {
    core::Error error = added.error();
    if (auto undone = database_.script("ROLLBACK"); !undone) error.trail.push_back(undone.error().line());
    return tl::unexpected(std::move(error));
  }
  return database_.script("COMMIT");
}

core::Status RunLog::add_pick(const PickRecord& pick) {
  auto added = database_.execute(
      "INSERT INTO pick VALUES (?1,?2,?3,?4,?5,?6,?7,NULL)",
      {std::int64_t{pick.sequence}, static_cast<std::int64_t>(pick.detection_id), std::int64_t{pick.place_slot},
       pick.outcome, std::int64_t{pick.reason}, pick.text, pick.t_submit_us});
  if (!added) return core::forward(added);
  return {};
}

core::Status RunLog::end_pick(const PickRecord& pick) {
  auto ended = database_.execute(
      "UPDATE pick SET outcome=?2, reason=?3, text=?4, t_end_us=?5 WHERE sequence=?1",
      {std::int64_t{pick.sequence}, pick.outcome, std::int64_t{pick.reason}, pick.text, pick.t_end_us});
  if (!ended) return core::forward(ended);
  return {};
}

core::Status RunLog::add_event(std::int64_t unix_us, std::string_view kind, std::string_view text) {
  auto added =
      database_.execute("INSERT INTO event VALUES (?1,?2,?3)", {unix_us, std::string(kind), std::string(text)});
  if (!added) return core::forward(added);
  return {};
}

}  // namespace pickcell::cell
