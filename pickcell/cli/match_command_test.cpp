// teach and match as a user meets them: arguments in, lines and exit codes out.

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <sstream>

#include "pickcell/cli/subcommand.hpp"
#include "pickcell/core/file.hpp"
#include "pickcell/core/json.hpp"
#include "pickcell/image/codec.hpp"

namespace pickcell::cli {
namespace {

namespace fs = std::filesystem;

struct Outcome {
  int code;
  std::string out;
  std::string err;
};

Outcome pickcell(const std::vector<std::string>& args) {
  std::ostringstream out, err;
  const int code = run(args, {out, err});
  return {code, out.str(), err.str()};
}

std::vector<core::Json> json_lines(const std::string& text) {
  std::vector<core::Json> out;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    auto parsed = core::parse_json(line, "stdout");
    EXPECT_TRUE(parsed) << line;
    if (parsed) out.push_back(*parsed);
  }
  return out;
}

image::Image drawn(int width, int height, const std::function<double(double, double)>& grey) {
  image::Image out(width, height);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      double sum = 0;
      for (const double dy : {-1 / 3., 0., 1 / 3.})
        for (const double dx : {-1 / 3., 0., 1 / 3.}) sum += grey(x + dx, y + dy);
      out.at(x, y) = static_cast<std::uint8_t>(std::lround(sum / 9));
    }
  return out;
}

/// An L with a hole, about (0, 0), 60 pixels wide.
double bracket(double x, double y) {
  const bool on = (x > -30 && x < -10 && y > -25 && y < 25) || (x > -30 && x < 30 && y > 5 && y < 25);
  return on && std::hypot(x + 20, y + 15) >= 5 ? 205 : 70;
}

struct Pose {
  double x, y, angle_deg, scale;
};

image::Image scene(const std::vector<Pose>& poses, int width = 320, int height = 240) {
  return drawn(width, height, [&](double x, double y) {
    double grey = 70 + 3 * std::sin(x / 9) + 3 * std::sin(y / 7);
    for (const Pose& p : poses) {  // t = R(a)^T (scene - c) / s
      const double a = p.angle_deg * 3.14159265358979 / 180, dx = (x - p.x) / p.scale, dy = (y - p.y) / p.scale;
      const double tx = std::cos(a) * dx - std::sin(a) * dy, ty = std::sin(a) * dx + std::cos(a) * dy;
      if (std::abs(tx) < 36 && std::abs(ty) < 31) grey = bracket(tx, ty);
    }
    return grey;
  });
}

class MatchCommand : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::path(::testing::TempDir()) /
              (std::string("pickcell_") + ::testing::UnitTest::GetInstance()->current_test_info()->name());
    fs::remove_all(folder_);
    fs::create_directories(folder_);
    save("part.png", drawn(73, 63, [](double x, double y) { return bracket(x - 36, y - 31); }));
    save("scene.png", scene({{120, 90, 40, 1}}));
    save("empty.png", scene({}));
  }
  void TearDown() override { fs::remove_all(folder_); }

  void save(const std::string& name, const image::Image& picture) {
    ASSERT_TRUE(image::save_png(path(name), picture.view()));
  }
  void write(const std::string& name, std::span<const std::byte> bytes) {
    ASSERT_TRUE(core::write_file_atomically(path(name), bytes));
  }
  [[nodiscard]] std::string path(const std::string& name) const { return (folder_ / name).string(); }

  /// Runs, expects exit code 2, nothing on stdout and one line on stderr that begins with `pickcell: ` and holds words.
  void refused(const std::vector<std::string>& args, const std::string& words) {
    const Outcome o = pickcell(args);
    EXPECT_EQ(o.code, 2) << o.err << o.out;
    EXPECT_EQ(o.out, "");
    EXPECT_EQ(o.err.substr(0, 10), "pickcell: ");
    EXPECT_EQ(std::count(o.err.begin(), o.err.end(), '\n'), 1) << o.err;
    EXPECT_NE(o.err.find(words), std::string::npos) << o.err;
  }

  fs::path folder_;
};

