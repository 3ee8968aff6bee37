#include "pickcell/core/json.hpp"

#include <gtest/gtest.h>

#include <limits>

namespace pickcell::core {
namespace {

TEST(Json, KeepsOrderAndSurvivesARoundTrip) {
  Json line;
  line.set("image", "a \"b\".png")
      .set("time_ms", 1.25)
      .set("n", 3)
      .set("ok", true)
      .set("list", std::vector<double>{1, 2.5});
  EXPECT_EQ(line.dump(), R"({"image":"a \"b\".png","time_ms":1.25,"n":3,"ok":true,"list":[1.0,2.5]})");
  EXPECT_EQ(parse_json(line.dump(), "x")->dump(), line.dump());
}

TEST(Json, NotANumberBecomesNull) { EXPECT_EQ(Json(std::numeric_limits<double>::quiet_NaN()).dump(), "null"); }

TEST(Json, BadTextAndDeepNestingAreRefused) {
  EXPECT_FALSE(parse_json("{", "x"));
  EXPECT_FALSE(parse_json(std::string(100000, '['), "x"));
  EXPECT_FALSE(parse_json(std::string(100, '[') + std::string(100, ']'), "x"));
}

}  // namespace
}  // namespace pickcell::core
