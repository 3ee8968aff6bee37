#pragma once
/// A cell at the scripted table.

#include <gtest/gtest.h>

#include <filesystem>

#include "pickcell/cell/scripted_table_test.hpp"

namespace pickcell::cell::scripted {

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

}  // namespace pickcell::cell::scripted