TEST_F(MatchCommand, TaughtPartIsFoundWhereItLies) {
  const Outcome taught = pickcell({"teach", path("part.png"), "-o", path("part.pcm"), "--name", "bracket", "--json"});
  ASSERT_EQ(taught.code, 0) << taught.err;
  const auto report = json_lines(taught.out).at(0);
  EXPECT_EQ(report["model"].string(), "bracket");
  EXPECT_EQ(*report["w"].integer(), 73);
  EXPECT_EQ(*report["h"].integer(), 63);
  EXPECT_EQ(*report["symmetry_order"].integer(), 1);
  for (const char* key : {"ambiguous_deg", "second_best_self_match", "suggested_min_score", "warnings", "teach_ms"})
    EXPECT_TRUE(report.has(key)) << key;

  const Outcome found = pickcell({"match", path("part.pcm"), path("scene.png"), "--json", "--threads", "1"});
  ASSERT_EQ(found.code, 0) << found.err;
  const auto lines = json_lines(found.out);
  ASSERT_EQ(lines.size(), 1u);
  EXPECT_EQ(lines[0]["image"].string(), path("scene.png"));
  EXPECT_EQ(*lines[0]["width"].integer(), 320);
  EXPECT_EQ(*lines[0]["height"].integer(), 240);
  EXPECT_EQ(lines[0]["engine"].string(), "best");
  EXPECT_TRUE(*lines[0]["complete"].boolean());
  EXPECT_GT(*lines[0]["time_ms"].number(), 0);
  EXPECT_FALSE(lines[0].has("rejected"));
  const auto& match = lines[0]["matches"].items().at(0);
  EXPECT_EQ(match["model"].string(), "bracket");
  EXPECT_NEAR(*match["x_px"].number(), 120, 0.3);
  EXPECT_NEAR(*match["y_px"].number(), 90, 0.3);
  EXPECT_NEAR(*match["angle_deg"].number(), 40, 0.5);
  EXPECT_NEAR(*match["scale"].number(), 1, 0.01);
  EXPECT_GT(*match["score"].number(), 0.7);
  for (const char* key : {"sigma_x_px", "sigma_y_px", "sigma_deg", "sigma_scale", "visible", "ambiguous_deg"})
    EXPECT_TRUE(match.has(key)) << key;
}

TEST_F(MatchCommand, TheReferencePointIsReported) {
  // (36 + 20, 31) of the template lies 20 to the right: at 40 degrees up to the right
  ASSERT_EQ(pickcell({"teach", path("part.png"), "-o", path("part.pcm"), "--ref", "56,31"}).code, 0);
  const Outcome found = pickcell({"match", path("part.pcm"), path("scene.png"), "--json"});
  const auto lines = json_lines(found.out);
  const auto& match = lines.at(0)["matches"].items().at(0);
  EXPECT_NEAR(*match["x_px"].number(), 120 + 20 * std::cos(40 * 3.14159265 / 180), 0.3);
  EXPECT_NEAR(*match["y_px"].number(), 90 - 20 * std::sin(40 * 3.14159265 / 180), 0.3);
}

TEST_F(MatchCommand, ABarePictureIsTaughtOnTheFly) {
  const Outcome found = pickcell({"match", path("part.png"), path("scene.png"), "--json"});
  EXPECT_EQ(found.code, 0) << found.err;
  EXPECT_EQ(json_lines(found.out).at(0)["matches"].items().at(0)["model"].string(), "part");
}

TEST_F(MatchCommand, SeveralPicturesModelsAndInstances) {
  save("two.png", scene({{90, 80, 10, 1}, {220, 150, -130, 1}}));
  save("other.png", drawn(70, 70, [](double x, double y) {
         const double r = std::hypot(x - 34.5, y - 34.5), a = std::atan2(y - 34.5, x - 34.5);
         return r < 30 && (r > 22 || std::cos(3 * a) + 0.5 * std::cos(a) > 0.4) ? 190. : 60.;
       }));
  const Outcome found = pickcell(
      {"match", path("part.png"), path("two.png"), path("scene.png"), "-m", path("other.png"), "--max", "5", "--json"});
  ASSERT_EQ(found.code, 0) << found.err;
  const auto lines = json_lines(found.out);
  ASSERT_EQ(lines.size(), 2u);
  EXPECT_EQ(lines[0]["matches"].items().size(), 2u);
  EXPECT_EQ(lines[1]["matches"].items().size(), 1u);
  const auto& both = lines[0]["matches"].items();
  EXPECT_GE(*both.at(0)["score"].number(), *both.at(1)["score"].number());
}

TEST_F(MatchCommand, NothingFoundIsOneNotAnError) {
  const Outcome found = pickcell({"match", path("part.png"), path("empty.png"), path("scene.png"), "--json"});
  EXPECT_EQ(found.code, 1);
  EXPECT_EQ(found.err, "");
  const auto lines = json_lines(found.out);
  ASSERT_EQ(lines.size(), 2u);
  EXPECT_TRUE(lines[0]["matches"].is_array());
  EXPECT_TRUE(lines[0]["matches"].items().empty());
  EXPECT_EQ(pickcell({"match", path("part.png"), path("scene.png"), "--min-score", "1"}).code, 1);
}

