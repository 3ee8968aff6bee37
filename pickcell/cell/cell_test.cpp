/// The cell's behaviour with an arm and a camera that do exactly what a test says, on a simulated clock. The same cell
/// against the simulated world and controller: tests/cell.
#include "pickcell/cell/cell.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <functional>
#include <mutex>

#include "pickcell/core/units.hpp"

namespace pickcell::cell {
namespace {

using core::duration_s;
using robot::Outcome;
using robot::OutcomeKind;
using robot::RobotState;

constexpr int kWidthPx = 640, kHeightPx = 480;

/// Parts on the table as the camera sees them: 1 mm per pixel, picture centre at base x = 400, y = 0.
struct Table {
  struct Lying {
    double x_px, y_px;
    double score = 0.95;
    std::vector<double> ambiguous_deg;
    double sigma_px = 0.05;
  };
  std::vector<Lying> parts;

  /// The part under a tool, or -1.
  [[nodiscard]] int under(const Eigen::Vector3d& tool_m) const {
    for (std::size_t i = 0; i < parts.size(); ++i) {
      const double x_m = 0.4 + (parts[i].x_px - (kWidthPx - 1) / 2.0) * 1e-3;
      const double y_m = -(parts[i].y_px - (kHeightPx - 1) / 2.0) * 1e-3;
      if (std::hypot(tool_m.x() - x_m, tool_m.y() - y_m) < 0.002) return static_cast<int>(i);
    }
    return -1;
  }
};

class TableCamera final : public frames::FrameSource {
 public:
  explicit TableCamera(core::Clock& clock) : clock_(clock) {}
  [[nodiscard]] frames::SourceInfo info() const override { return {"cam", kWidthPx, kHeightPx, true}; }
  [[nodiscard]] core::Result<frames::Frame> grab(core::Seat& seat, core::Duration) override {
    seat.sleep_for(duration_s(0.02));
    frames::Frame frame;
    frame.picture = std::make_shared<const image::Image>(kWidthPx, kHeightPx);
    frame.sequence = ++sequence_;
    frame.exposed = seat.now();
    frame.exposed_unix_us = clock_.unix_us();
    frame.camera_id = camera_id;
    return frame;
  }
  std::string camera_id = "cam";

 private:
  core::Clock& clock_;
  std::uint64_t sequence_ = 0;
};

class TableEngine final : public matches::Engine {
 public:
  explicit TableEngine(const Table& table) : table_(table) {}
  [[nodiscard]] core::Result<matches::FindResult> find(const image::Pyramid&,
                                                       std::span<const matches::Model* const> models,
                                                       const matches::SearchOptions&) override {
    matches::FindResult out;
    for (const Table::Lying& part : table_.parts) {
      matches::Match m;
      m.model = models[0]->name;
      m.pose = {part.x_px, part.y_px, 0, 1};
      m.score = part.score;
      m.ambiguous_deg = part.ambiguous_deg;
      m.covariance.diagonal() << part.sigma_px * part.sigma_px, part.sigma_px * part.sigma_px, 0.0025, 1e-8;
      out.matches.push_back(m);
    }
    return out;
  }
  [[nodiscard]] std::string name() const override { return "table"; }

 private:
  const Table& table_;
};

/// Takes two seconds for a pick. What happens to the n-th pick (from 1) is said in `script`.
class TableRobot final : public robot::Robot {
 public:
  struct Event {
    double after_s = 1.0;                              ///< after the hand-over
    std::function<void(RobotState&)> change;           ///< of the arm's state
    std::optional<Outcome> outcome;                    ///< instead of done
    bool lose_link = false, carries_on_alone = false;  ///< the pick ends although nobody watches
    std::optional<core::Error> refuse_submit;
    bool never_ends = false;
  };
  TableRobot(core::Clock& clock, Table& table) : clock_(clock), table_(table) {
    state_.play = state_.remote = state_.clear_of_camera = true;
  }

