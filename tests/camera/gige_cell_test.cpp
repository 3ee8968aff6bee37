/// The cell behind a GigE Vision camera does the same as behind the camera in its own process.

#include <cstdio>
#include <functional>
#include <sstream>

#include "fake_camera.hpp"
#include "pickcell/cli/cell/setup.hpp"
#include "pickcell/cli/cell/start_demo.hpp"
#include "pickcell/cli/subcommand.hpp"
#include "pickcell/core/json.hpp"
#include "pickcell/sim/gige_camera.hpp"

namespace pickcell {
namespace {

class GigeCell : public ::testing::Test {
 protected:
  void SetUp() override {
    wait_for_turn();
    if (frames::GvcpProbe(kLoopback).identify(std::chrono::milliseconds(100)))
      GTEST_SKIP() << "another GigE Vision camera is served on this machine's loopback";
    folder_ = std::filesystem::path(::testing::TempDir()) / ("pickcell_gige_" + std::to_string(getpid()));
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  std::vector<Eigen::Vector3d> placed(bool over_gige) {
    std::filesystem::remove_all(folder_);
    cli::DemoOptions demo;
    demo.seed = 5;
    demo.now_unix_us = core::SimulatedClock().unix_us();
    auto path = cli::prepare_demo(folder_, demo);
    EXPECT_TRUE(path);
    auto file = cli::load_cell_file(*path);
    EXPECT_TRUE(file);
    file->sim.camera_over_gige = over_gige;
    auto setup = cli::set_up_cell(*file, {4});
    EXPECT_TRUE(setup) << setup.error().line();
    if (!setup) return {};
    setup->cell->open();
    setup->cell->wait_until_done();
    setup->cell->close();
    std::vector<Eigen::Vector3d> out;
    for (const auto& part : setup->plant->world.placed()) {
      out.push_back(part.T_base_part.translation_m());
      out.push_back({core::seconds(part.picked), core::seconds(part.placed), 0});
    }
    return out;
  }

  std::filesystem::path folder_;
};

TEST_F(GigeCell, PlacesTheSamePartsAtTheSamePlacesAtTheSameTimes) {
  const auto in_process = placed(false), over_gige = placed(true);
  EXPECT_EQ(in_process.size(), 8u);
  EXPECT_EQ(in_process, over_gige);
}

/// The simulated camera on the network, switched on and off at will, and a cell that knows it as a device only.
class GigeCellLoss : public GigeCell {
 protected:
  void SetUp() override {
    GigeCell::SetUp();
    if (IsSkipped()) return;
    cli::DemoOptions demo;
    demo.now_unix_us = clock_.unix_us();
    demo.camera_width_px = 640;
    demo.camera_height_px = 512;
    auto path = cli::prepare_demo(folder_, demo);
    ASSERT_TRUE(path);
    auto file = cli::load_cell_file(*path);
    ASSERT_TRUE(file);
    file->cell.camera.source = "aravis:127.0.0.1";
    file->cell.camera.id = camera_.info().camera_id;
    // Dark pictures: nothing to pick, so that the cell does little but look.
    file->cell.camera.settings = *frames::parse_camera_settings({"trigger=software", "exposure_us=20"});
    switch_on();
    auto setup = cli::set_up_cell(*file, {});
    ASSERT_TRUE(setup) << setup.error().line();
    setup_ = std::move(*setup);
    setup_.cell->open();
    wait("connected to the robot", [](const cell::Snapshot& s) { return s.step == "ready"; });
  }
  void switch_on() {
    auto served = sim::GigeCamera::switch_on({}, camera_, clock_);
    ASSERT_TRUE(served) << served.error().line();
    served_ = std::move(*served);
  }
  cell::Snapshot wait(const char* what, const std::function<bool(const cell::Snapshot&)>& condition) {
    const auto begin = std::chrono::steady_clock::now();
    const auto seat = clock_.join("test");
    cell::Snapshot now = setup_.cell->snapshot();
    for (int i = 0; i < 6000 && !condition(now); ++i) {
      seat->sleep_for(std::chrono::milliseconds(5));
      now = setup_.cell->snapshot();
    }
    EXPECT_TRUE(condition(now)) << what << ": " << now.step << " / " << now.reason << " / " << now.camera.why;
    std::printf("%s after %.0f ms\n", what,
                std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin).count());
    return now;
  }
  static const cell::CellAlarm* alarm(const cell::Snapshot& s) {
    for (const cell::CellAlarm& a : s.alarms)
      if (a.code == "CAMERA_LOST") return &a;
    return nullptr;
  }

