/// From a picture to a placed part: everything real but the light and the steel.

#include <cstdlib>
#include <sstream>

#include "demo_cell.hpp"
#include "pickcell/cell/database.hpp"
#include "pickcell/cli/cell/report.hpp"
#include "pickcell/cli/cell/run.hpp"
#include "pickcell/cli/subcommand.hpp"
#include "pickcell/core/file.hpp"
#include "pickcell/core/json.hpp"
#include "pickcell/core/statistics.hpp"
#include "pickcell/image/codec.hpp"
#include "pickcell/poses/calibration.hpp"
#include "pickcell/sim/board_picture.hpp"

namespace pickcell {
namespace {

/// pickcell ARGS...: exit code, the last line of stdout as JSON, stderr.
struct Said {
  int code = 0;
  core::Json report;
  std::string err;
};

Said pickcell(std::vector<std::string> args) {
  std::ostringstream out, err;
  Said said;
  said.code = cli::run(std::move(args), {out, err});
  said.err = err.str();
  if (auto parsed = core::parse_json(out.str(), "stdout")) said.report = std::move(*parsed);
  return said;
}

class WalkingCell : public DemoCell {
 protected:
  Said serve(int picks) {
    return pickcell({"serve", (folder_ / "CELL.toml").string(), "--picks", std::to_string(picks), "--json"});
  }
};

TEST_F(WalkingCell, PlacesPartsWithinAMillimetreAndADegree) {
  const Said said = serve(6);
  EXPECT_EQ(said.code, 0) << said.report.dump() << said.err;
  EXPECT_EQ(said.report["placed"].integer(), 6);
  EXPECT_EQ(said.report["missed"].integer(), 0);
  EXPECT_EQ(said.report["dropped"].integer(), 0);
  EXPECT_EQ(said.report["duplicates"].integer(), 0);
  EXPECT_LE(said.report["place_mm"]["worst"].number().value_or(99), 1.0);
  EXPECT_LE(said.report["place_deg"]["worst"].number().value_or(99), 1.0);
  EXPECT_GT(said.report["place_mm"]["worst"].number().value_or(0), 0.0)
      << "a perfect place would be the truth, not a measurement";
}

TEST_F(WalkingCell, IsTheSameEveryTimeForASeed) {
  const auto places = [&](std::uint64_t seed) {
    std::filesystem::remove_all(folder_ / "state");
    set_up(3, seed);
    setup_.cell->open();
    wait_done();
    setup_.cell->close();
    std::vector<Eigen::Vector3d> out;
    for (const auto& part : setup_.plant->world.placed()) {
      out.push_back(part.T_base_part.translation_m());
      out.push_back({core::seconds(part.picked), core::seconds(part.placed), 0});
    }
    setup_ = {};
    return out;
  };
  const auto first = places(7), again = places(7), other = places(8);
  ASSERT_EQ(first.size(), 6u);
  EXPECT_EQ(first, again);
  EXPECT_NE(first, other);
}

TEST_F(WalkingCell, APlaneTwoMillimetresOffFailsTheReport) {
  // As a person would: the last number of the first row of T_base_plane, in metres.
  auto text = core::read_text_file(folder_ / "plane.toml");
  ASSERT_TRUE(text);
  const std::size_t matrix = text->find("T_base_plane"), row_end = text->find(']', matrix),
                    number = text->rfind(' ', row_end) + 1;
  const double x_m = std::strtod(text->c_str() + number, nullptr);
  text->replace(number, row_end - number, std::to_string(x_m + 0.002));
  ASSERT_TRUE(core::write_file_atomically(folder_ / "plane.toml", *text));
  const Said said = serve(3);
  EXPECT_EQ(said.code, 1) << said.report.dump() << said.err;
  EXPECT_NEAR(said.report["place_mm"]["median"].number().value_or(0), 2.0, 0.5);
}

TEST_F(WalkingCell, RefusesACalibrationOfAnotherCamera) {
  auto camera = poses::load_camera(folder_ / "camera.toml");
  ASSERT_TRUE(camera);
  camera->rms_px = 0.4;
  ASSERT_TRUE(poses::save_camera(folder_ / "camera.toml", *camera));  // the plane was made with the old one
  const Said said = serve(1);
  EXPECT_EQ(said.code, 2) << said.err;
  EXPECT_TRUE(said.report.is_null());
  EXPECT_EQ(said.err.substr(0, 10), "pickcell: ") << said.err;
}

TEST_F(WalkingCell, RefusesARejectedCalibration) {
  auto plane = poses::load_plane(folder_ / "plane.toml");
  ASSERT_TRUE(plane);
  plane->verdict = poses::Verdict::reject;
  ASSERT_TRUE(poses::save_plane(folder_ / "plane.toml", *plane));
  EXPECT_EQ(serve(1).code, 2);
}

class HandEyeCell : public WalkingCell {
 protected:
  /// The cell's calibration given as a hand-eye one; the camera's place is that of the simulation.
  void calibrate(poses::HandeyeCalibration handeye) {
    handeye.camera = poses::load_camera(folder_ / "camera.toml")->checksum;
    handeye.plane_error_mm = handeye.spread_mm = 0.05;
    handeye.verdict = poses::Verdict::good;
    handeye.date = poses::load_plane(folder_ / "plane.toml")->date;
    ASSERT_TRUE(poses::save_handeye(folder_ / "handeye.toml", handeye));
    auto text = *core::read_text_file(folder_ / "CELL.toml");
    const std::string old = "plane = \"plane.toml\"";
    const double z_mm = 1e3 * poses::load_plane(folder_ / "plane.toml")->T_base_plane.translation_m().z();
    text.replace(text.find(old), old.size(), "handeye = \"handeye.toml\"\nplane_z_mm = " + std::to_string(z_mm));
    ASSERT_TRUE(core::write_file_atomically(folder_ / "CELL.toml", text));
    std::filesystem::remove_all(folder_ / "state");
  }
  /// Where the job looks from: a camera that rides on the arm sees from there what the fixed one sees.
  static core::Transform<core::Base, core::Flange> T_base_home() {
    return {Eigen::Vector3d(1, -1, -1).asDiagonal(), {0.3, 0, 0.25}};
  }
  void expect_good_picks() {
    const Said said = pickcell({"serve", (folder_ / "CELL.toml").string(), "--picks", "3", "--json", "--record"});
    EXPECT_EQ(said.code, 0) << said.report.dump() << said.err;
    EXPECT_EQ(said.report["placed"].integer(), 3);
    // The record holds what it takes to come to the same places again.
    const Said again = pickcell({"replay", said.report["run"].string(), "--tolerance", "1e-6,1e-6,1e-6", "--json"});
    EXPECT_EQ(again.code, 0) << again.report.dump() << again.err;
    EXPECT_GE(again.report["finds"]["same"].integer(), 3);
  }
};

TEST_F(HandEyeCell, PicksWithACameraBesideTheArm) {
  poses::HandeyeCalibration handeye;
  handeye.T_base_camera = poses::load_plane(folder_ / "plane.toml")->T_base_camera;
  calibrate(handeye);
  expect_good_picks();
}

TEST_F(HandEyeCell, PicksWithACameraOnTheArmByItsPoseAtExposure) {
  poses::HandeyeCalibration handeye;
  handeye.T_flange_camera = T_base_home().inverse() * poses::load_plane(folder_ / "plane.toml")->T_base_camera;
  calibrate(handeye);
  expect_good_picks();
  // A camera that is mounted elsewhere than calibrated is off by as much.
  handeye.T_flange_camera = core::Transform<core::Flange, core::Camera>(
      handeye.T_flange_camera->rotation(), handeye.T_flange_camera->translation_m() + Eigen::Vector3d(0.002, 0, 0));
  poses::HandeyeCalibration moved = *poses::load_handeye(folder_ / "handeye.toml");
  moved.T_flange_camera = handeye.T_flange_camera;
  ASSERT_TRUE(poses::save_handeye(folder_ / "handeye.toml", moved));
  std::filesystem::remove_all(folder_ / "state");
  const Said said = serve(2);
  EXPECT_EQ(said.code, 1);
  EXPECT_NEAR(said.report["place_mm"]["median"].number().value_or(0), 2.0, 0.5);
}

#ifdef PICKCELL_WITH_CALIBRATION

class VerifiedCell : public HandEyeCell {
 protected:
  /// A camera that shows nothing but the board in its reference place, moved by so much since the calibration.
  void look_at_board(double moved_m, const std::string& how) {
    const auto T_base_plane = sim::default_world(1).T_base_plane;
    const sim::CameraSettings camera = sim::default_camera(T_base_plane, 1);
    const Eigen::Matrix3d face_up = Eigen::Vector3d(1, -1, -1).asDiagonal();
    const core::Transform<core::Plane, core::Board> T_plane_board(face_up, {-0.12, 0.075, 0});
    auto plane = *poses::load_plane(folder_ / "plane.toml");
    plane.T_camera_board = camera.T_base_camera.inverse() * T_base_plane * T_plane_board;
    plane.board = "chessboard:9x6:30mm";
    ASSERT_TRUE(poses::save_plane(folder_ / "plane.toml", plane));
    const core::Transform<core::Camera, core::Camera> bump(Eigen::Matrix3d::Identity(), {moved_m, 0, 0});
    const image::Image picture =
        sim::board_picture(camera.intrinsics, {.spacing_m = 0.03}, bump * *plane.T_camera_board, {});
    std::filesystem::create_directories(folder_ / "shots");
    ASSERT_TRUE(image::save_png(folder_ / "shots/board.png", picture.view()));
    auto text = *core::read_text_file(folder_ / "CELL.toml");
    const auto put = [&](const std::string& old, const std::string& now) {
      text.replace(text.find(old), old.size(), now);
    };
    put("source = \"sim\"", "source = \"files:shots\"\nid = \"sim-camera\"\nloop = true");
    ASSERT_TRUE(core::write_file_atomically(folder_ / "CELL.toml", text));
    verify_at_start(how);
  }
  void verify_at_start(const std::string& how) {
    auto text = *core::read_text_file(folder_ / "CELL.toml");
    const std::string table = "[calibration]\n";
    text.replace(text.find(table), table.size(), table + "verify_at_start = \"" + how + "\"\n");
    ASSERT_TRUE(core::write_file_atomically(folder_ / "CELL.toml", text));
  }
  /// The same board and camera as a hand-eye calibration says it: the camera rides on the arm, which waits at home.
  void as_handeye() {
    const auto plane = *poses::load_plane(folder_ / "plane.toml");
    poses::HandeyeCalibration handeye;
    handeye.T_flange_camera = T_base_home().inverse() * plane.T_base_camera;
    handeye.T_base_board = plane.T_base_camera * *plane.T_camera_board;
    handeye.board = plane.board;
    calibrate(handeye);
  }
  cell::Snapshot stands_after_start() {
    set_up(0);
    setup_.cell->open();
    wait_ready();
    EXPECT_TRUE(setup_.cell->start());
    return wait([](const cell::Snapshot& s) { return !s.reason.empty(); });
  }
};

TEST_F(VerifiedCell, StandsUntilTheBoardIsTakenAway) {
  look_at_board(0, "board_is_taken_away");
  EXPECT_EQ(serve(1).code, 2) << "nobody is there to take it away";
  const auto stands = stands_after_start();
  EXPECT_EQ(stands.mode, cell::Mode::idle) << stands.reason;
  EXPECT_TRUE(stands.reason.starts_with("the camera is verified: the board is seen within 0.0")) << stands.reason;
  EXPECT_EQ(stands.remedy, "take the board away and press Start");
}

TEST_F(VerifiedCell, AsksForTheBoardThatIsNotThere) {
  auto plane = *poses::load_plane(folder_ / "plane.toml");
  plane.T_camera_board = core::Transform<core::Camera, core::Board>(Eigen::Matrix3d::Identity(), {-0.12, -0.075, 0.9});
  plane.board = "chessboard:9x6:30mm";
  ASSERT_TRUE(poses::save_plane(folder_ / "plane.toml", plane));
  verify_at_start("board_stays");  // the simulated camera sees the belt and its parts
  const auto stands = stands_after_start();
  EXPECT_EQ(stands.mode, cell::Mode::idle) << stands.reason;
  EXPECT_TRUE(stands.reason.starts_with("the camera cannot be verified: no whole chessboard")) << stands.reason;
  EXPECT_EQ(stands.remedy, "lay the board in its reference place and press Start again");
  EXPECT_EQ(stands.counters.submitted, 0);
}

TEST_F(VerifiedCell, WithACameraOnTheArmLooksForTheBoardWhereTheArmsPoseSaysItIs) {
  look_at_board(0, "board_is_taken_away");
  as_handeye();
  const auto stands = stands_after_start();
  EXPECT_TRUE(stands.reason.starts_with("the camera is verified: the board is seen within 0.0")) << stands.reason;
}

TEST_F(VerifiedCell, DoesNotPickWithACameraThatWasBumpedOnTheArm) {
  look_at_board(0.003, "board_stays");
  as_handeye();
  const auto stands = stands_after_start();
  EXPECT_EQ(stands.mode, cell::Mode::fault);
  EXPECT_NE(stands.reason.find("moved by"), std::string::npos) << stands.reason;
  EXPECT_EQ(stands.counters.submitted, 0);
}

TEST_F(VerifiedCell, DoesNotPickWithACameraThatWasBumped) {
  look_at_board(0.003, "board_stays");
  set_up(1);
  setup_.cell->open();
  const auto fault = wait_fault();
  EXPECT_NE(fault.reason.find("moved by"), std::string::npos) << fault.reason;
  EXPECT_EQ(fault.counters.submitted, 0);
}

#endif

TEST_F(WalkingCell, EveryPickIsInTheRunFolder) {
  set_up(2);
  setup_.cell->open();
  ASSERT_EQ(wait_done().counters.placed, 2);
  setup_.cell->close();
  auto log = cell::Database::open(setup_.cell->ledger().run_folder() / "picks.db");
  ASSERT_TRUE(log);
  const auto rows = log->execute(
      "SELECT p.outcome, d.base_x_mm, d.part, f.width_px FROM pick p JOIN detection d ON d.id = p.detection "
      "JOIN frame f ON f.sequence = d.frame ORDER BY p.sequence");
  ASSERT_TRUE(rows) << rows.error().line();
  ASSERT_EQ(rows->size(), 2u);
  for (const auto& row : *rows) {
    EXPECT_EQ(cell::as_text(row[0]), "done");
    EXPECT_GT(cell::as_real(row[1]), 250);
    EXPECT_EQ(cell::as_integer(row[3]), 1280);
  }
}

TEST_F(WalkingCell, WhatDoesNotExistYetIsRefused) {
  EXPECT_EQ(pickcell({"start", "--picks", "1", "--robot", "motoros"}).code, 2);
  EXPECT_EQ(pickcell({"start", "--picks", "1", "--camera", "tape"}).code, 2);
  EXPECT_EQ(pickcell({"start", "--pick", "1"}).code, 2);
  EXPECT_EQ(pickcell({"start", "--picks", "0"}).code, 2);
  EXPECT_EQ(pickcell({"serve", (folder_ / "missing.toml").string()}).code, 2);
  auto text = core::read_text_file(folder_ / "CELL.toml");
  ASSERT_TRUE(text);
  for (const std::string other : {"source = \"gige:cam\"", "source = \"tape\""}) {
    std::string changed = *text;
    changed.replace(changed.find("source = \"sim\""), 14, other);
    ASSERT_TRUE(core::write_file_atomically(folder_ / "CELL.toml", changed));
    EXPECT_EQ(serve(1).code, 2) << other;
  }
}

}  // namespace
}  // namespace pickcell
