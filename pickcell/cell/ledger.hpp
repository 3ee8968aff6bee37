#pragma once
/// What was seen and done: counters, places, the shown picture's detections, the run log. One entry for each event, so
/// that page, counters and records cannot disagree.

#include <cstdint>
#include <deque>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "pickcell/cell/cell_port.hpp"
#include "pickcell/cell/desk.hpp"
#include "pickcell/cell/run_log.hpp"
#include "pickcell/cell/tray.hpp"
#include "pickcell/cell/vision.hpp"
#include "pickcell/core/clock.hpp"
#include "pickcell/picks/planner.hpp"
#include "pickcell/robot/robot.hpp"

namespace pickcell::cell {

/// A pick that was handed over, or was about to be, and whose end is not known yet.
struct OpenPick {
  picks::Pick pick;
  std::size_t kind = 0;                              ///< place in the recipe
  Eigen::Vector2d part_m = Eigen::Vector2d::Zero();  ///< where the part lay, base x, y
  std::int32_t sequence = 0;                         ///< 0: the hand-over failed before it was known
  std::int64_t t_submit_us = 0;
};

/// The cell's thread only.
class Ledger {
 public:
  Ledger(RunLog log, Desk& desk, const core::Clock& clock, std::vector<int> tray_sizes)
      : log_(std::move(log)), desk_(desk), clock_(clock), tray_(std::move(tray_sizes)) {}

  /// A picture was searched. plan says which of its parts are queued; everything else is counted by its reason once.
  [[nodiscard]] core::Status saw(frames::Frame frame, const Sight& sight, const picks::Plan& plan, double grab_ms,
                                 const std::vector<matches::Model>& models, const std::string& recipe);

  /// The place is reserved before the first byte goes out.
  void begin(OpenPick pick);
  [[nodiscard]] core::Status handed_over(std::int32_t sequence);
  /// The end of the open pick. Nothing of it is left open afterwards.
  [[nodiscard]] core::Status end(const robot::Outcome& outcome);
  /// The open pick was never handed over: its part and its place are as before.
  void give_back(const std::string& code, const std::string& why);
  [[nodiscard]] const std::optional<OpenPick>& open() const { return open_; }

  [[nodiscard]] core::Status event(std::string_view kind, std::string_view text) {
    return log_.add_event(clock_.unix_us(), kind, text);
  }

  [[nodiscard]] Counters counters() const;
  [[nodiscard]] std::int64_t dealt_with() const { return counters_.placed + counters_.missed + counters_.unknown; }
  [[nodiscard]] Tray& tray() { return tray_; }
  [[nodiscard]] StandingParts& standing() { return standing_; }
  [[nodiscard]] int attempts(const std::string& model, const Eigen::Vector2d& p_m) const {
    return standing_.attempts(model, p_m);
  }
  [[nodiscard]] std::uint64_t next_detection_id() const { return next_detection_id_; }
  /// Picking began (again): the time to the first end counts from here.
  void cycle_begins() { last_end_ = clock_.now(); }
  [[nodiscard]] const std::vector<double>& cycle_s() const { return cycle_s_; }
  [[nodiscard]] const std::vector<double>& match_ms() const { return match_ms_; }
  [[nodiscard]] const std::filesystem::path& run_folder() const { return log_.folder(); }

 private:
  void mark(std::uint64_t detection_id, DetectionState state, const std::string& why);

  RunLog log_;
  Desk& desk_;
  const core::Clock& clock_;
  Tray tray_;
  StandingParts standing_;
  Counters counters_;
  std::optional<OpenPick> open_;
  std::uint64_t next_detection_id_ = 1;
  core::TimePoint last_end_{};
  std::vector<double> cycle_s_, match_ms_;
  std::deque<core::TimePoint> placed_at_;  ///< within the window of the rate
};

}  // namespace pickcell::cell