  [[nodiscard]] core::Status connect(core::Seat&) override {
    ++connects;
    if (refuse_connect) return core::failure(core::ErrorCode::link, "robot", "connection refused");
    connected_ = true;
    settle_lost_pick();
    if (person_needed) return core::failure(core::ErrorCode::refused, "robot", "an outcome is unknown", "look");
    return {};
  }
  [[nodiscard]] bool connected() const override { return connected_; }
  [[nodiscard]] core::Result<RobotState> state() override {
    if (auto fault = play_script(); !fault) return core::forward(fault);
    return state_;
  }
  [[nodiscard]] core::Result<std::vector<robot::Alarm>> alarms() override {
    return std::vector<robot::Alarm>{{4315, 1, "COLLISION DETECT"}};
  }
  [[nodiscard]] core::Result<core::Transform<core::Base, core::Tool>> pose() override {
    if (other_tool) return core::failure(core::ErrorCode::refused, "robot", "tool 3 is selected");
    return core::Transform<core::Base, core::Tool>();
  }
  [[nodiscard]] core::Status start(core::Seat&) override {
    ++starts;
    if (person_needed) return core::failure(core::ErrorCode::refused, "robot", "an outcome is unknown", "look");
    state_.servo = state_.running = true;
    if (open_ && !open_->reported) finish_open();
    return {};
  }
  [[nodiscard]] core::Status confirm(core::Seat&) override {
    ++confirms;
    person_needed = false;
    return {};
  }
  [[nodiscard]] std::vector<Outcome> take_settled() override { return std::exchange(settled_, {}); }
  [[nodiscard]] core::Result<std::int32_t> submit(const picks::Pick& pick) override {
    const Event event = script.contains(sequence_ + 1) ? script[sequence_ + 1] : Event{};
    ++sequence_;
    if (event.refuse_submit) return tl::unexpected(*event.refuse_submit);
    submitted.push_back(pick);
    open_ = Open{pick, event, clock_.now(), false, false};
    return sequence_;
  }
  [[nodiscard]] core::Result<std::optional<Outcome>> outcome() override {
    if (open_->event.never_ends || clock_.now() - open_->begun < duration_s(2)) return std::optional<Outcome>();
    Outcome out = open_->event.outcome.value_or(Outcome{OutcomeKind::done, sequence_, 0, "done"});
    out.sequence = sequence_;
    if (out.kind == OutcomeKind::done) lift(open_->pick);
    if (out.kind == OutcomeKind::unknown) person_needed = true;
    open_.reset();
    return std::optional<Outcome>(out);
  }
  [[nodiscard]] core::Status hold(bool on) override {
    holds += on;
    state_.hold_command = on;
    return {};
  }
  [[nodiscard]] core::Status reset() override {
    state_.alarm = false;
    return {};
  }
  [[nodiscard]] core::Status write_contact(int contact, bool on) override {
    EXPECT_EQ(contact, 27010);
    const bool was_on = std::exchange(advance_on, on), edge = on && !was_on;
    if (edge && !belt_stuck) belt_until_ = clock_.now() + duration_s(1.5);
    if (edge && next_parts) table_.parts = next_parts();
    return {};
  }
  [[nodiscard]] core::Result<bool> read_contact(int contact) override {
    if (contact == 27010) return advance_on;
    EXPECT_EQ(contact, 11);
    return clock_.now() < belt_until_;
  }
  void disconnect() override { connected_ = false; }

  RobotState& arm() { return state_; }
  std::map<int, Event> script;
  bool other_tool = false, belt_stuck = false;
  bool advance_on = false;  ///< the network input that the feeder waits for an edge of
  std::function<std::vector<Table::Lying>()> next_parts;
  std::vector<picks::Pick> submitted;
  std::vector<Table::Lying> lifted;
  int starts = 0, connects = 0, confirms = 0, holds = 0;
  bool refuse_connect = false, person_needed = false;
  std::optional<core::TimePoint> changed_at;  ///< when the script last changed something

