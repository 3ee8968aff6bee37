#include "pickcell/cli/experiment/latency_robot.hpp"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdio>
#include <string>
#include <thread>
#include <utility>

#include "pickcell/cell/journal.hpp"
#include "pickcell/core/file.hpp"
#include "pickcell/robot/job_robot.hpp"
#include "pickcell/robot/vispick_job.hpp"
#include "pickcell/sim/controller.hpp"
#include "pickcell/sim/plant.hpp"

namespace pickcell::cli {

using core::ErrorCode;
using core::failure;

namespace {

using WallClock = std::chrono::steady_clock;

/// Always grips.
class Gripper final : public sim::Plant {
 public:
  void output_changed(int n, bool on, const core::Transform<core::Base, core::Tool>&, core::TimePoint) override {
    if (n == sim::kGripperOutput) closed_ = on;
  }
  bool input(int n, core::TimePoint) override { return n == sim::kGripSensorInput && closed_; }
  void contact_written(int, bool, core::TimePoint) override {}

 private:
  std::atomic<bool> closed_ = false;
};

/// VISPICK as fast as it can be: what is measured ends when the arm begins to move.
std::string quick_job() {
  robot::VispickSettings settings;
  settings.home_pct = settings.travel_pct = 100;
  settings.travel_mm_s = settings.final_mm_s = 1500;
  return robot::vispick_job(settings);
}

double ms_since(WallClock::time_point start) {
  return std::chrono::duration<double, std::milli>(WallClock::now() - start).count();
}

core::Transform<core::Base, core::Tool> above(double x_mm, double y_mm, double z_mm) {
  Eigen::Matrix3d down;
  down << 1, 0, 0, 0, -1, 0, 0, 0, -1;
  return {down, Eigen::Vector3d(x_mm, y_mm, z_mm) * 1e-3};
}

picks::Pick short_pick(int n) {
  picks::Pick p;
  p.detection_id = static_cast<std::uint64_t>(n) + 1;
  p.place_slot = n;
  p.model = "latency";
  p.T_base_grasp = above(330, 20, 120);
  p.T_base_place = above(330, -20, 120);
  return p;
}

/// One pick to its end; its two times are noted unless `latency` is null.
core::Status pick(robot::JobRobot& robot, const sim::Controller& controller, core::Seat& seat, int n,
                  RobotLatency* latency) {
  constexpr auto kLongest = std::chrono::seconds(60);
  const Eigen::Vector3d before = controller.T_base_tool().translation_m();
  const auto start = WallClock::now();
  auto submitted = robot.submit(short_pick(n));
  if (!submitted) return core::forward(submitted);
  const double submit_ms = ms_since(start);
  while ((controller.T_base_tool().translation_m() - before).norm() < 1e-6) {
    if (WallClock::now() - start > kLongest)
      return failure(ErrorCode::timeout, "latency", "the arm does not move", "run it again on a quieter machine");
    std::this_thread::sleep_for(std::chrono::microseconds(200));
  }
  const double motion_ms = ms_since(start);
  for (;;) {
    auto outcome = robot.outcome();
    if (!outcome) return core::forward(outcome);
    if (*outcome && (*outcome)->kind != robot::OutcomeKind::done)
      return failure(ErrorCode::refused, "latency", (*outcome)->text);
    if (*outcome) break;
    seat.sleep_for(std::chrono::milliseconds(20));
  }
  for (auto state = robot.state(); state && !state->clear_of_camera; state = robot.state())
    seat.sleep_for(std::chrono::milliseconds(20));  // home again: the next one begins at rest
  if (latency) {
    latency->submit_ms.push_back(submit_ms);
    latency->to_motion_ms.push_back(motion_ms);
  }
  return {};
}

}  // namespace

double latency_at(const std::vector<double>& sorted, double share) {
  if (sorted.empty()) return 0;
  const double place = share * static_cast<double>(sorted.size() - 1);
  return sorted[static_cast<std::size_t>(place + 0.5)];
}

core::Result<RobotLatency> measure_robot_latency(RobotProtocol protocol, int picks,
                                                 const std::filesystem::path& folder) {
  core::RealClock clock;
  Gripper gripper;
  sim::ControllerSettings settings;
  settings.jobs = {quick_job()};
  auto controller = sim::Controller::switch_on(settings, clock, &gripper);
  if (!controller) return core::forward(controller);
  const bool hses = protocol == RobotProtocol::hses;
  auto link = open_controller_link(
      {protocol, "127.0.0.1", hses ? (*controller)->hses_port() : (*controller)->tcp80_port()}, "latency");
  if (!link) return core::forward(link);
  const auto journal_file = folder / ("latency-" + std::string(hses ? "hses" : "tcp80") + ".db");
  std::filesystem::remove(journal_file);
  auto journal = cell::SqliteJournal::open(journal_file);
  if (!journal) return core::forward(journal);
  robot::JobRobotSettings robot_settings;
  robot_settings.limits.box_min_mm = {150, -500, -300};
  robot_settings.limits.box_max_mm = {700, 500, 400};
  robot::JobRobot robot(robot_settings, std::move(*link), **journal, clock);
  const auto seat = clock.join("latency");
  if (auto connected = robot.connect(*seat); !connected) return core::forward(connected);
  if (auto started = robot.start(*seat); !started) return core::forward(started);
  RobotLatency out;
  out.protocol = protocol;
  for (int n = 0; n <= picks; ++n)
    if (auto done = pick(robot, **controller, *seat, n, n == 0 ? nullptr : &out); !done) return core::forward(done);
  std::sort(out.submit_ms.begin(), out.submit_ms.end());
  std::sort(out.to_motion_ms.begin(), out.to_motion_ms.end());
  return out;
}

core::Result<core::Json> measure_robot_latencies(const ExperimentOptions& options) {
  constexpr int kPicks = 50;
  core::Json out = core::Json::object();
  std::string csv = "protocol,submit_ms,to_motion_ms\n";
  for (const auto& [protocol, name] : {std::pair{RobotProtocol::tcp80, "tcp80"}, {RobotProtocol::hses, "hses"}}) {
    auto measured = measure_robot_latency(protocol, options.n.value_or(kPicks), options.out);
    if (!measured) return core::forward(measured);
    const auto& [_, submit, motion] = *measured;
    out.set(name, core::Json::object()
                      .set("picks", motion.size())
                      .set("submit_median_ms", latency_at(submit, 0.5))
                      .set("submit_p99_ms", latency_at(submit, 0.99))
                      .set("median_ms", latency_at(motion, 0.5))
                      .set("p99_ms", latency_at(motion, 0.99))
                      .set("worst_ms", latency_at(motion, 1)));
    for (std::size_t i = 0; i < motion.size(); ++i) {
      char line[64];
      std::snprintf(line, sizeof line, "%s,%.3f,%.3f\n", name, submit[i], motion[i]);
      csv += line;
    }
  }
  if (auto written = core::write_file_atomically(options.out / "latency_robot.csv", csv); !written)
    return core::forward(written);
  return out;
}

std::string robot_latency_words(const core::Json& latencies) {
  std::string out;
  for (const char* name : {"tcp80", "hses"}) {
    const core::Json& of = latencies[name];
    const auto number = [&](const char* key) { return of[key].number().value_or(0); };
    char line[200];
    std::snprintf(line, sizeof line,
                  "robot over %s, submission to motion: median %.1f ms, p99 %.1f ms, worst %.1f ms over %.0f picks; "
                  "submitted after median %.1f ms, p99 %.1f ms\n",
                  name, number("median_ms"), number("p99_ms"), number("worst_ms"), number("picks"),
                  number("submit_median_ms"), number("submit_p99_ms"));
    out += line;
  }
  return out;
}

}  // namespace pickcell::cli