  core::RealClock clock_;
  sim::World world_{sim::default_world(1)};
  sim::SimulatedCamera camera_{sim::resized(sim::default_camera(world_.settings().T_base_plane, 1), 640, 512), world_,
                               clock_};
  std::unique_ptr<sim::GigeCamera> served_;
  cli::CellSetup setup_;
};

TEST_F(GigeCellLoss, IsSeenShownAndHealedWhileTheCellStandsIdle) {
  EXPECT_TRUE(setup_.cell->snapshot().camera.connected);
  served_.reset();
  const auto lost = wait("idle: loss shown", [](const cell::Snapshot& s) { return !s.camera.connected; });
  EXPECT_FALSE(lost.camera.why.empty());
  EXPECT_FALSE(lost.camera.remedy.empty());
  ASSERT_TRUE(alarm(lost));
  EXPECT_TRUE(alarm(lost)->active);
  EXPECT_FALSE(alarm(lost)->remedies.empty());
  const auto refused = setup_.cell->start();
  ASSERT_FALSE(refused);
  EXPECT_NE(refused.error().line().find(lost.camera.remedy), std::string::npos) << refused.error().line();
  switch_on();
  const auto back = wait("idle: healed", [](const cell::Snapshot& s) { return s.camera.connected; });
  EXPECT_EQ(back.mode, cell::Mode::idle);
  EXPECT_FALSE(alarm(back)->active);
  EXPECT_GE(back.camera.reconnects, 1);
}

TEST_F(GigeCellLoss, IsWaitedOutWhileTheCellRuns) {
  ASSERT_TRUE(setup_.cell->start());
  const auto running = wait("first picture", [](const cell::Snapshot& s) { return s.counters.frames > 0; });
  served_.reset();
  const auto lost =
      wait("running: waits for the camera", [](const cell::Snapshot& s) { return s.step == "waiting for the camera"; });
  EXPECT_FALSE(lost.camera.connected);
  ASSERT_TRUE(alarm(lost));
  EXPECT_EQ(lost.mode, cell::Mode::running);
  switch_on();
  const auto back = wait("running: next picture", [&](const cell::Snapshot& s) {
    return s.camera.connected && s.counters.frames > running.counters.frames;
  });
  EXPECT_NE(back.mode, cell::Mode::fault) << back.reason;
  EXPECT_FALSE(alarm(back)->active);
}

TEST_F(GigeCell, TheCommandSeesStreamsAndSnapsTheSimulatedCamera) {
  core::RealClock clock;
  sim::World world(sim::default_world(1));
  sim::SimulatedCamera camera(sim::default_camera(world.settings().T_base_plane, 1), world, clock);
  auto served = sim::GigeCamera::switch_on({}, camera, clock);
  ASSERT_TRUE(served) << served.error().line();
  const auto second = sim::GigeCamera::switch_on({}, camera, clock);
  ASSERT_FALSE(second) << "the port is taken";
  EXPECT_EQ(second.error().code, core::ErrorCode::device);

  const auto pickcell = [](std::vector<std::string> args) {
    std::ostringstream out, err;
    const int code = cli::run(std::move(args), {out, err});
    auto parsed = core::parse_json(out.str(), "stdout");
    EXPECT_EQ(code, 0) << err.str();
    return parsed ? *parsed : core::Json();
  };
  EXPECT_EQ(pickcell({"camera", "list", "--json"})["source"].string(), "aravis:Aravis-Fake-SIM01");
  const std::string file = (std::filesystem::path(::testing::TempDir()) / "gige_snap.png").string();
  const auto snap = pickcell({"camera", "snap", "aravis:SIM01", "-o", file, "--json", "--set", "trigger=software"});
  EXPECT_EQ(snap["width_px"].integer(), 1280);
  EXPECT_TRUE(std::filesystem::exists(file));
  std::filesystem::remove(file);
  const auto stream =
      pickcell({"camera", "stream", "aravis:SIM01", "--frames", "3", "--json", "--set", "roi_px=0,0,320,240"});
  for (const char* key : {"frames", "incomplete", "missing", "repeated", "late", "resends", "rate_hz", "jitter_us"})
    EXPECT_TRUE(stream.has(key)) << key;
  EXPECT_GE(stream["frames"].integer().value_or(0), 3);
}

}  // namespace
}  // namespace pickcell