 private:
  struct Open {
    picks::Pick pick;
    Event event;
    core::TimePoint begun;
    bool played, reported;
  };
  core::Status play_script() {
    if (!connected_) return core::failure(core::ErrorCode::link, "robot", "not connected");
    if (!open_ || open_->played || clock_.now() - open_->begun < duration_s(open_->event.after_s)) return {};
    open_->played = true;
    if (open_->event.change) {
      open_->event.change(state_);
      changed_at = clock_.now();
    }
    if (open_->event.lose_link) {
      changed_at = clock_.now();
      connected_ = false;
      return core::failure(core::ErrorCode::link, "robot", "connection reset by peer");
    }
    return {};
  }
  void settle_lost_pick() {
    if (open_ && open_->event.carries_on_alone) finish_open();
  }
  void finish_open() {
    lift(open_->pick);
    settled_.push_back({OutcomeKind::done, sequence_, 0, "done"});
    open_.reset();
  }
  void lift(const picks::Pick& pick) {
    const int i = table_.under(pick.T_base_grasp.translation_m());
    ASSERT_GE(i, 0) << "nothing lies where the arm grips: a part was picked twice";
    lifted.push_back(table_.parts[static_cast<std::size_t>(i)]);
    table_.parts.erase(table_.parts.begin() + i);
  }

  core::Clock& clock_;
  Table& table_;
  RobotState state_;
  bool connected_ = false;
  std::int32_t sequence_ = 0;
  std::optional<Open> open_;
  std::vector<Outcome> settled_;
  core::TimePoint belt_until_{};
};

matches::Model square_model() {
  matches::Model model;
  model.name = "square";
  model.picture = image::Image(41, 41);
  model.ref_x_px = model.ref_y_px = 20;
  model.learnt.suggested_min_score = 0.7;
  model.grasps = {{20, 20, 0, true}};
  return model;
}

class CellTest : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = std::filesystem::path(::testing::TempDir()) /
              ("pickcell_cell_" + std::string(::testing::UnitTest::GetInstance()->current_test_info()->name()));
    std::filesystem::remove_all(folder_);
    settings_.planner.box = {{0, -0.6, -0.1}, {1, 0.6, 0.5}};
    picks::PlacePattern tray;
    tray.origin_m = {0.3, 0.4, 0};
    tray.rows = 1;
    tray.cols = 6;
    tray.pitch_x_m = 0.05;
    settings_.planner.parts = {{"square", 0, tray}};
    settings_.allow_motion = true;
    settings_.feed.empty_pitches_max = 1;
  }
  void TearDown() override {
    cell_.reset();
    std::filesystem::remove_all(folder_);
  }

  Vision::Settings calibration() const {
    Vision::Settings s;
    s.camera.lens.width_px = kWidthPx;
    s.camera.lens.height_px = kHeightPx;
    s.camera.lens.fx_px = s.camera.lens.fy_px = 1000;
    s.camera.lens.cx_px = (kWidthPx - 1) / 2.0;
    s.camera.lens.cy_px = (kHeightPx - 1) / 2.0;
    s.camera.camera_id = "cam";
    s.camera.verdict = s.plane.verdict = poses::Verdict::good;
    s.camera.date = s.plane.date = "2026-01-01T00:00:00Z";
    Eigen::Matrix3d down;
    down << 1, 0, 0, 0, -1, 0, 0, 0, -1;
    s.plane.T_base_camera = core::Transform<core::Base, core::Camera>(down, {0.4, 0, 1});
    s.plane.rms_mm = 0.05;
    return s;
  }

