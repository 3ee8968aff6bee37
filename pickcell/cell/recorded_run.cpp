#include "pickcell/cell/recorded_run.hpp"

#include <system_error>
#include <utility>

#include "pickcell/cell/run_log.hpp"

namespace pickcell::cell {

using core::ErrorCode;
using core::failure;
namespace fs = std::filesystem;

namespace {

constexpr const char* kLog = "picks.db";

core::Result<RecordedInfo> load_run_toml(const fs::path& folder) {
  const fs::path path = folder / "run.toml";
  std::error_code ignored;
  if (!fs::exists(path, ignored))
    return failure(ErrorCode::unreadable, folder.string(), "no run: it has no run.toml",
                   "name the folder of one run, STATE_DIR/runs/DATE");
  auto file = core::Config::load(path);
  if (!file) return core::forward(file);
  // Before anything else: what a newer program wrote is not judged by today's keys.
  const std::int64_t format = file->integer_or("format", 1);
  if (format < 1 || format > kRunFormat)
    return failure(ErrorCode::unreadable, path.string(),
                   "format " + std::to_string(format) + ", and this program knows up to " + std::to_string(kRunFormat),
                   "use the pickcell that recorded it, or a newer one");
  RecordedInfo info = read_run_toml(*file, fs::absolute(folder));
  if (auto finished = file->finish(); !finished) return core::forward(finished);
  return info;
}

core::Status check_tables(Database& database, int format, const std::string& name) {
  const auto version = database.execute("PRAGMA user_version");
  if (!version) return tl::unexpected(version.error());
  const std::int64_t found = version->empty() ? 0 : as_integer(version->front().front());
  if (found == 0)
    return failure(ErrorCode::unreadable, name, "it is empty",
                   "what a run that was not closed wrote stands beside it in picks.db-wal: copy that too");
  if (found != format)
    return failure(ErrorCode::unreadable, name,
                   "format " + std::to_string(found) + ", and run.toml says " + std::to_string(format),
                   "the two files are not of one run: restore the folder from its archive");
  const auto tables =
      database.execute("SELECT count(*) FROM sqlite_schema WHERE type='table' AND name IN ('frame','detection')");
  if (!tables) return tl::unexpected(tables.error());
  if (as_integer(tables->front().front()) == 2) return {};
  return failure(ErrorCode::unreadable, name, "has no tables of frames and detections",
                 "restore the run's folder from its archive");
}

}  // namespace

core::Result<RecordedRun> RecordedRun::open(const fs::path& folder) {
  auto info = load_run_toml(folder);
  if (!info) return core::forward(info);
  const fs::path log = folder / kLog;
  std::error_code ignored;
  const bool open_end = fs::file_size(log.string() + "-wal", ignored) > 0 && !ignored;
  auto database = Database::open_to_read(log);
  if (!database) return core::forward(database);
  if (auto fits = check_tables(*database, info->format, log.string()); !fits) return core::forward(fits);
  RecordedRun run(folder, std::move(*info), std::move(*database), open_end);
  if (auto read = run.read_frames(); !read) return core::forward(read);
  return run;
}

core::Status RecordedRun::read_frames() {
  const std::string flange = info_.format >= 2 ? "T_base_flange" : "NULL";
  const auto rows =
      database_.execute("SELECT sequence, exposed_unix_us, camera_id, width_px, height_px, match_ms, file, " + flange +
                        " FROM frame ORDER BY sequence");
  if (!rows) return tl::unexpected(rows.error());
  for (const SqlRow& row : *rows) {
    auto frame =
        frame_from(row, (folder_ / kLog).string() + ", table frame, row " + std::to_string(frames_.size() + 1));
    if (!frame) return core::forward(frame);
    frames_.push_back(std::move(*frame));
  }
  return {};
}

core::Result<std::vector<RecordedFind>> RecordedRun::finds(const RecordedFrame& frame) {
  const std::string code = info_.format >= 2 ? "code" : "NULL";
  const auto rows = database_.execute(
      "SELECT id, part, x_px, y_px, angle_deg, scale, score, base_x_mm, base_y_mm, base_z_mm, base_angle_deg, "
      "rejected, "
      "reason, " +
          code + " FROM detection WHERE frame = ?1 ORDER BY id",
      {frame.sequence});
  if (!rows) return tl::unexpected(rows.error());
  std::vector<RecordedFind> out;
  for (const SqlRow& row : *rows) {
    auto find = find_from(row, (folder_ / kLog).string() + ", table detection, row " + std::to_string(out.size() + 1) +
                                   " of frame " + std::to_string(frame.sequence));
    if (!find) return core::forward(find);
    out.push_back(std::move(*find));
  }
  return out;
}

}  // namespace pickcell::cell
