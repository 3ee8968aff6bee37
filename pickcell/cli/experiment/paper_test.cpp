#include <gtest/gtest.h>

#include <unistd.h>

#include <filesystem>
#include <sstream>

#include "pickcell/cli/bench/dataset.hpp"
#include "pickcell/cli/experiment/experiment.hpp"
#include "pickcell/cli/experiment/paper_pictures.hpp"
#include "pickcell/cli/experiment/paper_sample.hpp"
#include "pickcell/core/json.hpp"
#include "pickcell/image/codec.hpp"

namespace pickcell::cli {
namespace {

/// A folder of its own that goes with the test.
class PaperExperiment : public ::testing::Test {
 protected:
  PaperExperiment() {
    const auto* test = ::testing::UnitTest::GetInstance()->current_test_info();
    options_.out = std::filesystem::temp_directory_path() /
                   (std::string("pickcell_paper_") + test->name() + "_" + std::to_string(::getpid()));
    std::filesystem::create_directories(options_.out);
    options_.json = true;
  }
  ~PaperExperiment() override { std::filesystem::remove_all(options_.out); }

  core::Json run(const std::string& name, int n) {
    options_.n = n;
    std::ostringstream out, err;
    Io io{out, err};
    for (const Experiment& e : experiments())
      if (e.name == name) {
        const auto code = e.run(options_, io);
        EXPECT_TRUE(code) << code.error().line();
      }
    auto parsed = core::parse_json(out.str(), "figures");
    EXPECT_TRUE(parsed);
    return parsed ? *parsed : core::Json();
  }
  ExperimentOptions options_;
};

TEST_F(PaperExperiment, Fig9FindsASmallAngleToAHalfDegree) {
  const core::Json rows = run("fig9", 1);
  ASSERT_EQ(rows.items().size(), 1u);
  for (const char* engine : {"rst", "erst", "best"}) EXPECT_NEAR(*rows.items()[0][engine].number(), 2, 0.5) << engine;
  EXPECT_TRUE(std::filesystem::exists(options_.out / "fig9_2_rst.png"));
}

TEST_F(PaperExperiment, Fig8FindsSmallTargetsAndDrawsThem) {
  const core::Json rows = run("fig8", 1);
  ASSERT_EQ(rows.items().size(), 1u);
  for (const char* engine : {"rst", "erst", "best"}) {
    EXPECT_GE(*rows.items()[0][engine]["found"].number(), 5) << engine;  // of 6
    EXPECT_TRUE(std::filesystem::exists(options_.out / ("fig8a_small_" + std::string(engine) + ".png")));
  }
}

TEST_F(PaperExperiment, Table3GraspsAndPlacesASample) {
  const core::Json rows = run("table3", 1);
  ASSERT_EQ(rows.items().size(), 1u);
  for (const char* engine : {"rst", "best"}) {
    EXPECT_TRUE(rows.items()[0][engine]["placed"].boolean().value_or(false)) << engine;
    EXPECT_LT(*rows.items()[0][engine]["place_mm"].number(), 1) << engine;
  }
  for (const char* file : {"table3.md", "table3_time.svg", "table3_place.svg", "table3_SP1_rst.png"})
    EXPECT_TRUE(std::filesystem::exists(options_.out / file)) << file;
}

TEST_F(PaperExperiment, ASampleThatIsNeverFoundIsGivenUp) {
  const auto outcome = pick_sample(kSamples[0], "rst", {{"t1", "1"}}, options_.out, 1);
  ASSERT_TRUE(outcome) << outcome.error().line();
  EXPECT_FALSE(outcome->placed);
  EXPECT_LE(outcome->looks, kLooksPerSample + 1);
  EXPECT_NE(outcome->end.find("no part to pick"), std::string::npos) << outcome->end;
}

TEST_F(PaperExperiment, Table2WritesASetThatBenchReads) {
  const core::Json figures = run("table2", 1);
  EXPECT_EQ(*figures["table2"]["rst"]["medium"]["images"].number(), 5);
  const auto set = load_dataset(options_.out / "set");
  ASSERT_TRUE(set) << set.error().line();
  EXPECT_EQ(set->images.size(), 5u);
  for (const char* file :
       {"table2.md", "table2_stages.md", "table2_misses.md", "table2_miss_list.md", "table2_time.svg"})
    EXPECT_TRUE(std::filesystem::exists(options_.out / file)) << file;
  const core::Json medium = figures["table2"]["erst"]["medium"];
  EXPECT_NEAR(*medium["stage_robust"]["ncc_count"].number(),
              480 * 5 * *medium["stage_robust"]["population_mean"].number(), 1e-6);
  const core::Json ratio = figures["table2"]["erst_over_rst"]["medium"], fast = figures["table2"]["rst"]["medium"];
  EXPECT_NEAR(*ratio["ncc_count"].number(), *medium["ncc_count"].number() / *fast["ncc_count"].number(), 1e-9);
  EXPECT_NEAR(*ratio["mean_ms"].number(), *medium["mean_ms"].number() / *fast["mean_ms"].number(), 1e-9);
}

}  // namespace
}  // namespace pickcell::cli