TEST_F(MatchCommand, RangesAndRegionLimitTheSearch) {
  EXPECT_EQ(pickcell({"match", path("part.png"), path("scene.png"), "--angle", "-180,180"}).code, 0);
  EXPECT_EQ(pickcell({"match", path("part.png"), path("scene.png"), "--angle", "-20,20"}).code, 1);
  EXPECT_EQ(pickcell({"match", path("part.png"), path("scene.png"), "--angle=-330,-310"}).code, 0);
  EXPECT_EQ(pickcell({"match", path("part.png"), path("scene.png"), "--roi", "100,70,40,40"}).code, 0);
  EXPECT_EQ(pickcell({"match", path("part.png"), path("scene.png"), "--roi", "180,70,40,40"}).code, 1);
}

TEST_F(MatchCommand, ExplainSaysWhatWasTurnedDownAndWhy) {
  const Outcome found =
      pickcell({"match", path("part.png"), path("scene.png"), "--min-score", "1", "--explain", "--json"});
  EXPECT_EQ(found.code, 1);
  const auto rejected = json_lines(found.out).at(0)["rejected"].items();
  ASSERT_FALSE(rejected.empty());
  EXPECT_EQ(rejected[0]["reason"].string(), "score");
  EXPECT_EQ(rejected[0]["stage"].string(), "final");
  EXPECT_NEAR(*rejected[0]["x_px"].number(), 120, 1);
  const Outcome words = pickcell({"match", path("part.png"), path("scene.png"), "--min-score", "1", "--explain"});
  EXPECT_NE(words.out.find("rejected (score, final)"), std::string::npos) << words.out;
}

TEST_F(MatchCommand, OverlaysGoToAFileOrAFolder) {
  ASSERT_EQ(pickcell({"match", path("part.png"), path("scene.png"), "--overlay", path("one.png")}).code, 0);
  const auto one = image::load_grey(path("one.png"));
  ASSERT_TRUE(one);
  EXPECT_EQ(one->width(), 320);
  ASSERT_EQ(
      pickcell({"match", path("part.png"), path("scene.png"), path("empty.png"), "--overlay", path("drawn")}).code, 1);
  EXPECT_TRUE(fs::exists(folder_ / "drawn" / "scene.png.png"));
  EXPECT_TRUE(fs::exists(folder_ / "drawn" / "empty.png.png"));
  refused({"match", path("part.png"), path("scene.png"), path("empty.png"), "--overlay", path("o.png")},
          "name a folder");
}

TEST_F(MatchCommand, UnreadablePicturesAreNamedAndTheOthersStillDone) {
  refused({"match", path("part.png"), path("missing.png")}, path("missing.png") + ": No such file");
  auto bytes = core::read_file(path("scene.png"));
  write("half.png", std::span(*bytes).first(bytes->size() / 2));
  refused({"match", path("part.png"), path("half.png")}, path("half.png") + ": truncated or damaged picture");
  refused({"match", path("half.png"), path("scene.png")}, path("half.png") + ": truncated or damaged picture");
  refused({"teach", path("half.png"), "-o", path("x.pcm")}, "truncated or damaged");
  EXPECT_FALSE(fs::exists(folder_ / "x.pcm"));
  const Outcome both = pickcell({"match", path("part.png"), path("half.png"), path("scene.png"), "--json"});
  EXPECT_EQ(both.code, 2);
  EXPECT_EQ(json_lines(both.out).size(), 1u);
  EXPECT_NE(both.err.find("half.png"), std::string::npos);
}

TEST_F(MatchCommand, ATemplateLargerThanThePictureIsRefused) {
  save("tiny.png", scene({{20, 20, 0, 1}}, 40, 40));
  refused({"match", path("part.png"), path("tiny.png")}, "larger than the picture");
}

TEST_F(MatchCommand, AFeaturelessTemplateIsRefusedAtTeaching) {
  image::Image flat(80, 60);
  flat.fill(99);
  save("flat.png", flat);
  refused({"teach", path("flat.png"), "-o", path("flat.pcm")}, path("flat.png") + ": it has no features");
  refused({"match", path("flat.png"), path("scene.png")}, "it has no features");
}

