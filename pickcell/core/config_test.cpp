#include "pickcell/core/config.hpp"

#include <gtest/gtest.h>

namespace pickcell::core {
namespace {

TEST(Config, ReadsTypedValuesAndAcceptsKnownKeys) {
  auto config = Config::parse("a = 1.5\nn = 7\nname = \"x\"\nT = [[1, 0], [0, 1]]\n[sub]\nb = true\n", "t.toml");
  ASSERT_TRUE(config);
  EXPECT_DOUBLE_EQ(config->number("a"), 1.5);
  EXPECT_EQ(config->integer("n"), 7);
  EXPECT_EQ(config->string("name"), "x");
  EXPECT_EQ(config->matrix("T").size(), 2u);
  EXPECT_TRUE(config->table("sub").boolean_or("b", false));
  EXPECT_TRUE(config->finish());
}

TEST(Config, CharactersBeyondAsciiStandInQuotesAndComments) {
  auto config = Config::parse(
      "\xEF\xBB\xBF# \xC8\x80\na = \"\xC8\x80 \\\" \xC3\xA4\"\nb = '\xD0\x94'\nc = \"\"\"\n\xC3\xA4 \"x\" \"\"\"\nd = "
      "1 # \xC3\xA4",
      "t.toml");
  ASSERT_TRUE(config) << config.error().line();
  EXPECT_EQ(config->string("a"), "\xC8\x80 \" \xC3\xA4");
  for (const char* bad : {"\xC8\x80", "x = 1\n\xC3\xA4 = 2", "a = 'x'\xC8\x80", "a = \xE2\x80\x80 1"}) {
    const auto refused = Config::parse(bad, "t.toml");
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().remedy, "put it in quotes");
  }
  EXPECT_EQ(Config::parse("x = 1\n\xC3\xA4 = 2", "t.toml").error().line(),
            "t.toml: line 2: a character beyond ASCII outside of quotes; put it in quotes");
  EXPECT_FALSE(Config::parse("a = \"\xC8\x80", "t.toml"));  // an open string
  // Quotes that open no string: what follows is looked up as well.
  EXPECT_FALSE(Config::parse("- = +\"\x01\xCE\xA3", "t.toml"));
  EXPECT_TRUE(
      Config::parse("\xEF\xBB\xBF"
                    "a = 'x'  # \xCE\xA3",
                    "t.toml"))
      << "a byte order mark and a comment";
}

TEST(Config, UnknownKeyNamesTheNearestKnownOne) {
  auto config = Config::parse("exposure_su = 100\n", "t.toml");
  ASSERT_TRUE(config);
  config->number_or("exposure_us", 1);
  const auto status = config->finish();
  ASSERT_FALSE(status);
  EXPECT_EQ(status.error().line(), "t.toml: unknown key 'exposure_su'; did you mean 'exposure_us'?");
}

TEST(Config, MissingAndMistypedValuesAreNamedWithTheirTable) {
  auto config = Config::parse("[camera]\nfx_px = \"wide\"\n", "t.toml");
  ASSERT_TRUE(config);
  auto camera = config->table("camera");
  camera.number("fx_px");
  EXPECT_EQ(config->finish().error().why, "'camera.fx_px' must be a finite number");
  auto missing = Config::parse("", "t.toml");
  missing->table("camera").number("fx_px");
  EXPECT_EQ(missing->finish().error().why, "'camera.fx_px' is missing");
}

TEST(Config, NotANumberIsRefused) {
  auto config = Config::parse("a = nan\n", "t.toml");
  ASSERT_TRUE(config);
  config->number("a");
  EXPECT_FALSE(config->finish());
}

TEST(Config, BrokenTextSaysTheLine) {
  const auto config = Config::parse("a = 1\nb = = 2\n", "t.toml");
  ASSERT_FALSE(config);
  EXPECT_NE(config.error().why.find("line 2"), std::string::npos);
}

TEST(Config, TextGivesValuesOfFreeKeysInWords) {
  auto config = Config::parse("a = 0.9\nb = 3\nc = true\nd = \"subpixel\"\ne = [0.9, 1, 1.1]\nf = {x = 1}\n", "t.toml");
  ASSERT_TRUE(config);
  EXPECT_EQ(config->text("a"), "0.9");
  EXPECT_EQ(config->text("b"), "3");
  EXPECT_EQ(config->text("c"), "true");
  EXPECT_EQ(config->text("d"), "subpixel");
  EXPECT_EQ(config->text("e"), "0.9,1,1.1");
  EXPECT_TRUE(config->finish().error().why.find("unknown key 'f'") != std::string::npos);
  EXPECT_EQ(config->text("f"), "");
  EXPECT_FALSE(config->finish());
}

TEST(Config, ListsOfStrings) {
  auto config = Config::parse("kinds = [\"gear\", \"label\"]\nmixed = [\"gear\", 1]\n", "t.toml");
  ASSERT_TRUE(config);
  EXPECT_EQ(config->strings_or("kinds", {}), (std::vector<std::string>{"gear", "label"}));
  EXPECT_EQ(config->strings_or("missing", {"x"}), std::vector<std::string>{"x"});
  EXPECT_FALSE(config->strings_or("mixed", {}).size());
  EXPECT_EQ(config->finish().error().why, "'mixed' must be a list of strings");
}

}  // namespace
}  // namespace pickcell::core
