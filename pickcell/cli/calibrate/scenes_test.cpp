// Calibrations against the truth of the simulator, whose projection is its own.

#include "pickcell/cli/calibrate/scenes.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <sstream>

#include "pickcell/cli/subcommand.hpp"
#include "pickcell/core/json.hpp"
#include "pickcell/image/codec.hpp"
#include "pickcell/poses/board_detect.hpp"
#include "pickcell/poses/camera_calibration.hpp"
#include "pickcell/poses/verify.hpp"

namespace pickcell::cli {
namespace {

namespace fs = std::filesystem;

const HandeyeScene& scene() {
  static const HandeyeScene made = handeye_scene(5, 12);
  return made;
}
const poses::HandeyeInput& rendered() {
  static const poses::HandeyeInput made = with_pictures(scene(), 5);
  return made;
}

TEST(BoardDetection, FindsRenderedCornersToATenthOfAPixel) {
  ASSERT_GE(rendered().views.size(), 10U);
  const auto points = poses::board_points_m(scene().board);
  double sum = 0;
  int n = 0;
  for (const auto& v : rendered().views) {
    const auto i = static_cast<std::size_t>(std::stoi(v.picture.image));
    for (std::size_t k = 0; k < points.size(); ++k) {
      const auto p = scene().T_camera_board(i) * core::Point<core::Board>{{points[k].x(), points[k].y(), 0}};
      sum += (v.picture.view.pixels[k] - sim::project(scene().camera, p.m)).squaredNorm();
      ++n;
    }
  }
  EXPECT_LT(std::sqrt(sum / n), 0.1);
}

class Kinds : public testing::TestWithParam<const char*> {};

TEST_P(Kinds, OfBoardsAreFoundInRenderedPicturesAndGiveTheHandEye) {
  const HandeyeScene made = handeye_scene(8, 9, GetParam());
  const poses::HandeyeInput input = with_pictures(made, 8);
  ASSERT_GE(input.views.size(), 8U);
  const auto points = poses::board_points_m(made.board);
  double sum = 0;
  int n = 0;
  for (const auto& v : input.views) {
    const auto i = static_cast<std::size_t>(std::stoi(v.picture.image));
    // Boards that look the same when turned have no first corner: the numbering that lies nearest is as good.
    double least = 1e300;
    for (const auto& turn : poses::board_symmetries(made.board)) {
      const poses::BoardView view = poses::renumbered(v.picture.view, turn);
      double off = 0;
      for (std::size_t k = 0; k < view.ids.size(); ++k) {
        const Eigen::Vector2d& b = points[static_cast<std::size_t>(view.ids[k])];
        const auto p = made.T_camera_board(i) * core::Point<core::Board>{{b.x(), b.y(), 0}};
        off += (view.pixels[k] - sim::project(made.camera, p.m)).squaredNorm();
      }
      least = std::min(least, off);
    }
    sum += least;
    n += static_cast<int>(v.picture.view.ids.size());
  }
  EXPECT_LT(std::sqrt(sum / n), 0.15);
  const auto fit = poses::calibrate_handeye(input);
  ASSERT_TRUE(fit) << fit.error().line();
  EXPECT_LE(fit->calibration.verdict, poses::Verdict::good) << fit->why;
  const auto error = error_of(fit->calibration.T_flange_camera->iso(), made.T_flange_camera.iso());
  EXPECT_LT(error.mm, 0.3);
  EXPECT_LT(error.deg, 0.02);
}

INSTANTIATE_TEST_SUITE_P(All, Kinds,
                         testing::Values("charuco:9x7:25mm:18mm:5X5_100", "circles:9x6:25mm", "acircles:4x11:15mm"));

TEST(BoardDetection, ABoardLargerThanStatedIsNamed) {
  const image::Image picture = sim::board_picture(scene().camera, scene().pattern, scene().T_camera_board(1), {});
  for (const char* smaller : {"chessboard:9x5:25mm", "chessboard:8x5:25mm"}) {
    const auto board = *poses::parse_board(smaller);
    const auto found = poses::detect_board(picture.view(), board, "a.png");
    ASSERT_FALSE(found) << smaller;
    EXPECT_EQ(found.error().code, core::ErrorCode::negative);
    const bool said = found.error().why.find("more ") != std::string::npos;
    if (!said) {
      EXPECT_NE(poses::what_else_is_seen(picture.view(), board).find("9x6"), std::string::npos);
    }
  }
}

TEST(BoardDetection, SaysThatABoardIsNotThere) {
  const image::Image picture(160, 120);
  const auto found = poses::detect_board(picture.view(), scene().board, "a.png");
  ASSERT_FALSE(found);
  EXPECT_EQ(found.error().code, core::ErrorCode::negative);
}

TEST(CameraCalibration, GivesTheLensOfTheSimulator) {
  std::vector<poses::NamedView> views;
  for (const auto& v : rendered().views) views.push_back(v.picture);
  views.push_back(views.front());
  const auto fit = poses::calibrate_camera(scene().board, views);
  ASSERT_TRUE(fit) << fit.error().line();
  const poses::Lens& lens = fit->calibration.lens;
  EXPECT_NEAR(lens.fx_px, scene().camera.fx_px, 4 * fit->sigma.fx_px + 0.3);
  EXPECT_NEAR(lens.cx_px, scene().camera.cx_px, 4 * fit->sigma.cx_px + 0.3);
  EXPECT_LT(fit->calibration.rms_px, 0.1);
  EXPECT_NE(fit->calibration.model, "none");
  ASSERT_EQ(fit->left_out.size(), 1U);
  EXPECT_NE(fit->left_out[0].reason.find("same view"), std::string::npos);
}

TEST(CameraCalibration, LeavesOutAViewThatDoesNotFit) {
  std::vector<poses::NamedView> views;
  for (const auto& v : rendered().views) views.push_back(v.picture);
  for (std::size_t k = 0; k < 9; ++k) views[2].view.pixels[k].x() += 3;  // one row of corners
  const auto fit = poses::calibrate_camera(scene().board, views);
  ASSERT_TRUE(fit);
  ASSERT_EQ(fit->left_out.size(), 1U);
  EXPECT_EQ(fit->left_out[0].image, views[2].image);
  EXPECT_LT(fit->calibration.rms_px, 0.1);
}

TEST(CameraCalibration, OfParallelViewsIsNoGoodAndSaysWhy) {
  std::vector<poses::NamedView> views;
  for (int i = 0; i < 6; ++i) {
    HandeyeScene flat = scene();
    poses::NamedView v{std::to_string(i), {}};
    v.view.width_px = 800;
    v.view.height_px = 600;
    const auto points = poses::board_points_m(scene().board);
    for (std::size_t k = 0; k < points.size(); ++k) {
      const Eigen::Vector3d p(points[k].x() - 0.15 + 0.02 * i, points[k].y() - 0.08 + 0.01 * (i % 3), 0.5);
      v.view.ids.push_back(static_cast<int>(k));
      v.view.pixels.push_back(
          sim::project(flat.camera, p) +
          0.05 * Eigen::Vector2d(std::sin(7.0 * static_cast<double>(k)), std::cos(3.0 * static_cast<double>(k))));
    }
    views.push_back(v);
  }
  const auto fit = poses::calibrate_camera(scene().board, views);
  if (!fit) return;  // refused altogether
  EXPECT_GE(fit->calibration.verdict, poses::Verdict::usable);
  ASSERT_FALSE(fit->advice.empty());
  EXPECT_NE(fit->advice.front().find("parallel to the sensor"), std::string::npos);
}

TEST(Handeye, OfRenderedPicturesIsGoodAndTrue) {
  const auto fit = poses::calibrate_handeye(rendered());
  ASSERT_TRUE(fit) << fit.error().line();
  EXPECT_LE(fit->calibration.verdict, poses::Verdict::good) << fit->why;
  const auto error = error_of(fit->calibration.T_flange_camera->iso(), scene().T_flange_camera.iso());
  EXPECT_LT(error.mm, 0.3);
  EXPECT_LT(error.deg, 0.02);
  EXPECT_EQ(fit->by_method.size(), 5U);
  EXPECT_FALSE(fit->own_lens);
}

TEST(Handeye, AGivenLensThatDoesNotFitIsReplacedByThePicturesOwnAndSaid) {
  poses::HandeyeInput input = rendered();
  input.lens.fx_px *= 1.02;
  input.lens.distortion = {};
  const auto fit = poses::calibrate_handeye(input);
  ASSERT_TRUE(fit);
  ASSERT_TRUE(fit->own_lens) << fit->why;
  EXPECT_NE(fit->why.find("the given one does not fit"), std::string::npos) << fit->why;
  EXPECT_LT(error_of(fit->calibration.T_flange_camera->iso(), scene().T_flange_camera.iso()).mm, 1.5);
  input.keep_lens = true;
  const auto kept = poses::calibrate_handeye(input);
  ASSERT_TRUE(kept);
  EXPECT_FALSE(kept->own_lens);
  EXPECT_NE(kept->why.find("does not fit"), std::string::npos) << kept->why;
}

TEST(Handeye, BesideTheArmIsTheSameProblem) {
  // The same numbers with the arm's poses inverted: a camera that stands still and a board on the arm.
  poses::HandeyeInput input = with_noisy_corners(scene(), 0.1, 3);
  input.mounting = poses::Mounting::eye_to_hand;
  for (auto& v : input.views) {
    const Eigen::Isometry3d T = v.arm.pose().inverse(Eigen::Isometry);
    v.arm.euler = false;
    v.arm.quaternion = Eigen::Quaterniond(T.linear());
    v.arm.position_m = T.translation();
  }
  const auto fit = poses::calibrate_handeye(input);
  ASSERT_TRUE(fit);
  ASSERT_TRUE(fit->calibration.T_base_camera);
  EXPECT_LT(error_of(fit->calibration.T_base_camera->iso(), scene().T_flange_camera.iso()).mm, 0.3);
}

class Faults : public testing::TestWithParam<std::size_t> {};

TEST_P(Faults, AreNeverGoodAndAreNamed) {
  const PoseFault fault = pose_faults()[GetParam()];
  poses::HandeyeInput input = with_noisy_corners(scene(), 0.05, 11);
  fault.apply(input, 11);
  const auto fit = poses::calibrate_handeye(input);
  const std::string why = fit ? fit->why : fit.error().line();
  if (fit) {
    EXPECT_GE(fit->calibration.verdict, poses::Verdict::usable) << why;
  }
  bool named = false;
  for (const std::string& word : fault.words) named = named || why.find(word) != std::string::npos;
  EXPECT_TRUE(named) << fault.name << ": " << why;
}

INSTANTIATE_TEST_SUITE_P(All, Faults, testing::Range<std::size_t>(0, pose_faults().size()));

TEST(Plane, FromNoisyCornersHoldsToATenthOfAMillimetre) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) EXPECT_LT(plane_error(0.1, seed).worst_mm, 0.1) << seed;
}

