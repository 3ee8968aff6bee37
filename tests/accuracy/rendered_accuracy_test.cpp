/// The gate of a stranger's checkout: sets rendered from the project's own parts, with exact truth.

#include "pickcell/sim/rendered_set.hpp"

#include <unistd.h>

#include "program.hpp"

namespace pickcell {
namespace {

class RenderedAccuracy : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = std::filesystem::path(::testing::TempDir()) / ("pickcell_rendered_" + std::to_string(getpid()));
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }
  std::filesystem::path folder_;
};

TEST_F(RenderedAccuracy, OnePartAmongOthersUnderFiveConditions) {
  ASSERT_TRUE(sim::write_rendered_set(folder_, 11));
  const Said said = pickcell({"bench", folder_.string(), "--absent", "--json"});
  ASSERT_EQ(said.code, 0) << said.err;
  EXPECT_EQ(said.json["images"].integer(), 75);
  // The light stays while the parts turn, so that metal looks different at every angle: harder than re-posed
  // photographs.
  EXPECT_GE(*said.json["accuracy"].number(), 0.95) << say_failures(said.json);
  EXPECT_GE(*said.json["strict"].number(), 0.92) << say_failures(said.json);
  EXPECT_LE(*said.json["median_px"].number(), 0.2);
  EXPECT_LE(*said.json["median_deg"].number(), 0.2);
  for (const char* kind : {"clean", "light_noise", "blur_noise"})
    EXPECT_EQ(*said.json["by_kind"][kind]["accuracy"].number(), 1.0) << kind << "\n" << say_failures(said.json);
  EXPECT_GE(*said.json["recall_at_threshold"].number(), 0.65);
  EXPECT_GT(*said.json["absent_images"].integer(), 40);
  EXPECT_LE(*said.json["false_accepts"].integer(), 1);
}

TEST_F(RenderedAccuracy, SeveralPartsAndNone) {
  ASSERT_TRUE(sim::write_rendered_multi_set(folder_, 12));
  const Said said = pickcell({"bench", folder_.string(), "--json"});
  ASSERT_EQ(said.code, 0) << said.err;
  EXPECT_GT(*said.json["instances"].integer(), 60);
  EXPECT_GE(*said.json["recall"].number(), 0.86) << say_failures(said.json);
  EXPECT_GE(*said.json["precision"].number(), 0.97) << say_failures(said.json);
}

}  // namespace
}  // namespace pickcell
