#pragma once
/// The cell: grab, match, locate, plan, hand over, wait for the outcome; idle, running, stopping or in fault, and
/// always able to say why. It sees interfaces only: it cannot tell a simulated camera or controller from a real one.

#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "pickcell/cell/arm.hpp"
#include "pickcell/cell/camera_watch.hpp"
#include "pickcell/cell/cell_config.hpp"
#include "pickcell/cell/cell_port.hpp"
#include "pickcell/cell/desk.hpp"
#include "pickcell/cell/halt.hpp"
#include "pickcell/cell/ledger.hpp"
#include "pickcell/cell/run_log.hpp"
#include "pickcell/cell/vision.hpp"
#include "pickcell/core/clock.hpp"
#include "pickcell/frames/frame_source.hpp"
#include "pickcell/picks/planner.hpp"
#include "pickcell/robot/robot.hpp"

namespace pickcell::cell {

/// Whether the camera still stands where it was calibrated, from a picture of the board in its reference place: words
/// when it does. Errors: negative: no board; safety: it does not.
using CameraCheck = std::function<core::Result<std::string>(const frames::Frame&)>;

/// What a cell is put together from. The references must outlive it.
struct CellParts {
  core::Clock& clock;
  std::unique_ptr<core::Seat> seat;  ///< the cell's own, on that clock
  frames::FrameSource& source;
  robot::Robot& robot;
  Vision vision;
  RunLog log;
  TrayRecord* trays = nullptr;  ///< null: trays are forgotten with the process
  CameraCheck camera_check{};   ///< asked once, before the first pick; empty: never
};

struct CellSettings {
  std::string name;
  std::string robot_link;  ///< as people know it
  std::string recipe;
  picks::PlannerSettings planner;
  FeedConfig feed;
  bool allow_motion = false;
  bool simulated = false;
  bool exchange_full_trays = false;
  int stop_after_refused = 5;
  int attempts_per_part = 2;
  double pick_timeout_s = 30;
  double clear_timeout_s = 30;  ///< from the end of a pick until the arm is out of the picture
  double grab_timeout_s = 2;
  double camera_wait_s = 60;          ///< for a camera that got lost while the cell runs; then it is a fault
  std::int64_t stop_after_picks = 0;  ///< stand when so many picks are dealt with; 0: never
  bool board_is_taken_away = false;   ///< after the camera check the cell stands and waits for another Start
  core::Transform<core::Flange, core::Tool> T_flange_tool;  ///< of the poses that the arm gives, for a camera on it
  bool start_at_once = false;  ///< as if Start was pressed when the robot is connected: for runs without a person
};

/// The planner's view of the cell file. models: in the order of the file, with the heights that its parts really have
/// (a tray's origin is on its floor, the planner places top faces).
[[nodiscard]] CellSettings settings_from(const CellConfig& config, const std::vector<matches::Model>& models);

/// Public members are thread-safe. The destructor stops the cell's thread; a pick in flight then stays open in the
/// journal and is settled at the next connect.
class Cell final : public CellPort {
 public:
  Cell(CellParts parts, CellSettings settings);
  ~Cell() override;

  /// Begins the cell's thread: connects to the robot, then stands idle (or starts at once).
  void open();
  /// Ends the cell's thread. Nothing is handed over any more.
  void close();
  /// Waits (wall time) until the cell stands after having run, or is in fault.
  void wait_until_done() const;

  [[nodiscard]] Snapshot snapshot() const override { return desk_.snapshot(); }
  [[nodiscard]] std::shared_ptr<const ShownFrame> latest_frame() const override { return desk_.frame(); }
  [[nodiscard]] core::Status start() override;
  [[nodiscard]] core::Status stop_cycle() override;
  [[nodiscard]] core::Status reset() override;
  int on_change(std::function<void()> listener) override { return desk_.listen(std::move(listener)); }
  void remove_listener(int handle) override { desk_.remove(handle); }

  [[nodiscard]] const CellSettings& settings() const { return settings_; }
  /// After close(): the figures of the report.
  [[nodiscard]] const Ledger& ledger() const { return ledger_; }

 private:
  void live();
  [[nodiscard]] Or<void> stand_by();
  void do_reset();
  void enter(const Halt& halt);

  // The working cycle (cycle.cpp). Every step returns why it cannot go on.
  [[nodiscard]] Halt work();
  [[nodiscard]] Or<void> begin_work();
  [[nodiscard]] Or<void> settle();
  [[nodiscard]] Or<void> wait_until_clear();
  [[nodiscard]] Or<void> check_camera();
  /// With the arm's pose at exposure, when the camera is on it.
  [[nodiscard]] Or<frames::Frame> picture_with_pose();
  [[nodiscard]] Or<void> look();
  [[nodiscard]] Or<frames::Frame> take_picture();
  [[nodiscard]] Or<void> wait_for_camera(core::TimePoint deadline);
  [[nodiscard]] Or<void> pick_next();
  [[nodiscard]] Or<robot::Outcome> wait_for_outcome();
  [[nodiscard]] Or<void> judge(const robot::Outcome& outcome);
  [[nodiscard]] Or<void> feed();
  [[nodiscard]] Or<void> move_belt();
  [[nodiscard]] Or<void> ask_for_pitch();  ///< until the belt stands again; leaves the contact on
  [[nodiscard]] Or<void> wait_until_belt_stands();
  /// Sleeps one poll of the clock and looks at the arm.
  [[nodiscard]] Or<robot::RobotState> rest(Arm::Need need);
  void give_up_on_stubborn(Sight& sight) const;
  [[nodiscard]] Or<void> exchange_full_trays();
  /// Which places are filled, from the record: after a restart, and when picks of an earlier process were settled.
  [[nodiscard]] Or<void> recall_trays();

  void show(Mode mode, std::string step);
  void show_step(std::string step) { show(mode_, std::move(step)); }
  void publish();
  /// Looks how the camera is; publishes when that is news.
  void watch_camera();

  core::Clock& clock_;
  std::unique_ptr<core::Seat> seat_;
  frames::FrameSource& source_;
  Vision vision_;
  CellSettings settings_;
  Desk desk_;
  Ledger ledger_;
  Arm arm_;
  CameraWatch camera_;
  TrayRecord* trays_;
  CameraCheck camera_check_;  ///< empty once it was passed

  Mode mode_ = Mode::idle;
  std::string step_, reason_code_, reason_, remedy_;
  bool person_must_look_ = false;
  int refused_in_row_ = 0;
  int empty_in_row_ = 0;
  std::string full_tray_;           ///< a part that could be picked had no place left
  std::vector<picks::Pick> queue_;  ///< of the newest picture, next one last
  std::vector<poses::PartPose> parts_;

  std::atomic<bool> quit_{false};
  std::atomic<bool> has_stopped_{false};
  std::thread thread_;
};

}  // namespace pickcell::cell