poses::PlaneFit touched_plane(double touch_scale = 1) {
  const image::Image picture = sim::board_picture(scene().camera, scene().pattern, scene().T_camera_board(1), {});
  const auto view = poses::detect_board(picture.view(), scene().board, "board.png");
  std::vector<poses::TouchedCorner> touched;
  for (const auto& [col, row] : {std::pair{0, 0}, {8, 0}, {8, 5}, {0, 5}, {4, 2}})
    touched.push_back(
        {col, row, (scene().T_base_board * core::Point<core::Board>{{0.025 * col, 0.025 * row, 0}}).m * touch_scale});
  auto fit = poses::plane_from_touched_board(lens_of(scene().camera), scene().board, *view, touched, 0);
  EXPECT_TRUE(fit);
  return *fit;
}

TEST(Plane, FromATouchedBoardKnowsTheCamera) {
  const poses::PlaneFit fit = touched_plane();
  EXPECT_LE(fit.calibration.verdict, poses::Verdict::good) << fit.why;
  const auto truth = scene().T_base_flange[1] * scene().T_flange_camera;
  EXPECT_LT(error_of(fit.calibration.T_base_camera.iso(), truth.iso()).mm, 0.5);
  EXPECT_GT(fit.calibration.T_base_plane.rotation()(2, 2), 0.999);
}

