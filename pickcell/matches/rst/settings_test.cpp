#include "pickcell/matches/rst/settings.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <string>

namespace pickcell::matches {
namespace {

TEST(RstSettings, ReadsEveryKeyAndNamesWhatItDoesNotKnow) {
  const auto s =
      parse_rst_settings({{"t1", "0.9"}, {"scales", "1.1,0.9,1"}, {"NP", "2"}, {"refine", "subpixel"}}, "rst");
  ASSERT_TRUE(s);
  EXPECT_EQ(s->t1, 0.9);
  EXPECT_EQ(*s->scales, (std::vector<double>{0.9, 1, 1.1}));
  EXPECT_EQ(*s->pyramid_level, 2);
  EXPECT_TRUE(s->refine_subpixel);
  for (const Settings& bad :
       {Settings{{"t1", "high"}}, Settings{{"alpha", "7"}}, Settings{{"scales", "1,,2"}}, Settings{{"scales", "1,1"}},
        Settings{{"NP", "1.5"}}, Settings{{"mask", "square"}}, Settings{{"scales", ""}}, Settings{{"NC", "2"}}})
    EXPECT_FALSE(parse_rst_settings(bad, "rst")) << bad.begin()->first << "=" << bad.begin()->second;
  const auto unknown = parse_rst_settings({{"t_1", "0.9"}}, "erst");
  ASSERT_FALSE(unknown);
  EXPECT_NE(unknown.error().line().find("engine erst"), std::string::npos);
}

TEST(RstSettings, PaperDefaults) {
  const RstSettings s;
  EXPECT_EQ(s.circles, 10);
  EXPECT_EQ(s.angle_step_deg, 10);
  EXPECT_EQ(s.t1, 0.84);
  EXPECT_EQ(s.t2, 0.7);
  EXPECT_EQ(s.t3, 0.7);
  // Nothing beyond the paper is on.
  EXPECT_FALSE(s.refine_subpixel);
  EXPECT_FALSE(s.match_negative);
  EXPECT_FALSE(s.t4 || s.scales || s.scale_count || s.pyramid_level);
  EXPECT_EQ(s.smooth, 1);
  EXPECT_EQ(s.step3_tolerance, 0);
  EXPECT_EQ(s.suppress_px, 0);
  EXPECT_EQ(s.t_contrast, 0);
  EXPECT_EQ(s.t_brightness, 1);
  EXPECT_EQ(s.radial_length, RadialLength::largest);
  EXPECT_EQ(s.mask, WindowMask::rect);
  EXPECT_EQ(s.location, LocationSearch::halving);
  EXPECT_EQ(pyramid_level_for(60, 60), 1);
  EXPECT_EQ(pyramid_level_for(130, 130), 2);
  EXPECT_EQ(pyramid_level_for(250, 250), 3);
  EXPECT_EQ(pyramid_level_for(40, 40), 1);
  EXPECT_EQ(pyramid_level_for(99, 99), 1);
  EXPECT_EQ(pyramid_level_for(100, 100), 2);
  EXPECT_EQ(pyramid_level_for(199, 199), 2);
  EXPECT_EQ(pyramid_level_for(200, 200), 3);
  EXPECT_EQ(pyramid_level_for(250, 64), 2);  // as large as 126 x 126
}

TEST(RstSettings, ScalesFollowTheRange) {
  EXPECT_EQ(scales_for({1, 1}, {}), (std::vector<double>{1}));
  EXPECT_EQ(scales_for({0.9, 1.1}, {}), (std::vector<double>{0.9, 1, 1.1}));
  const auto s = scales_for({0.8, 1.25}, {});  // ln(1.5625) / ln 1.12 = 3.94
  ASSERT_EQ(s.size(), 5u);
  EXPECT_NEAR(s[1] / s[0], s[4] / s[3], 1e-12);
  EXPECT_EQ(s.front(), 0.8);
  EXPECT_NEAR(s.back(), 1.25, 1e-12);
}

/// Every value that was accepted lies in the range that its refusals name.
void expect_in_range(const RstSettings& s) {
  EXPECT_TRUE(!s.pyramid_level || (*s.pyramid_level >= 0 && *s.pyramid_level <= 5));
  EXPECT_TRUE(!s.scale_count || (*s.scale_count >= 1 && *s.scale_count <= 32));
  if (s.scales) {
    ASSERT_TRUE(!s.scales->empty() && s.scales->size() <= 32);
    EXPECT_TRUE(std::is_sorted(s.scales->begin(), s.scales->end()));
    EXPECT_EQ(std::adjacent_find(s.scales->begin(), s.scales->end()), s.scales->end());
    EXPECT_GE(s.scales->front(), 0.1);
    EXPECT_LE(s.scales->back(), 10);
  }
  EXPECT_TRUE(s.smooth >= 0 && s.smooth <= 8);
  EXPECT_TRUE(s.circles >= 3 && s.circles <= 64);
  EXPECT_TRUE(s.angle_step_deg >= 1 && s.angle_step_deg <= 90 && 360 % s.angle_step_deg == 0);
  for (const double t : {s.t1, s.t2, s.t3, s.t4.value_or(0)}) EXPECT_TRUE(t >= -1 && t <= 1);
  EXPECT_TRUE(s.step3_tolerance == 0 || s.step3_tolerance == 1);
  EXPECT_TRUE(s.suppress_px >= 0 && s.suppress_px <= 100);
  EXPECT_TRUE(s.t_contrast >= 0 && s.t_contrast <= 1 && s.t_brightness >= 0 && s.t_brightness <= 1);
  EXPECT_TRUE(s.min_inside >= 0.3 && s.min_inside <= 1);
}

TEST(RstSettings, RandomTextIsReadWithinRangeOrRefusedInOneLine) {
  const std::vector<std::string> keys{"NP",
                                      "NS",
                                      "scales",
                                      "smooth",
                                      "NC",
                                      "alpha",
                                      "t1",
                                      "t2",
                                      "t3",
                                      "t4",
                                      "mask",
                                      "radial_length",
                                      "t_contrast",
                                      "suppress",
                                      "location",
                                      "match_negative",
                                      "",
                                      "step3_tolerance",
                                      "min_inside",
                                      "refine",
                                      "pyramid",
                                      "N P",
                                      "t_brightness",
                                      "T1"};
  const std::vector<std::string> pieces{
      "0",     "1",   "0.9", ",", "-",    ".",    "e",  "9",    "inf",     "nan",
      "1e308", "10",  "360", " ", "rect", "\n",   "\t", "true", "largest", "\x80",
      "+",     "0x1", "36",  "2", "5",    "none", "",   "",     "disc",    std::string(3, '\0')};
  std::mt19937 rng(31);
  int read = 0, refused = 0;
  for (int i = 0; i < 20000; ++i) {
    Settings settings;
    for (unsigned k = 0; k <= rng() % 2; ++k) {
      std::string text;
      for (unsigned n = 0; n <= rng() % 4; ++n) text += pieces[rng() % pieces.size()];
      if (rng() % 500 == 0) text.assign(100000, '9');
      settings[keys[rng() % keys.size()]] = text;
    }
    const auto s = parse_rst_settings(settings, "rst");
    if (s) {
      ++read;
      expect_in_range(*s);
    } else {
      ++refused;
      const std::string line = s.error().line();
      EXPECT_EQ(s.error().code, core::ErrorCode::usage);
      EXPECT_TRUE(line.starts_with("setting ")) << line;
      EXPECT_LT(line.size(), 500u);
      EXPECT_FALSE(s.error().remedy.empty()) << line;
      EXPECT_TRUE(std::none_of(line.begin(), line.end(), [](char c) { return c >= 0 && c < ' '; })) << line;
    }
  }
  EXPECT_GT(read, 200);
  EXPECT_GT(refused, 5000);
}

TEST(RstSettings, ARefusalSaysWhatWouldDo) {
  const auto line = [](const std::string& key, const std::string& text) {
    const auto s = parse_rst_settings({{key, text}}, "rst");
    return s ? std::string("accepted") : s.error().line();
  };
  EXPECT_EQ(line("t1", "nan"), "setting t1: \"nan\" is not allowed; use a number from -1 to 1");
  EXPECT_EQ(line("alpha", "7"),
            "setting alpha: \"7\" is not allowed; use a whole number of degrees that divides 360, from 1 to 90");
  EXPECT_EQ(line("mask", "square"), "setting mask: \"square\" is not allowed; use rect or disc");
  EXPECT_TRUE(line("NPP", "1").starts_with("setting NPP: engine rst does not know it; did you mean NP? known: NP, "));
}

}  // namespace
}  // namespace pickcell::matches