  Cell& open() {
    auto log =
        RunLog::create(folder_ / "runs", {"test", "CELL.toml", "cam", "test", "table", clock_.unix_us(), true}, false);
    EXPECT_TRUE(log) << log.error().line();
    std::vector<matches::Model> models;
    models.push_back(square_model());
    Vision vision(std::make_unique<TableEngine>(table_), std::move(models), calibration());
    cell_ = std::make_unique<Cell>(
        CellParts{clock_, clock_.join("cell"), camera_, robot_, std::move(vision), std::move(*log)}, settings_);
    {
      const std::lock_guard lock(mutex_);
      seen_ = {};
    }
    cell_->on_change([this, cell = cell_.get()] {
      const Snapshot now = cell->snapshot();
      const std::lock_guard lock(mutex_);
      if (now.mode == Mode::fault && seen_.mode != Mode::fault) fault_at_ = clock_.now();
      seen_ = now;
      changed_.notify_all();
    });
    cell_->open();
    return *cell_;
  }
  Snapshot wait(const std::function<bool(const Snapshot&)>& condition) {
    std::unique_lock lock(mutex_);
    EXPECT_TRUE(changed_.wait_for(lock, std::chrono::seconds(30), [&] { return condition(seen_); }))
        << name(seen_.mode) << ": " << seen_.step << " / " << seen_.reason;
    return seen_;
  }
  Snapshot wait_ready() {
    return wait([](const Snapshot& s) { return s.mode == Mode::idle && s.step == "ready"; });
  }
  /// Presses Start and waits until the cell stands again.
  Snapshot run() {
    wait_ready();
    const auto before = wait_ready().counters.frames;
    auto started = cell_->start();
    EXPECT_TRUE(started) << started.error().line();
    return wait([&](const Snapshot& s) {
      return (s.mode == Mode::idle || s.mode == Mode::fault) && (s.counters.frames > before || s.mode == Mode::fault) &&
             !s.reason.empty();
    });
  }
  void press_reset() {
    auto pressed = cell_->reset();
    EXPECT_TRUE(pressed);
  }

  core::SimulatedClock clock_;
  Table table_;
  TableCamera camera_{clock_};
  TableRobot robot_{clock_, table_};
  CellSettings settings_;
  std::filesystem::path folder_;
  std::mutex mutex_;
  std::condition_variable changed_;
  Snapshot seen_;
  core::TimePoint fault_at_{};
  std::unique_ptr<Cell> cell_;
};

TEST_F(CellTest, PicksEverythingFromOnePictureThenStands) {
  table_.parts = {{200, 150, .95, {}, .05}, {400, 150, .95, {}, .05}, {300, 350, .95, {}, .05}};
  open();
  const Snapshot end = run();
  EXPECT_EQ(end.mode, Mode::idle);
  EXPECT_NE(end.reason.find("no part to pick"), std::string::npos) << end.reason;
  EXPECT_EQ(end.counters.placed, 3);
  EXPECT_EQ(end.counters.submitted, 3);
  EXPECT_EQ(robot_.lifted.size(), 3u);
  std::set<int> slots;
  for (const auto& pick : robot_.submitted) slots.insert(pick.place_slot);
  EXPECT_EQ(slots, (std::set<int>{0, 1, 2}));
  // One look for the three, one more to see that nothing is left, one more after waiting for parts.
  EXPECT_EQ(end.counters.frames, 3);
}

TEST_F(CellTest, EveryUnfitMatchIsCountedOnceByItsReason) {
  table_.parts = {{100, 100, .50, {}, .05},     // below the threshold
                  {200, 100, .95, {90}, .05},   // ambiguous, and the grasp is not
                  {300, 100, .95, {180}, .05},  // ambiguous as the two-finger grasp is: picked
                  {400, 100, .95, {}, 5.0}};    // known to 5 mm only
  settings_.feed.empty_pitches_max = 3;
  open();
  const Snapshot end = run();
  EXPECT_EQ(end.counters.placed, 1);
  EXPECT_EQ(end.counters.rejected,
            (std::map<std::string, std::int64_t>{{"score", 1}, {"ambiguous", 1}, {"uncertain", 1}}));
  const auto frame = cell_->latest_frame();
  ASSERT_TRUE(frame);
  for (const Detection& d : frame->detections) {
    EXPECT_EQ(d.state, DetectionState::rejected);
    EXPECT_FALSE(d.why.empty());
  }
}