TEST_F(MatchCommand, MasksOfAnotherSizeOrWithoutAPartAreRefused) {
  image::Image mask(73, 63), other(72, 63);
  save("none.png", mask);
  save("other.png", other);
  refused({"teach", path("part.png"), "-o", path("x.pcm"), "--mask", path("other.png")},
          path("other.png") + ": it is 72x63 but the picture is 73x63");
  refused({"teach", path("part.png"), "-o", path("x.pcm"), "--mask", path("none.png")},
          path("none.png") + ": it marks no part");
  refused({"match", path("part.png"), path("scene.png"), "--mask", path("missing.png")}, "missing.png");
  mask.fill(255);
  save("all.png", mask);
  EXPECT_EQ(pickcell({"match", path("part.png"), path("scene.png"), "--mask", path("all.png")}).code, 0);
  ASSERT_EQ(pickcell({"teach", path("part.png"), "-o", path("part.pcm")}).code, 0);
  refused({"match", path("part.pcm"), path("scene.png"), "--mask", path("all.png")}, "is a taught model");
}

TEST_F(MatchCommand, SixteenBitAndColourPicturesAreConverted) {
  const image::Image grey = scene({{120, 90, 40, 1}});
  std::string deep = "P5 320 240 65535\n", colour = "P6 320 240 255\n";
  for (int y = 0; y < 240; ++y)
    for (int x = 0; x < 320; ++x) {
      deep += {static_cast<char>(grey.at(x, y)), static_cast<char>(grey.at(x, y))};
      colour += std::string(3, static_cast<char>(grey.at(x, y)));
    }
  write("deep.pgm", std::as_bytes(std::span(deep)));
  write("colour.ppm", std::as_bytes(std::span(colour)));
  const Outcome found =
      pickcell({"match", path("part.png"), path("scene.png"), path("deep.pgm"), path("colour.ppm"), "--json"});
  EXPECT_EQ(found.code, 0) << found.err;
  const auto lines = json_lines(found.out);
  ASSERT_EQ(lines.size(), 3u);
  for (const auto& line : lines)
    EXPECT_EQ(*line["matches"].items().at(0)["x_px"].number(), *lines[0]["matches"].items().at(0)["x_px"].number());
}

TEST_F(MatchCommand, BadValuesOfOptionsAreUsageErrors) {
  const std::string part = path("part.png"), picture = path("scene.png");
  refused({"match", part, picture, "--angle", "nan,10"}, "--angle: 'nan,10'");
  refused({"match", part, picture, "--angle", "90,-90"}, "--angle: '90,-90' is reversed");
  refused({"match", part, picture, "--angle", "-200,200"}, "wider than a full turn");
  refused({"match", part, picture, "--angle", "5"}, "is not a range");
  refused({"match", part, picture, "--angle"}, "--angle");
  refused({"match", part, picture, "--scale", "1.1,0.9"}, "is reversed");
  refused({"match", part, picture, "--scale", "0,1"}, "outside 0.1 to 10");
  refused({"match", part, picture, "--scale", "1,inf"}, "not finite");
  refused({"match", part, picture, "--max", "0"}, "--max");
  refused({"match", part, picture, "--max", "many"}, "--max");
  refused({"match", part, picture, "--min-score", "-1"}, "--min-score: '-1' is out of range");
  refused({"match", part, picture, "--max-overlap", "nan"}, "--max-overlap");
  refused({"match", part, picture, "--budget-ms", "-3"}, "--budget-ms");
  refused({"match", part, picture, "--threads", "0"}, "--threads");
  refused({"match", part, picture, "--roi", "0,0,0,5"}, "--roi: '0,0,0,5' is not a rectangle");
  refused({"match", part, picture, "--roi", "300,0,50,50"}, "does not lie inside the picture");
  refused({"match", part, picture, "--engine", "bset"}, "engine bset");
  refused({"match", part, picture, "--set", "no_such=1"}, "no_such");
  refused({"match", part, picture, "--set", "oops"}, "write --set KEY=VALUE");
  refused({"match", part, picture, "--params", path("missing.toml")}, "missing.toml");
  refused({"match", part, picture, "--anlge", "0,1"}, "unknown option '--anlge'; did you mean '--angle'?");
  refused({"match", part}, "IMAGE");
  refused({"mtach", part, picture}, "no such command; did you mean 'match'?");
  refused({"teach", part, "-o", path("x.pcm"), "--grasp", "1,2"}, "--grasp: '1,2' is not a grasp");
  refused({"teach", part, "-o", path("x.pcm"), "--grasp", "1,2,nan"}, "--grasp");
  refused({"teach", part, "-o", path("x.pcm"), "--ref", "1"}, "--ref: '1' is not a point");
  refused({"teach", part, "-o", path("x.pcm"), "--angle", "10,-10"}, "is reversed");
  refused({"teach", part, "-o", path("x.pcm"), "--scale", "nan,nan"}, "--scale");
  refused({"teach", part, "-o", path("x.pcm"), "--roi", "60,0,20,20"}, "--roi: the rectangle is not inside");
  refused({"teach", part, "-o", path("x.pcm"), "--height-mm", "tall"}, "--height-mm");
  refused({"teach", part}, "--out");
}

