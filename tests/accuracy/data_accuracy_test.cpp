/// On real photographs and objects, which are not shipped: skipped where they are missing.

#include <algorithm>
#include <cmath>
#include <sstream>

#include "pickcell/core/file.hpp"
#include "pickcell/image/codec.hpp"
#include "program.hpp"

namespace pickcell {
namespace {

namespace fs = std::filesystem;

#define SHARED_DATA_OR_SKIP(folder, set) \
  const auto folder = shared_data(set);  \
  if (!folder) GTEST_SKIP() << "no " set ": set PICKCELL_DATA to the folder of the data sets"

TEST(SharedData, Rst200) {
  SHARED_DATA_OR_SKIP(set, "rst200");
  const Said said = pickcell({"bench", set->string(), "--json"});
  ASSERT_EQ(said.code, 0) << said.err;
  EXPECT_EQ(said.json["images"].integer(), 200);
  EXPECT_GE(*said.json["correct"].integer(), 198) << say_failures(said.json);
  EXPECT_GE(*said.json["strict_count"].integer(), 197) << say_failures(said.json);
  EXPECT_LE(*said.json["median_px"].number(), 0.03);
  EXPECT_LE(*said.json["median_deg"].number(), 0.02);
}

TEST(SharedData, Belt) {
  SHARED_DATA_OR_SKIP(set, "belt");
  const Said said = pickcell({"bench", set->string(), "--json"});
  ASSERT_EQ(said.code, 0) << said.err;
  EXPECT_EQ(said.json["images"].integer(), 130);
  EXPECT_GE(*said.json["correct"].integer(), 129) << say_failures(said.json);
  EXPECT_GE(*said.json["strict_count"].integer(), 128) << say_failures(said.json);
}

TEST(SharedData, BeltWithSeveralParts) {
  SHARED_DATA_OR_SKIP(set, "belt_multi");
  const Said said = pickcell({"bench", set->string(), "--json"});
  ASSERT_EQ(said.code, 0) << said.err;
  EXPECT_GE(*said.json["recall"].number(), 0.97) << say_failures(said.json);
  EXPECT_GE(*said.json["precision"].number(), 0.99) << say_failures(said.json);
}

/// A disc of white on black, as a mask file.
fs::path disc_mask(const fs::path& folder, int width, int height, double x, double y, double radius) {
  image::Image mask(width, height);
  for (int v = 0; v < height; ++v)
    for (int u = 0; u < width; ++u)
      mask.at(u, v) = static_cast<std::uint8_t>(std::hypot(u - x, v - y) <= radius ? 255 : 0);
  EXPECT_TRUE(image::save_png(folder / "mask.png", mask.view()));
  return folder / "mask.png";
}

/// The cap is almost the same after half a turn: its reference states the angle modulo 180 degrees.
TEST(SharedData, ToothedCapAtEveryAngle) {
  SHARED_DATA_OR_SKIP(set, "real/cap");
  const auto text = core::read_text_file(*set / "reference.csv");
  ASSERT_TRUE(text);
  struct Row {
    std::string file;
    double x, y, deg;
  };
  std::vector<Row> rows;
  std::istringstream lines(*text);
  for (std::string line; std::getline(lines, line);) {
    std::replace(line.begin(), line.end(), ',', ' ');
    std::istringstream fields(line);
    Row row;
    if (fields >> row.file >> row.x >> row.y >> row.deg) rows.push_back(row);
  }
  ASSERT_EQ(rows.size(), 29u);
  const Row& taught = rows.front();
  const fs::path folder = fs::path(::testing::TempDir()) / "pickcell_cap";
  fs::create_directories(folder);
  const fs::path mask = disc_mask(folder, 1280, 1024, taught.x, taught.y, 212);
  const auto number = [](double v) { return std::to_string(v); };
  const int left = static_cast<int>(taught.x) - 215, top = static_cast<int>(taught.y) - 215;
  const Said teach = pickcell({"teach", (*set / taught.file).string(), "-o", (folder / "cap.pcm").string(), "--mask",
                               mask.string(), "--ref", number(taught.x) + "," + number(taught.y), "--roi",
                               std::to_string(left) + "," + std::to_string(top) + ",431,431", "--json"});
  ASSERT_EQ(teach.code, 0) << teach.err;
  for (const Row& row : rows) {
    const Said said = pickcell({"match", (folder / "cap.pcm").string(), (*set / row.file).string(), "--json"});
    ASSERT_EQ(said.json["matches"].items().size(), 1u) << row.file << said.err;
    const core::Json& match = said.json["matches"].items().front();
    EXPECT_LE(std::hypot(*match["x_px"].number() - row.x, *match["y_px"].number() - row.y), 2.5) << row.file;
    const double turned = row.deg - taught.deg - *match["angle_deg"].number();
    EXPECT_LE(std::abs(std::remainder(turned, 180)), 0.3) << row.file;
  }
  fs::remove_all(folder);
}

struct Pair {
  std::vector<std::string> command;  ///< template, scene, arguments
  struct Part {
    double x, y, deg;
  };
  std::vector<Part> parts;
};

std::vector<Pair> read_pairs(const std::string& text) {
  std::vector<Pair> out;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    std::istringstream words(line);
    if (line.starts_with("pair ")) {
      out.emplace_back();
      words.ignore(5);
      for (std::string word; words >> word;) out.back().command.push_back(word);
    } else if (Pair::Part part{}; words >> part.x >> part.y >> part.deg) {
      out.back().parts.push_back(part);
    }
  }
  return out;
}

/// All of them and nothing else.
TEST(SharedData, RealPairs) {
  SHARED_DATA_OR_SKIP(set, "real/pairs");
  const auto text = core::read_text_file(fs::path(PICKCELL_SOURCE_DIR) / "tests/accuracy/pairs.txt");
  ASSERT_TRUE(text);
  const std::vector<Pair> pairs = read_pairs(*text);
  ASSERT_EQ(pairs.size(), 5u);
  for (const Pair& pair : pairs) {
    std::vector<std::string> command{"match", (*set / pair.command[0]).string(), (*set / pair.command[1]).string()};
    command.insert(command.end(), pair.command.begin() + 2, pair.command.end());
    command.push_back("--json");
    const Said said = pickcell(command);
    const auto& matches = said.json["matches"].items();
    EXPECT_EQ(matches.size(), pair.parts.size()) << pair.command[1] << said.err;
    for (const Pair::Part& part : pair.parts)
      EXPECT_EQ(std::count_if(matches.begin(), matches.end(),
                              [&](const core::Json& m) {
                                return std::hypot(*m["x_px"].number() - part.x, *m["y_px"].number() - part.y) <= 3 &&
                                       std::abs(std::remainder(*m["angle_deg"].number() - part.deg, 360.0)) <= 2;
                              }),
                1)
          << pair.command[1] << " at " << part.x << ", " << part.y;
  }
}

}  // namespace
}  // namespace pickcell