TEST_F(CellTest, AForeignCameraIsNotPickedFrom) {
  table_.parts = {{200, 150, .95, {}, .05}};
  camera_.camera_id = "another";
  open();
  const Snapshot end = run();
  EXPECT_EQ(end.counters.submitted, 0);
  EXPECT_EQ(end.counters.rejected, (std::map<std::string, std::int64_t>{{"calibration", 1}}));
  EXPECT_EQ(end.mode, Mode::fault) << "looking on at a belt that runs past would help nobody";
  EXPECT_EQ(end.reason_code, "CALIBRATION");
  EXPECT_NE(end.reason.find("another"), std::string::npos) << end.reason;
}

TEST_F(CellTest, RefusesStartInWords) {
  settings_.allow_motion = false;
  Cell& cell = open();
  wait_ready();
  const auto refused = cell.start();
  ASSERT_FALSE(refused);
  EXPECT_NE(refused.error().line().find("allow_motion"), std::string::npos);
  const auto before_connecting = [&] {
    cell_.reset();
    robot_.arm().teach = true;
    settings_.allow_motion = true;
    open();
    return wait([](const Snapshot& s) { return !s.start_hindrance.empty(); });
  }();
  EXPECT_EQ(before_connecting.mode, Mode::idle);
  const auto teach = cell_->start();
  ASSERT_FALSE(teach);
  EXPECT_NE(teach.error().why.find("teach"), std::string::npos);
}

TEST_F(CellTest, AnArmThatDoesNotAnswerAtTheBeginningIsAFaultThatResetCures) {
  robot_.refuse_connect = true;
  open();
  const Snapshot fault = wait([](const Snapshot& s) { return s.mode == Mode::fault; });
  EXPECT_NE(fault.reason.find("connection refused"), std::string::npos);
  EXPECT_FALSE(fault.remedy.empty());
  EXPECT_FALSE(fault.robot.connected);
  ASSERT_FALSE(cell_->start());
  robot_.refuse_connect = false;
  press_reset();
  EXPECT_TRUE(wait_ready().robot.connected);
}

struct ArmFault {
  const char* code;
  std::function<void(RobotState&)> happens, person_repairs;
};

class CellArmFault : public CellTest, public ::testing::WithParamInterface<ArmFault> {};

TEST_P(CellArmFault, IsSeenWithin200MsNamedAndSurvived) {
  table_.parts = {{200, 150, .95, {}, .05}, {400, 150, .95, {}, .05}};
  robot_.script[1] = {1.0, GetParam().happens, {}, false, false, {}, true};
  open();
  const Snapshot fault = run();
  ASSERT_EQ(fault.mode, Mode::fault);
  EXPECT_LE(fault_at_ - *robot_.changed_at, std::chrono::milliseconds(200));
  ASSERT_FALSE(fault.alarms.empty());
  EXPECT_EQ(fault.alarms.front().code, GetParam().code);
  EXPECT_TRUE(fault.alarms.front().active);
  EXPECT_FALSE(fault.reason.empty());
  EXPECT_FALSE(fault.remedy.empty());
  EXPECT_EQ(robot_.submitted.size(), 1u) << "no new motion after a fault";
  EXPECT_FALSE(cell_->start());

  GetParam().person_repairs(robot_.arm());
  press_reset();
  const Snapshot ready = wait_ready();
  EXPECT_FALSE(ready.alarms.front().active);
  const Snapshot end = run();
  EXPECT_EQ(end.counters.placed, 2) << "the interrupted pick was finished by the job and is counted";
  EXPECT_EQ(robot_.submitted.size(), 2u) << "and not handed over again";
}

