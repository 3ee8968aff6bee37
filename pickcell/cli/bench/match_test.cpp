#include "pickcell/cli/bench/match.hpp"

#include <gtest/gtest.h>

#include <map>

#include "pickcell/cli/bench/report.hpp"
#include "pickcell/cli/yardstick.hpp"

namespace pickcell::cli {
namespace {

using core::Json;
using matches::Match;
using matches::SearchOptions;

/// Answers by the picture's top-left pixel, so that scoring and reporting are tested without a matcher.
class ScriptedEngine final : public matches::Engine {
 public:
  std::map<int, std::vector<Match>> answers;  ///< by pixel value, for the first template
  std::vector<Match> absent_answer;           ///< for every other template
  std::vector<SearchOptions> asked;

  core::Result<matches::FindResult> find(const image::Pyramid& scene, std::span<const matches::Model* const> models,
                                         const SearchOptions& options) override {
    asked.push_back(options);
    matches::FindResult out;
    out.stages.push_back({"final", 1, 1, 10, 0.1});
    out.matches = models[0]->name == "a" ? answers[scene.level(0).at(0, 0)] : absent_answer;
    return out;
  }
  [[nodiscard]] std::string name() const override { return "scripted"; }
};

Match match_at(double x, double y, double angle_deg, double score) {
  Match m;
  m.pose = {x, y, angle_deg, 1};
  m.score = score;
  return m;
}

/// Pictures 0.png, 1.png, ... of 60x60 px, all of the value of their number.
core::Result<image::Image> numbered(const std::filesystem::path& path) {
  image::Image out(60, 60);
  out.fill(static_cast<std::uint8_t>(std::stoi(path.stem().string())));
  return out;
}

Models two_models() {
  Models out;
  for (const char* name : {"a", "b"}) {
    out.push_back(std::make_unique<matches::Model>());
    out.back()->name = name;
    out.back()->picture = image::Image(30, 40);  // diagonal 50
    out.back()->learnt.suggested_min_score = 0.6;
  }
  return out;
}

Dataset set_of(const std::string& images) {
  auto set =
      parse_dataset(R"({"name":"scripted set","templates":[{"id":"a","file":"a.png","size":"small","w":30,"h":40},
    {"id":"b","file":"b.png","size":"large"}],"images":[)" +
                        images + "]}",
                    "truth.json", "/set");
  EXPECT_TRUE(set) << set.error().line();
  return *set;
}

std::string single(int i, const std::string& kind) {
  const std::string n = std::to_string(i);
  return R"({"file":")" + n + R"(.png","template":"a","kind":")" + kind +
         R"(","clutter":[],"x":10,"y":10,"angle":350,"scale":1})";
}

BenchReport report_of(const Dataset& set, ScriptedEngine& engine, BenchRun& run) {
  const Models models = two_models();
  run.isa = "none";
  run.options.engine = engine.name();
  const auto done = match_images(set, models, engine, numbered, run);
  EXPECT_TRUE(done) << done.error().line();
  return summarise(set, run);
}

TEST(BenchMatch, CountsByKindAndListsFailures) {
  const Dataset set = set_of(single(0, "clean") + "," + single(1, "clean") + "," + single(2, "mixed"));
  ScriptedEngine engine;
  engine.answers = {{0, {match_at(10, 10.5, -10, 0.9)}}, {1, {match_at(12, 10, -10, 0.8)}}, {2, {}}};
  BenchRun run;
  const BenchReport report = report_of(set, engine, run);
  EXPECT_EQ(report.all.correct, 2u);
  EXPECT_EQ(report.all.strict, 1u);
  ASSERT_EQ(report.by_kind.size(), 2u);
  EXPECT_EQ(report.by_kind[0].name, "clean");
  EXPECT_EQ(report.by_kind[0].correct, 2u);
  EXPECT_EQ(report.by_kind[1].correct, 0u);
  ASSERT_EQ(report.by_size.size(), 1u);  // no picture of the large template: left out
  EXPECT_EQ(report.by_size[0].name, "small");
  EXPECT_EQ(report.by_size[0].ncc_count, 30);
  ASSERT_EQ(report.failures.size(), 1u);
  EXPECT_EQ(report.failures[0].image, "2.png");
  EXPECT_EQ(report.failures[0].why, "no match");
  EXPECT_NEAR(*report.px.median, 1.25, 1e-9);  // 0.5 and 2
  EXPECT_FALSE(report.instances);
  EXPECT_FALSE(report.absent);
}

