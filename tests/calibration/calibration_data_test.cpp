// The commands on real pictures (label data): PICKCELL_DATA or ../shared/data.

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "pickcell/cli/subcommand.hpp"
#include "pickcell/core/json.hpp"

namespace pickcell {
namespace {

namespace fs = std::filesystem;

class CalibrationData : public testing::Test {
 protected:
  void SetUp() override {
    const char* given = std::getenv("PICKCELL_DATA");
    data_ = fs::path(given ? given : PICKCELL_SOURCE_DIR "/../shared/data") / "calibration";
    if (!fs::is_directory(data_)) GTEST_SKIP() << data_ << " is missing";
    folder_ = fs::path(testing::TempDir()) / testing::UnitTest::GetInstance()->current_test_info()->name();
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }

  core::Json pickcell(std::vector<std::string> args, const std::string& out) {
    args.insert(args.end(), {"-o", (folder_ / out).string(), "--report", (folder_ / "report.html").string(), "--json"});
    std::ostringstream text, err;
    code_ = cli::run(std::move(args), {text, err});
    const auto json = core::parse_json(text.str(), "output");
    EXPECT_TRUE(json) << err.str();
    return json ? *json : core::Json();
  }
  std::vector<std::string> pictures(const std::string& folder) const {
    std::vector<std::string> out;
    for (const auto& entry : fs::directory_iterator(data_ / folder))
      if (entry.path().extension() != ".yml") out.push_back(entry.path().string());
    std::sort(out.begin(), out.end());
    return out;
  }
  /// The lens that a set came with.
  void write_lens(int width, int height, double fx, double fy, double cx, double cy) {
    std::ofstream(folder_ / "camera.toml")
        << "model = \"none\"\nwidth_px = " << width << "\nheight_px = " << height << "\nfx_px = " << fx
        << "\nfy_px = " << fy << "\ncx_px = " << cx << "\ncy_px = " << cy
        << "\ndistortion = []\nrms_px = 0.3\nholdout_rms_px = 0.3\nverdict = \"usable\"\ndate = \"2026-01-01\"\n";
  }

  fs::path data_, folder_;
  int code_ = 0;
};

TEST_F(CalibrationData, OpencvLeft) {
  std::vector<std::string> args{"calibrate", "camera", "--board", "chessboard:9x6:25mm"};
  for (const std::string& p : pictures("opencv_left")) args.push_back(p);
  const core::Json got = pickcell(args, "camera.toml");
  EXPECT_EQ(code_, 0);
  EXPECT_GE(*got["used"].integer(), 12);
  EXPECT_LE(*got["rms_px"].number(), 0.19);
  EXPECT_NEAR(*got["fx_px"].number(), 533, 5.33);
  bool other_size = false;
  for (const core::Json& l : got["left_out"].items())
    other_size = other_size || (l["image"].string().ends_with("left.jpg") && l["reason"].string().find("612x459") == 3);
  EXPECT_TRUE(other_size);
  EXPECT_GT(fs::file_size(folder_ / "report.html"), 100'000U);
}

TEST_F(CalibrationData, RctCircles) {
  write_lens(640, 480, 542.324, 543.515, 320.474, 226.039);
  const std::string set = (data_ / "rct/circles").string();
  const core::Json got =
      pickcell({"calibrate", "handeye", "--camera", (folder_ / "camera.toml").string(), "--poses",
                set + "/cal_data.yaml", "--images", set, "--board", "circles:10x10:25.4mm", "--eye-in-hand"},
               "handeye.toml");
  EXPECT_EQ(*got["used"].integer(), 15);
  EXPECT_LE(*got["plane_error_mm"].number(), 2.9);
  EXPECT_EQ(got["verdict"].string(), "reject");
}

TEST_F(CalibrationData, RctCharucoWithTheLensThatCameWithIt) {
  write_lens(1600, 1200, 1352.02747, 1356.14287, 789.67065, 627.2995);
  const std::string set = (data_ / "rct/charuco").string();
  const core::Json got = pickcell(
      {"calibrate", "handeye", "--camera", (folder_ / "camera.toml").string(), "--poses", set + "/cal_data.yaml",
       "--images", set, "--board", "charuco:5x7:36.195mm:18.256mm:6X6_250", "--eye-to-hand"},
      "handeye.toml");
  EXPECT_GE(*got["used"].integer(), 14);
  EXPECT_LE(*got["rms_px"].number(), 1.5);
  EXPECT_LE(*got["plane_error_mm"].number(), 0.63);
  EXPECT_EQ(got["lens"].string(), "pictures");
  EXPECT_TRUE(fs::exists(folder_ / "handeye-camera.toml"));
}

TEST_F(CalibrationData, RctCharucoWithItsOwnLens) {
  std::vector<std::string> args{"calibrate", "camera", "--board", "charuco:5x7:36.195mm:18.256mm:6X6_250"};
  for (const std::string& p : pictures("rct/charuco/images")) args.push_back(p);
  pickcell(args, "camera.toml");
  const std::string set = (data_ / "rct/charuco").string();
  const core::Json got = pickcell(
      {"calibrate", "handeye", "--camera", (folder_ / "camera.toml").string(), "--poses", set + "/cal_data.yaml",
       "--images", set + "/images", "--board", "charuco:5x7:36.195mm:18.256mm:6X6_250", "--eye-to-hand"},
      "handeye.toml");
  EXPECT_GE(*got["used"].integer(), 14);
  EXPECT_LE(*got["rms_px"].number(), 1.5);
  EXPECT_LE(*got["plane_error_mm"].number(), 0.63);
}

}  // namespace
}  // namespace pickcell