INSTANTIATE_TEST_SUITE_P(
    Faults, CellArmFault,
    ::testing::Values(
        ArmFault{"ROBOT_HELD",
                 [](RobotState& s) {
                   s.hold_pendant = true;
                   s.running = false;
                 },
                 [](RobotState& s) { s.hold_pendant = false; }},
        ArmFault{"ROBOT_HELD",
                 [](RobotState& s) {
                   s.hold_external = true;
                   s.running = false;
                 },
                 [](RobotState& s) { s.hold_external = false; }},
        ArmFault{"ROBOT_ALARM",
                 [](RobotState& s) {
                   s.alarm = true;
                   s.running = false;
                 },
                 [](RobotState&) {}},
        ArmFault{"ROBOT_SERVO_OFF", [](RobotState& s) { s.servo = s.running = false; }, [](RobotState&) {}},
        ArmFault{"ROBOT_TEACH",
                 [](RobotState& s) {
                   s.teach = true;
                   s.play = s.running = false;
                 },
                 [](RobotState& s) {
                   s.teach = false;
                   s.play = true;
                 }},
        ArmFault{"ROBOT_NOT_REMOTE", [](RobotState& s) { s.remote = false; }, [](RobotState& s) { s.remote = true; }},
        ArmFault{"ROBOT_STOPPED", [](RobotState& s) { s.running = false; }, [](RobotState&) {}}),
    [](const auto& fault) { return fault.param.code + std::to_string(fault.index); });

TEST_F(CellTest, AResetBeforeTheRepairStaysInFaultAndSaysWhy) {
  table_.parts = {{200, 150, .95, {}, .05}};
  robot_.script[1] = {1.0, [](RobotState& s) { s.hold_pendant = true; }, {}, false, false, {}, true};
  open();
  ASSERT_EQ(run().mode, Mode::fault);
  const int connects = robot_.connects;
  press_reset();
  wait([&](const Snapshot& s) { return robot_.connects > connects && s.step == "stopped by a fault"; });
  EXPECT_EQ(cell_->snapshot().mode, Mode::fault);
  EXPECT_NE(cell_->snapshot().reason.find("held from the pendant"), std::string::npos);
}

TEST_F(CellTest, ALinkLostMidPickIsSettledAndThePartIsNotPickedTwice) {
  table_.parts = {{200, 150, .95, {}, .05}, {400, 150, .95, {}, .05}};
  robot_.script[1].lose_link = robot_.script[1].carries_on_alone = true;
  open();
  const Snapshot fault = run();
  ASSERT_EQ(fault.mode, Mode::fault);
  EXPECT_EQ(fault.alarms.front().code, "LINK_LOST");
  EXPECT_FALSE(fault.robot.connected);
  press_reset();
  EXPECT_EQ(wait_ready().counters.placed, 1) << "Reset found out that the arm had finished it";
  const Snapshot end = run();
  EXPECT_EQ(end.counters.placed, 2);
  EXPECT_EQ(robot_.submitted.size(), 2u);
  EXPECT_NE(robot_.submitted[0].place_slot, robot_.submitted[1].place_slot);
}

TEST_F(CellTest, ARefusedHandOverIsAFaultThatKeepsPartAndPlace) {
  table_.parts = {{200, 150, .95, {}, .05}};
  robot_.script[1].refuse_submit =
      core::Error{core::ErrorCode::refused, "LOADV", "error or alarm present (2060)", "clear the alarm", {}};
  open();
  const Snapshot fault = run();
  ASSERT_EQ(fault.mode, Mode::fault);
  EXPECT_NE(fault.reason.find("2060"), std::string::npos);
  EXPECT_EQ(fault.counters.submitted, 0);
  press_reset();
  wait_ready();
  const Snapshot end = run();
  EXPECT_EQ(end.counters.placed, 1);
  EXPECT_EQ(robot_.submitted.at(0).place_slot, 0);
}