TEST(BenchMatch, OnePoseIsSearchedWithoutThresholdOnceUntimedOnceTimed) {
  const Dataset set = set_of(single(0, "clean"));
  ScriptedEngine engine;
  BenchRun run;
  (void)report_of(set, engine, run);
  ASSERT_EQ(engine.asked.size(), 2u);
  EXPECT_EQ(engine.asked[1].max_matches, 1);
  EXPECT_EQ(engine.asked[1].min_score, 0);
  EXPECT_EQ(engine.asked[1].threads, 1);
}

TEST(BenchMatch, InstancesAreSearchedWithTheModelsThreshold) {
  const Dataset set = set_of(
      R"({"file":"0.png","template":"a","instances":[{"x":5,"y":5,"angle":0,"scale":1},{"x":15,"y":15,"angle":0,"scale":1}]},
         {"file":"1.png","template":"a","instances":[]})");
  ScriptedEngine engine;
  engine.answers = {{0, {match_at(5, 5, 0, 0.9), match_at(5, 6, 0, 0.8)}}, {1, {match_at(1, 1, 0, 0.7)}}};
  BenchRun run;
  const BenchReport report = report_of(set, engine, run);
  EXPECT_EQ(engine.asked[0].max_matches, 200);
  EXPECT_FALSE(engine.asked[0].min_score);
  const Json json = to_json(report);
  EXPECT_EQ(json["instances"].integer(), 2);
  EXPECT_DOUBLE_EQ(*json["recall"].number(), 0.5);
  EXPECT_NEAR(*json["precision"].number(), 1.0 / 3, 1e-12);
  EXPECT_EQ(json["correct"].integer(), 0);
}

TEST(BenchMatch, AbsentPartsCountFalseAcceptsAndRecallAtTheThreshold) {
  const Dataset set = set_of(single(0, "clean") + "," + single(1, "clean") +
                             R"(,{"file":"2.png","template":"a","kind":"mixed","x":1,"y":1,"angle":0,"scale":1})");
  ScriptedEngine engine;
  engine.answers = {
      {0, {match_at(10, 10, 350, 0.9)}}, {1, {match_at(10, 10, 350, 0.5)}}, {2, {match_at(1, 1, 0, 0.6)}}};
  engine.absent_answer = {match_at(3, 3, 0, 0.7)};
  BenchRun run;
  run.options.absent = true;
  const BenchReport report = report_of(set, engine, run);
  ASSERT_TRUE(report.absent);
  EXPECT_EQ(report.absent->images, 2u);  // the third does not record its clutter
  EXPECT_EQ(report.absent->false_accepts, 2u);
  EXPECT_NEAR(report.absent->recall_at_threshold, 2.0 / 3, 1e-12);  // the second stands below 0.6
  EXPECT_EQ(report.all.correct, 3u);
  EXPECT_FALSE(engine.asked[2].min_score);  // the absent part: the model's threshold
}

TEST(BenchMatch, EveryKTakesPictures0KAnd2K) {
  std::string images;
  for (int i = 0; i < 7; ++i) images += (i ? "," : "") + single(i, "clean");
  const Dataset set = set_of(images);
  EXPECT_EQ(chosen_images(set, 3), (std::vector<std::size_t>{0, 3, 6}));
  EXPECT_EQ(chosen_images(set, 1).size(), 7u);
  EXPECT_EQ(chosen_images(set, 100), (std::vector<std::size_t>{0}));
}

