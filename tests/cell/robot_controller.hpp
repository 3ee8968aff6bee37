#pragma once
/// The arm's driver against the simulated controller, over real sockets, with the real job and a real journal.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "pickcell/cell/journal.hpp"
#include "pickcell/robot/hses_client.hpp"
#include "pickcell/robot/job_robot.hpp"
#include "pickcell/robot/tcp80_client.hpp"
#include "pickcell/sim/controller.hpp"
#include "pickcell/sim/shipped_jobs.hpp"

namespace pickcell {
namespace robot_controller {

using namespace std::chrono_literals;
using robot::CommandState;
using robot::Outcome;
using robot::OutcomeKind;
using ::testing::HasSubstr;

/// A gripper that always grips, unless told otherwise; counts what it did and where.
class GripperPlant final : public sim::Plant {
 public:
  struct Act {
    bool closed;
    Eigen::Vector3d at_mm;
  };
  void output_changed(int n, bool on, const core::Transform<core::Base, core::Tool>& T_base_tool,
                      core::TimePoint) override {
    if (n != sim::kGripperOutput) return;
    const std::lock_guard lock(mutex_);
    if (on || holds_) acts_.push_back({on, T_base_tool.translation_m() * 1e3});
    holds_ = on && !empty_;
  }
  bool input(int n, core::TimePoint) override {
    const std::lock_guard lock(mutex_);
    return n == sim::kGripSensorInput && holds_;
  }
  void contact_written(int contact, bool on, core::TimePoint) override {
    const std::lock_guard lock(mutex_);
    contacts_[contact] = on;
  }
  std::vector<Act> acts() {
    const std::lock_guard lock(mutex_);
    return acts_;
  }
  bool contact(int number) {
    const std::lock_guard lock(mutex_);
    return contacts_[number];
  }
  void put_into_gripper(bool part) {
    const std::lock_guard lock(mutex_);
    holds_ = part;
  }
  /// From now on there is nothing to grip.
  void take_parts_away() {
    const std::lock_guard lock(mutex_);
    empty_ = true;
  }

 private:
  std::mutex mutex_;
  std::vector<Act> acts_;
  std::map<int, bool> contacts_;
  bool holds_ = false, empty_ = false;
};

enum class Protocol { tcp80, hses };

/// Every test over both protocols: what a robot does must not depend on the wire.
class RobotAndController : public ::testing::TestWithParam<Protocol> {
 protected:
  void SetUp() override {
    std::string name = ::testing::UnitTest::GetInstance()->current_test_info()->name();
    std::replace(name.begin(), name.end(), '/', '_');
    folder_ = std::filesystem::path(::testing::TempDir()) / ("pickcell_robot_" + name);
    std::filesystem::remove_all(folder_);
    sim::ControllerSettings settings;
    settings.jobs = sim::shipped_jobs();
    auto on = sim::Controller::switch_on(settings, clock_, &plant_);
    ASSERT_TRUE(on) << on.error().line();
    controller_ = std::move(*on);
    boot();
  }
  void TearDown() override {
    controller_.reset();
    std::filesystem::remove_all(folder_);
  }

  /// A new PC process: nothing survives but the journal's file.
  void boot() {
    robot_.reset();
    journal_.reset();
    auto journal = cell::SqliteJournal::open(folder_ / "journal.db");
    ASSERT_TRUE(journal) << journal.error().line();
    journal_ = std::move(*journal);
    robot::JobRobotSettings settings;
    settings.limits.box_min_mm = {150, -500, -300};
    settings.limits.box_max_mm = {700, 500, 400};
    robot_ = std::make_unique<robot::JobRobot>(settings, link(), *journal_, clock_);
  }
  std::unique_ptr<robot::ControllerLink> link() {
    if (GetParam() == Protocol::hses) {
      robot::HsesSettings settings;
      settings.host = "127.0.0.1";
      settings.port = controller_->hses_port();
      settings.timeout = answer_timeout_ / settings.tries;
      return std::make_unique<robot::HsesClient>(settings);
    }
    robot::Tcp80Settings settings;
    settings.host = "127.0.0.1";
    settings.port = controller_->tcp80_port();
    settings.line_timeout = settings.result_timeout = answer_timeout_;
    return std::make_unique<robot::Tcp80Client>(settings);
  }

  static core::Transform<core::Base, core::Tool> above(double x_mm, double y_mm, double z_mm, double angle_rad) {
    Eigen::Matrix3d down;
    down << 1, 0, 0, 0, -1, 0, 0, 0, -1;
    return {core::rotation_z(angle_rad) * down, Eigen::Vector3d(x_mm, y_mm, z_mm) * 1e-3};
  }
  picks::Pick pick(int n) {
    picks::Pick p;
    p.detection_id = static_cast<std::uint64_t>(n) + 1000;
    p.place_slot = n;
    p.model = "bracket";
    p.T_base_grasp = above(400 + n, -100, -50, 0.3);  // which grip was which is seen from where it was
    p.T_base_place = above(450, 150 + n % 10, -60, -0.2);
    return p;
  }
  core::Status ready() {
    if (auto connected = robot_->connect(*seat_); !connected) return connected;
    return robot_->start(*seat_);
  }
  /// Waits, in simulated time, for the outcome of the submitted pick.
  core::Result<Outcome> wait() {
    for (int i = 0; i < 1200; ++i) {
      auto outcome = robot_->outcome();
      if (!outcome) return core::forward(outcome);
      if (*outcome) return **outcome;
      seat_->sleep_for(50ms);
    }
    return core::failure(core::ErrorCode::timeout, "test", "no outcome in a minute");
  }
  /// Sleeps until the gripper has acted n times.
  void until_acts(std::size_t n) {
    for (int i = 0; i < 3000 && plant_.acts().size() < n; ++i) seat_->sleep_for(10ms);
    ASSERT_EQ(plant_.acts().size(), n);
  }
  std::vector<robot::JournalRow> rows() { return journal_->newest_rows(10000).value(); }

  std::filesystem::path folder_;
  std::chrono::milliseconds answer_timeout_{10000};  // wall time, for a busy machine
  core::SimulatedClock clock_;
  std::unique_ptr<core::Seat> seat_ = clock_.join("pc");
  GripperPlant plant_;
  std::unique_ptr<sim::Controller> controller_;
  std::unique_ptr<cell::SqliteJournal> journal_;
  std::unique_ptr<robot::JobRobot> robot_;
};

#define PICKCELL_OVER_BOTH_PROTOCOLS(Suite)                                                 \
  INSTANTIATE_TEST_SUITE_P(Over, Suite, ::testing::Values(Protocol::tcp80, Protocol::hses), \
                           [](const auto& tested) { return tested.param == Protocol::hses ? "hses" : "tcp80"; })

}  // namespace robot_controller
}  // namespace pickcell