TEST_F(CellTest, AnUnknownOutcomeWaitsForAPersonAndItsPlaceIsNotUsedAgain) {
  table_.parts = {{200, 150, .95, {}, .05}, {400, 150, .95, {}, .05}};
  robot_.script[1].outcome = Outcome{OutcomeKind::unknown, 0, 7, "held while it carried a part"};
  open();
  const Snapshot fault = run();
  ASSERT_EQ(fault.mode, Mode::fault);
  EXPECT_EQ(fault.counters.unknown, 1);
  const picks::Pick first = robot_.submitted.at(0);
  table_.parts.erase(table_.parts.begin() +
                     table_.under(first.T_base_grasp.translation_m()));  // the person took it away
  EXPECT_EQ(robot_.confirms, 0);
  press_reset();
  wait_ready();
  EXPECT_EQ(robot_.confirms, 1);
  const Snapshot end = run();
  EXPECT_EQ(end.counters.placed, 1);
  EXPECT_NE(robot_.submitted.at(1).place_slot, first.place_slot);
}

TEST_F(CellTest, AMissedGripIsTriedAgainThenLeftAlone) {
  table_.parts = {{200, 150, .95, {}, .05}};
  for (int n : {1, 2}) robot_.script[n].outcome = Outcome{OutcomeKind::refused, 0, 2, "nothing gripped"};
  open();
  const Snapshot end = run();
  EXPECT_EQ(end.mode, Mode::idle);
  EXPECT_EQ(end.counters.missed, 2);
  EXPECT_EQ(end.counters.rejected.at("gave_up"), 1);
  EXPECT_EQ(robot_.submitted.size(), 2u);
  EXPECT_EQ(robot_.submitted[1].place_slot, 0) << "nothing was put there";
}

TEST_F(CellTest, ManyFailedPicksInARowStopTheCell) {
  settings_.stop_after_refused = 3;
  settings_.attempts_per_part = 1;
  for (int i = 0; i < 5; ++i) table_.parts.push_back({100.0 + 90 * i, 150, .95, {}, .05});
  for (int n = 1; n <= 5; ++n) robot_.script[n].outcome = Outcome{OutcomeKind::refused, 0, 2, "nothing gripped"};
  open();
  const Snapshot fault = run();
  ASSERT_EQ(fault.mode, Mode::fault);
  EXPECT_NE(fault.reason.find("3 picks in a row"), std::string::npos);
  EXPECT_EQ(robot_.submitted.size(), 3u);
}

TEST_F(CellTest, APickThatNeverEndsHoldsTheArm) {
  table_.parts = {{200, 150, .95, {}, .05}};
  robot_.script[1].never_ends = true;
  open();
  const Snapshot fault = run();
  ASSERT_EQ(fault.mode, Mode::fault);
  EXPECT_EQ(fault.alarms.front().code, "PICK_TIMEOUT");
  EXPECT_EQ(robot_.holds, 1);
  press_reset();
  EXPECT_FALSE(wait_ready().robot.held) << "Reset takes back the cell's own hold";
}

TEST_F(CellTest, StopCycleFinishesThePickInFlight) {
  table_.parts = {{200, 150, .95, {}, .05}, {400, 150, .95, {}, .05}};
  open();
  wait_ready();
  cell_->on_change([cell = cell_.get()] {
    const auto now = cell->snapshot();
    if (now.counters.submitted == 1 && now.mode == Mode::running) {
      EXPECT_TRUE(cell->stop_cycle());
    }
  });
  ASSERT_TRUE(cell_->start());
  const Snapshot end = wait([](const Snapshot& s) { return s.mode == Mode::idle && !s.reason.empty(); });
  EXPECT_EQ(end.counters.placed, 1);
  EXPECT_EQ(end.counters.submitted, 1);
  EXPECT_NE(end.reason.find("operator"), std::string::npos);
}

