#pragma once
/// The demonstration cell in a folder of the test's own, steered like a person would steer it.

#include <gtest/gtest.h>

#include <algorithm>
#include <condition_variable>
#include <filesystem>
#include <functional>
#include <mutex>
#include <string>

#include "pickcell/cli/cell/setup.hpp"
#include "pickcell/cli/cell/start_demo.hpp"

namespace pickcell {

/// Taught parts and calibrations are made once per test program and copied.
inline std::filesystem::path prepared_demo() {
  static const std::filesystem::path folder = [] {
    const auto made = std::filesystem::path(::testing::TempDir()) / ("pickcell_demo_" + std::to_string(getpid()));
    cli::DemoOptions options;
    options.now_unix_us = core::SimulatedClock().unix_us();
    const auto file = cli::prepare_demo(made, options);
    if (!file) throw std::runtime_error(file.error().line());
    return made;
  }();
  return folder;
}

class DemoCell : public ::testing::Test {
 protected:
  void SetUp() override {
    std::string name = ::testing::UnitTest::GetInstance()->current_test_info()->name();
    std::replace(name.begin(), name.end(), '/', '_');
    folder_ = std::filesystem::path(::testing::TempDir()) / ("pickcell_" + name + "_" + std::to_string(getpid()));
    std::filesystem::remove_all(folder_);
    std::filesystem::copy(prepared_demo(), folder_, std::filesystem::copy_options::recursive);
  }
  void TearDown() override {
    if (setup_.cell) setup_.cell->close();
    setup_ = {};
    std::filesystem::remove_all(folder_);
  }

  /// Puts the cell together; it starts by itself when opened.
  void set_up(std::int64_t picks, std::uint64_t seed = 1, cli::RobotProtocol protocol = cli::RobotProtocol::tcp80) {
    auto file = cli::load_cell_file(folder_ / "CELL.toml");
    ASSERT_TRUE(file) << file.error().line();
    file->sim.seed = seed;
    file->sim.protocol = protocol;
    auto made = cli::set_up_cell(*file, {picks});
    ASSERT_TRUE(made) << made.error().line();
    setup_ = std::move(*made);
    {
      const std::lock_guard lock(mutex_);
      seen_ = {};
    }
    setup_.cell->on_change([this, cell = setup_.cell.get()] {
      const cell::Snapshot now = cell->snapshot();
      if (each_change) each_change(now);
      const std::lock_guard lock(mutex_);
      seen_ = now;
      changed_.notify_all();
    });
  }
  cell::Snapshot wait(const std::function<bool(const cell::Snapshot&)>& condition) {
    std::unique_lock lock(mutex_);
    EXPECT_TRUE(changed_.wait_for(lock, std::chrono::seconds(60), [&] { return condition(seen_); }))
        << name(seen_.mode) << ": " << seen_.step << " / " << seen_.reason;
    return seen_;
  }
  cell::Snapshot wait_fault() {
    return wait([](const cell::Snapshot& s) { return s.mode == cell::Mode::fault; });
  }
  cell::Snapshot wait_ready() {
    return wait([](const cell::Snapshot& s) { return s.mode == cell::Mode::idle && s.step == "ready"; });
  }
  cell::Snapshot wait_done() {
    return wait([](const cell::Snapshot& s) {
      return s.mode == cell::Mode::fault || (s.mode == cell::Mode::idle && s.reason.starts_with("all "));
    });
  }

  std::filesystem::path folder_;
  cli::CellSetup setup_;
  std::function<void(const cell::Snapshot&)> each_change;  ///< in the cell's thread, before the next step

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  cell::Snapshot seen_;
};

}  // namespace pickcell
