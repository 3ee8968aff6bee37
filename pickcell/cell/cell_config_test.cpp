#include "pickcell/cell/cell_config.hpp"

#include <gtest/gtest.h>

#include <string>

namespace pickcell::cell {
namespace {

const std::string kGood = R"(
[cell]
name = "table 1"
[camera]
source = "sim"
[robot]
link = "sim"
allow_motion = true
[calibration]
camera = "camera.toml"
plane = "plane.toml"
[limits]
box_min_mm = [100, -400, -5]
box_max_mm = [700, 400, 400]
[feed]
kind = "indexed"
[[part]]
model = "bracket.pcm"
height_mm = 6
place = { origin_mm = [300, 250, 0], angle_deg = 90, rows = 2, cols = 4, pitch_x_mm = 60, pitch_y_mm = 50 }
[[part]]
model = "gear.pcm"
place = { origin_mm = [300, -250, 0] }
)";

/// The first problem of the text, "" when there is none.
std::string problem_of(const std::string& text) {
  auto config = core::Config::parse(text, "CELL.toml");
  if (!config) return config.error().line();
  [[maybe_unused]] const CellConfig cell = read_cell_config(*config, "CELL.toml");
  const auto status = config->finish();
  return status ? "" : status.error().line();
}

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const auto at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}

TEST(CellConfig, ReadsEveryTableAndFillsDefaults) {
  auto config = core::Config::parse(kGood, "CELL.toml");
  ASSERT_TRUE(config);
  const CellConfig cell = read_cell_config(*config, "CELL.toml");
  ASSERT_TRUE(config->finish()) << config->finish().error().line();
  EXPECT_EQ(cell.name, "table 1");
  EXPECT_TRUE(cell.robot.allow_motion);
  EXPECT_EQ(cell.feed.kind, FeedKind::indexed);
  EXPECT_EQ(cell.limits.place_mm, 1);
  EXPECT_EQ(cell.limits.box_max_mm[0], 700);
  ASSERT_EQ(cell.parts.size(), 2u);
  EXPECT_EQ(cell.parts[0].place.cols, 4);
  EXPECT_EQ(cell.parts[0].height_mm, 6);
  EXPECT_FALSE(cell.parts[1].height_mm.has_value());
  EXPECT_EQ(cell.calibration.max_age_days, 365);
  EXPECT_EQ(cell.listen, "127.0.0.1:8080");
}

TEST(CellConfig, UnknownKeysNameTheNearestKnownOne) {
  EXPECT_EQ(problem_of(replaced(kGood, "allow_motion", "alow_motion")),
            "CELL.toml: unknown key 'robot.alow_motion'; did you mean 'allow_motion'?");
  EXPECT_EQ(problem_of(replaced(kGood, "pitch_y_mm = 50", "pitch_y_mm = 50, pitchz = 1")),
            "CELL.toml: unknown key 'part[0].place.pitchz'; remove it");
  EXPECT_NE(problem_of(kGood + "[robots]\nlink = \"sim\"\n").find("unknown key 'robots'"), std::string::npos);
}

TEST(CellConfig, MissingAndWrongValuesNameFileAndKey) {
  EXPECT_EQ(problem_of(replaced(kGood, "source = \"sim\"", "")), "CELL.toml: 'camera.source' is missing");
  EXPECT_EQ(problem_of(replaced(kGood, "[700, 400, 400]", "[700, 400]")),
            "CELL.toml: 'limits.box_max_mm' must have three numbers: x, y, z");
  EXPECT_EQ(problem_of(replaced(kGood, "[700, 400, 400]", "[700, -401, 400]")),
            "CELL.toml: 'limits.box_max_mm' must be above box_min_mm in every direction");
  EXPECT_EQ(problem_of(replaced(kGood, "rows = 2", "rows = 0")),
            "CELL.toml: 'part[0].place.rows' must be within 1 and 1000");
  EXPECT_EQ(problem_of(replaced(kGood, "pitch_x_mm = 60, ", "")),
            "CELL.toml: 'part[0].place.pitch_x_mm' is needed for more than one column");
  EXPECT_EQ(problem_of(replaced(kGood, "\"indexed\"", "\"tracked\"")),
            "CELL.toml: 'feed.kind' must be \"none\" or \"indexed\"");
  EXPECT_NE(problem_of(replaced(kGood, "plane = \"plane.toml\"", "plane = \"p.toml\"\nhandeye = \"h.toml\""))
                .find("one of them"),
            std::string::npos);
  EXPECT_NE(problem_of(replaced(kGood, "plane = \"plane.toml\"", "plane = \"p.toml\"\nverify_at_start = \"yes\""))
                .find("board_stays"),
            std::string::npos);
  EXPECT_NE(problem_of(replaced(kGood, "box_min_mm = [100, -400, -5]", "")).find("box_min_mm"), std::string::npos);
}

TEST(CellConfig, ACellWithoutPartsIsRefused) {
  EXPECT_NE(problem_of(kGood.substr(0, kGood.find("[[part]]"))).find("at least one [[part]]"), std::string::npos);
}

}  // namespace
}  // namespace pickcell::cell
