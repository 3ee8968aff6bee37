/// The cell behind a GigE Vision camera does the same as behind the camera in its own process.

#include <sstream>

#include "fake_camera.hpp"
#include "pickcell/cli/cell_setup.hpp"
#include "pickcell/cli/start_demo.hpp"
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
