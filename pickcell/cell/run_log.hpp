#pragma once
/// A run is a folder: run.toml (what ran), picks.db (what was seen and done), and where pictures are wanted frames/ and
/// cell/ (the files it ran with). For people, reports and replays (recorded_run.hpp); never read to recover: that is
/// the journal's job.

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include "pickcell/cell/cell_port.hpp"
#include "pickcell/cell/database.hpp"
#include "pickcell/cell/kept_files.hpp"
#include "pickcell/core/result.hpp"
#include "pickcell/matches/match.hpp"
#include "pickcell/poses/part_pose.hpp"

namespace pickcell::cell {

/// Of run.toml and of picks.db (its user_version). 1: without codes of rejections, the arm's pose, kept files.
constexpr int kRunFormat = 2;

/// What run.toml says.
struct RunInfo {
  std::string cell_name;
  std::filesystem::path cell_file;
  std::string camera_id;
  std::string robot_link;
  std::string engine;
  std::int64_t start_unix_us = 0;
  bool simulated = false;
  std::optional<KeptFiles> files{};  ///< copied where pictures are kept
};

/// One pick as it ended, or as it stands.
struct PickRecord {
  std::uint64_t detection_id = 0;
  std::int32_t sequence = 0;
  int place_slot = 0;
  std::string outcome;  ///< "submitted" | "done" | "refused" | "not_started" | "unknown"
  int reason = 0;       ///< B011
  std::string text;
  std::int64_t t_submit_us = 0, t_end_us = 0;
};

/// Every call is durable when it returns (SQLite WAL, synchronous=FULL), so that a power cut at any moment loses at
/// most the pick in flight. One thread at a time. Errors: unreadable (disk full, not writable).
class RunLog {
 public:
  /// Makes runs_dir/YYYYMMDD-HHMMSS[-n] (UTC, a new folder each time) and its files.
  [[nodiscard]] static core::Result<RunLog> create(const std::filesystem::path& runs_dir, const RunInfo& info,
                                                   bool record_frames);

  /// One searched picture with everything found in it. poses: of the detections that could be located, by detection_id.
  /// Writes the picture too when frames are recorded.
  [[nodiscard]] core::Status add_frame(const ShownFrame& shown, const std::vector<matches::Match>& found,
                                       const std::vector<poses::PartPose>& poses);
  [[nodiscard]] core::Status add_pick(const PickRecord& pick);
  /// Completes the row of this sequence.
  [[nodiscard]] core::Status end_pick(const PickRecord& pick);
  /// Something that happened to the cell: started, stopped, fault with its reason.
  [[nodiscard]] core::Status add_event(std::int64_t unix_us, std::string_view kind, std::string_view text);

  [[nodiscard]] const std::filesystem::path& folder() const { return folder_; }

 private:
  RunLog(std::filesystem::path folder, Database database, bool record_frames)
      : folder_(std::move(folder)), database_(std::move(database)), record_frames_(record_frames) {}

  std::filesystem::path folder_;
  Database database_;
  bool record_frames_;
};

}  // namespace pickcell::cell