TEST(BenchMatch, APictureOfAnotherSizeThanRecordedIsRefused) {
  const Dataset set =
      set_of(R"({"file":"0.png","template":"a","width":61,"height":60,"x":1,"y":1,"angle":0,"scale":1})");
  ScriptedEngine engine;
  BenchRun run;
  const auto done = match_images(set, two_models(), engine, numbered, run);
  ASSERT_FALSE(done);
  EXPECT_EQ(done.error().why, "is 60x60 px, but truth.json says 61x60");
}

TEST(BenchMatch, AtLeastNineYardsticksAreSpreadOverTheRun) {
  std::string images = single(0, "clean");
  for (int i = 1; i < 20; ++i) images.append(",").append(single(i, "clean"));
  ScriptedEngine engine;
  BenchRun run;
  (void)report_of(set_of(images), engine, run);
  EXPECT_EQ(run.yardstick_ms.size(), Yardstick::available() ? 9u : 0u);
  BenchRun short_run;
  (void)report_of(set_of(single(0, "clean")), engine, short_run);
  EXPECT_EQ(short_run.yardstick_ms.size(), run.yardstick_ms.size());
}

std::vector<std::string> keys_of(const Json& object) {
  std::vector<std::string> out;
  for (const auto& [key, value] : object.members()) out.push_back(key);
  return out;
}

TEST(BenchReportJson, HasExactlyTheDocumentedKeys) {
  const Dataset set = set_of(single(0, "clean"));
  ScriptedEngine engine;
  engine.answers = {{0, {match_at(10, 10, 350, 0.9)}}};
  BenchRun run;
  const Json json = to_json(report_of(set, engine, run));
  const std::vector<std::string> documented{"dataset",         "engine",
                                            "threads",         "isa",
                                            "images",          "correct",
                                            "strict_count",    "accuracy",
                                            "strict",          "median_ms",
                                            "mean_ms",         "p95_ms",
                                            "teach_ms",        "median_px",
                                            "p95_px",          "median_deg",
                                            "p95_deg",         "median_scale_pct",
                                            "yardstick_ms",    "median_yardsticks",
                                            "mean_yardsticks", "by_size",
                                            "by_kind",         "failures",
                                            "loose_count",     "loose"};
  EXPECT_EQ(keys_of(json), documented);
  EXPECT_EQ(keys_of(json["by_kind"]["clean"]),
            (std::vector<std::string>{"images", "correct", "strict_count", "accuracy", "strict", "median_ms", "mean_ms",
                                      "ncc_count", "loose_count", "loose"}));
  EXPECT_DOUBLE_EQ(*json["accuracy"].number(), 1);
  EXPECT_EQ(json["yardstick_ms"].is_null(), !Yardstick::available());
  EXPECT_TRUE(json["failures"].is_array());
}

TEST(BenchReportJson, FiguresOfNothingAreNull) {
  ScriptedEngine engine;
  BenchRun run;
  const Json json = to_json(report_of(set_of(single(0, "clean")), engine, run));
  EXPECT_TRUE(json["median_px"].is_null());
  EXPECT_TRUE(json["teach_ms"].is_null());
  EXPECT_EQ(json["failures"].items().size(), 1u);
  EXPECT_EQ(json["failures"].items()[0]["why"].string(), "no match");
}

TEST(BenchReportTable, NamesEveryClassAndFailure) {
  const Dataset set = set_of(single(0, "clean") + "," + single(1, "mixed"));
  ScriptedEngine engine;
  engine.answers = {{0, {match_at(10, 10, 350, 0.9)}}};
  BenchRun run;
  const std::string table = to_table(report_of(set, engine, run));
  for (const char* word : {"scripted set", "clean", "mixed", "small", "50.0 %", "1.png: no match"})
    EXPECT_NE(table.find(word), std::string::npos) << word << " in\n" << table;
}

}  // namespace
}  // namespace pickcell::cli