TEST_F(MatchCommand, EngineSettingsComeFromFileAndCommandLine) {
  write("p.toml", std::as_bytes(std::span(std::string_view("effort = \"quick\"\naccept_ncc = 0.7\n"))));
  EXPECT_EQ(
      pickcell({"match", path("part.png"), path("scene.png"), "--params", path("p.toml"), "--set", "effort=thorough"})
          .code,
      0);
  write("p.toml", std::as_bytes(std::span(std::string_view("efort = \"quick\"\n"))));
  refused({"match", path("part.png"), path("scene.png"), "--params", path("p.toml")}, "efort");
}

TEST_F(MatchCommand, ModelsOfAnotherVersionOrWithAFlippedByteAreRefused) {
  ASSERT_EQ(pickcell({"teach", path("part.png"), "-o", path("part.pcm"), "--grasp", "-5,20,-90,sym180", "--height-mm",
                      "12.5"})
                .code,
            0);
  const auto good = core::read_file(path("part.pcm"));
  auto version = *good;
  version[8] = std::byte{9};
  write("v.pcm", version);
  refused({"match", path("v.pcm"), path("scene.png")},
          path("v.pcm") + ": a model of version 9, this program reads version 1");
  for (const std::size_t at : {std::size_t{0}, std::size_t{12}, std::size_t{500}, good->size() - 1}) {
    auto flipped = *good;
    flipped[at] ^= std::byte{0x10};
    write("flipped.pcm", flipped);
    refused({"match", path("flipped.pcm"), path("scene.png")}, path("flipped.pcm") + ":");
  }
  write("cut.pcm", std::span(*good).first(100));
  refused({"match", path("part.png"), path("scene.png"), "-m", path("cut.pcm")}, "truncated");
}

TEST_F(MatchCommand, AModelThatCannotBeWrittenIsAnError) {
  refused({"teach", path("part.png"), "-o", path("no/such/folder/part.pcm")}, "cannot be written");
}

TEST(Command, HelpAndVersion) {
  EXPECT_EQ(pickcell({"--version"}).out.substr(0, 9), "pickcell ");
  EXPECT_NE(pickcell({"--help"}).out.find("match"), std::string::npos);
  const Outcome help = pickcell({"match", "--help"});
  EXPECT_EQ(help.code, 0);
  EXPECT_NE(help.out.find("--max-overlap"), std::string::npos);
  EXPECT_EQ(pickcell({}).code, 2);
}

/// A build without the cell or without calibration knows their commands by name, and says what is missing.
TEST(Command, WhatIsLeftOutSaysSo) {
  for (const Subcommand& command : subcommands()) {
    if (command.summary != "not in this build") continue;
    for (const char* word : {"--help", "--port=1", "now"}) {
      const Outcome said = pickcell({command.name, word});
      EXPECT_EQ(said.code, 2);
      const bool lens = command.name == "calibrate";
      EXPECT_THAT(said.err, testing::StartsWith("pickcell: " + command.name + ": this build has no " +
                                                (lens ? "calibration" : "cell")));
      EXPECT_THAT(said.err, testing::HasSubstr("; configure with -DPICKCELL_WITH_CELL=ON"));
      EXPECT_EQ(said.err.find("CALIBRATION=ON") != std::string::npos, lens);
    }
  }
}

TEST(Command, TheBinaryGivesTheSameExitCodes) {
  const auto exit_code = [](const std::string& args) {
    const int status = std::system((std::string(PICKCELL_BINARY) + " " + args + " >/dev/null 2>&1").c_str());
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  };
  EXPECT_EQ(exit_code("--version"), 0);
  EXPECT_EQ(exit_code("match a.png b.png"), 2);
  EXPECT_EQ(exit_code("match --angle -180,180"), 2);
  EXPECT_EQ(exit_code(""), 2);
}

}  // namespace
}  // namespace pickcell::cli