TEST(Plane, InMetresIsNamed) {
  const poses::PlaneFit fit = touched_plane(1e-3);
  EXPECT_EQ(fit.calibration.verdict, poses::Verdict::reject);
  EXPECT_NE(fit.why.find("metres were given as millimetres"), std::string::npos) << fit.why;
}

TEST(Verify, SaysWhetherTheCameraWasBumped) {
  const poses::PlaneFit fit = touched_plane();
  const auto look = [&](const Eigen::Vector3d& bump_m) {
    const core::Transform<core::Camera, core::Camera> bump(Eigen::Matrix3d::Identity(), bump_m);
    const image::Image picture =
        sim::board_picture(scene().camera, scene().pattern, bump * scene().T_camera_board(1), {.seed = 9});
    const auto view = poses::detect_board(picture.view(), scene().board, "now.png");
    return *poses::verify(lens_of(scene().camera), fit.calibration, scene().board, *view);
  };
  const auto still = look(Eigen::Vector3d::Zero());
  EXPECT_EQ(still.verdict, poses::Drift::ok) << still.why;
  EXPECT_LT(still.drift_mm, 0.1);
  const auto bumped = look({0.002, 0, 0});
  EXPECT_EQ(bumped.verdict, poses::Drift::drifted);
  EXPECT_NEAR(bumped.drift_mm, 2, 0.5);  // the plane is inclined against the bump
}

