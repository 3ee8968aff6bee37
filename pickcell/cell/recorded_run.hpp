#pragma once
/// A run's folder, read: what run_log.hpp wrote, here or on another machine. Nothing in the folder is changed.

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "pickcell/cell/database.hpp"
#include "pickcell/cell/kept_files.hpp"
#include "pickcell/core/result.hpp"
#include "pickcell/core/transform.hpp"
#include "pickcell/matches/match.hpp"
#include "pickcell/poses/part_pose.hpp"

namespace pickcell::cell {

/// What run.toml says.
struct RecordedInfo {
  int format = 1;
  std::string started, cell_name, camera_id, robot_link, engine;
  std::filesystem::path cell_file;  ///< where it lay when the run began
  bool simulated = false;
  std::optional<KeptFiles> kept;  ///< paths in the run's folder
};

/// A part in the robot's frame, as it was recorded.
struct RecordedPlace {
  double x_mm = 0, y_mm = 0, z_mm = 0;
  double angle_deg = 0;
};
[[nodiscard]] RecordedPlace place_of(const poses::PartPose& part);

/// One thing that was seen in a picture.
struct RecordedFind {
  std::int64_t id = 0;
  std::string part;
  matches::Pose2d pose;
  double score = 0;
  std::optional<RecordedPlace> place;  ///< of those that could be located
  bool rejected = false;
  std::optional<std::string> code;  ///< why rejected, "" when it was not; unset: not recorded (format 1)
  std::string why;                  ///< the same in words
};

struct RecordedFrame {
  std::int64_t sequence = 0;
  std::int64_t exposed_unix_us = 0;
  std::string camera_id;
  int width_px = 0, height_px = 0;
  double match_ms = 0;
  std::string file;  ///< from the run's folder; empty: its picture was not kept
  std::optional<core::Transform<core::Base, core::Flange>> T_base_flange;
};

/// One thread at a time. Errors: unreadable: no run, damage, a format of the future; each names file, row and column.
class RecordedRun {
 public:
  [[nodiscard]] static core::Result<RecordedRun> open(const std::filesystem::path& folder);

  [[nodiscard]] const std::filesystem::path& folder() const { return folder_; }
  [[nodiscard]] const RecordedInfo& info() const { return info_; }
  /// In the order they were taken.
  [[nodiscard]] const std::vector<RecordedFrame>& frames() const { return frames_; }
  /// What was seen in this frame, in the order it was recorded.
  [[nodiscard]] core::Result<std::vector<RecordedFind>> finds(const RecordedFrame& frame);
  /// The log was not closed: a power cut ended the run, or it still goes on.
  [[nodiscard]] bool open_end() const { return open_end_; }

 private:
  RecordedRun(std::filesystem::path folder, RecordedInfo info, Database database, bool open_end)
      : folder_(std::move(folder)), info_(std::move(info)), database_(std::move(database)), open_end_(open_end) {}
  [[nodiscard]] core::Status read_frames();

  std::filesystem::path folder_;
  RecordedInfo info_;
  Database database_;
  bool open_end_;
  std::vector<RecordedFrame> frames_;
};

/// run.toml; run: its folder. Problems are noted in file: the caller calls finish().
[[nodiscard]] RecordedInfo read_run_toml(core::Config& file, const std::filesystem::path& run);

/// Rows of picks.db as RecordedRun asks for them, from anywhere: every column's type and range is checked. where: how
/// errors call the row.
[[nodiscard]] core::Result<RecordedFrame> frame_from(const SqlRow& row, const std::string& where);
[[nodiscard]] core::Result<RecordedFind> find_from(const SqlRow& row, const std::string& where);

}  // namespace pickcell::cell
