/// The cell's behaviour with an arm and a camera that do exactly what a test says, on a simulated clock. The same cell
/// against the simulated world and controller: tests/cell.
#include "pickcell/cell/scripted_cell_test.hpp"

namespace pickcell::cell {
namespace {

using namespace scripted;

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