struct Ran {
  int code = 0;
  std::string out, err;
};

Ran pickcell(const std::vector<std::string>& args) {
  std::ostringstream out, err;
  const int code = cli::run(args, {out, err});
  return {code, out.str(), err.str()};
}

TEST(CalibrateCommand, EndsWithOneLineForBadInput) {
  const fs::path folder = fs::path(testing::TempDir()) / "calibrate_bad";
  fs::create_directories(folder);
  const std::string out = (folder / "camera.toml").string();
  const auto missing = pickcell({"calibrate", "camera", "no.png", "--board", "chessboard:9x6:25mm", "-o", out});
  EXPECT_EQ(missing.code, 2);
  EXPECT_EQ(std::count(missing.err.begin(), missing.err.end(), '\n'), 1) << missing.err;
  EXPECT_EQ(pickcell({"calibrate", "camera", "no.png", "--board", "chessboard:9x6:25", "-o", out}).code, 2);
  EXPECT_EQ(pickcell({"calibrate"}).code, 2);
  std::vector<std::string> args{"calibrate", "camera", "--board", "chessboard:9x6:25mm", "-o", out, "--json"};
  for (int i = 0; i < 3; ++i) {
    image::Image grey(320, 240);
    grey.fill(static_cast<std::uint8_t>(100 + i));
    args.push_back((folder / (std::to_string(i) + ".png")).string());
    ASSERT_TRUE(image::save_png(args.back(), grey.view()));
  }
  const auto none = pickcell(args);
  EXPECT_EQ(none.code, 1);
  EXPECT_EQ((*core::parse_json(none.out, "out"))["verdict"].string(), "reject");
  fs::remove_all(folder);
}

}  // namespace
}  // namespace pickcell::cli