TEST_F(CellTest, AFullTrayIsSaidAndStartBeginsAnEmptyOne) {
  settings_.planner.parts[0].place.cols = 2;
  for (int i = 0; i < 3; ++i) table_.parts.push_back({100.0 + 90 * i, 150, .95, {}, .05});
  open();
  const Snapshot full = run();
  EXPECT_EQ(full.mode, Mode::idle);
  EXPECT_NE(full.reason.find("tray of square is full"), std::string::npos);
  EXPECT_EQ(full.counters.placed, 2);
  const Snapshot end = run();
  EXPECT_EQ(end.counters.placed, 3);
}

TEST_F(CellTest, TheIndexedBeltIsMovedWhenNothingIsLeftToPick) {
  settings_.feed.kind = FeedKind::indexed;
  settings_.feed.empty_pitches_max = 2;
  int pitches = 0;
  robot_.next_parts = [&]() -> std::vector<Table::Lying> {
    ++pitches;
    if (pitches == 1) return {{200, 150, .95, {}, .05}};
    return {};
  };
  open();
  const Snapshot end = run();
  EXPECT_EQ(end.counters.placed, 1);
  EXPECT_EQ(pitches, 1 + 2);
  EXPECT_EQ(end.mode, Mode::idle);
}

TEST_F(CellTest, AFeedBrokenOffEarlierDoesNotStickForGood) {
  settings_.feed.kind = FeedKind::indexed;
  settings_.feed.empty_pitches_max = 1;
  robot_.advance_on = true;  // a hold came between the edge and its release
  int pitches = 0;
  robot_.next_parts = [&]() -> std::vector<Table::Lying> {
    ++pitches;
    return {};
  };
  open();
  EXPECT_EQ(run().mode, Mode::idle);
  EXPECT_EQ(pitches, 1);
  EXPECT_FALSE(robot_.advance_on);
}

TEST_F(CellTest, ABeltThatDoesNotMoveIsNoLongerAskedTo) {
  settings_.feed.kind = FeedKind::indexed;
  robot_.belt_stuck = true;
  open();
  EXPECT_EQ(run().reason_code, "FEED");
  EXPECT_FALSE(robot_.advance_on) << "a drive that looks at the level would run off later";
}

TEST_F(CellTest, AnotherToolSelectedByHandHindersACameraBesideTheArmNot) {
  table_.parts = {{200, 150, .95, {}, .05}};
  robot_.other_tool = true;
  open();
  EXPECT_EQ(run().counters.placed, 1);
}

TEST_F(CellTest, StopRightBehindStartIsNotLost) {
  table_.parts = {{200, 150, .95, {}, .05}};
  for (int i = 0; i < 6; ++i) {
    open();
    wait_ready();
    ASSERT_TRUE(cell_->start());
    ASSERT_TRUE(cell_->stop_cycle());
    // Long enough for a cell that has not heard the Stop to pick, and to look again.
    const core::TimePoint later = clock_.now() + std::chrono::seconds(15);
    wait([&](const Snapshot& s) { return s.mode == Mode::idle && clock_.now() > later; });
    cell_->close();
    EXPECT_LE(cell_->snapshot().counters.submitted, 1);
    cell_.reset();
  }
}

TEST_F(CellTest, RunsWithoutAPersonUntilSoManyPicksAreDealtWith) {
  settings_.start_at_once = true;
  settings_.stop_after_picks = 2;
  for (int i = 0; i < 4; ++i) table_.parts.push_back({100.0 + 90 * i, 150, .95, {}, .05});
  open().wait_until_done();
  cell_->close();
  EXPECT_EQ(cell_->snapshot().counters.placed, 2);
  EXPECT_EQ(cell_->ledger().cycle_s().size(), 2u);
}

}  // namespace
}  // namespace pickcell::cell
