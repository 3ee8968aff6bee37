/// What engine best promises about a search as a whole: threads, budget, several models, parts at the border.

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "pickcell/matches/best/engine.hpp"
#include "pickcell/matches/fit/match_score.hpp"
#include "pickcell/matches/test_scenes.hpp"

namespace pickcell::matches {
namespace {

using testing::Texture;

/// Two kinds of parts, five in all, under noise.
struct Tray {
  Texture first_texture{70, 54, 2}, second_texture{60, 60, 9};
  Model first = testing::texture_model(first_texture, 70, 54), second = testing::texture_model(second_texture, 60, 60);
  std::vector<Pose2d> firsts{{80, 70, 20, 1.02}, {230, 90, -130, 0.95}, {120, 190, 77, 1.05}};
  std::vector<Pose2d> seconds{{240, 190, 10, 1}, {330, 120, 95, 0.97}};
  image::Image picture = testing::draw_ground(400, 260, 5);
  image::Pyramid pyramid;

  Tray() {
    for (const Pose2d& p : firsts) testing::draw_part(picture, first_texture, first, p);
    for (const Pose2d& p : seconds) testing::draw_part(picture, second_texture, second, p);
    testing::add_noise(picture, 4, 1);
    pyramid.build(picture.view());
    first.learnt.suggested_min_score = second.learnt.suggested_min_score = 0.6;
  }
  [[nodiscard]] std::vector<const Model*> models() const { return {&first, &second}; }
};

TEST(BestSearch, SeveralModelsInOneCall) {
  const Tray tray;
  SearchOptions options;
  options.max_matches = 20;
  BestEngine engine;
  const auto found = engine.find(tray.pyramid, tray.models(), options);
  ASSERT_TRUE(found);
  EXPECT_EQ(found->matches.size(), 5u);
  for (int kind = 0; kind < 2; ++kind)
    for (const Pose2d& truth : kind == 0 ? tray.firsts : tray.seconds) {
      const auto n = std::count_if(found->matches.begin(), found->matches.end(), [&](const Match& m) {
        return m.model_index == kind && testing::distance_px(m.pose, truth) < 0.2 &&
               testing::turn_deg(m.pose, truth) < 0.3;
      });
      EXPECT_EQ(n, 1) << "kind " << kind << " at " << truth.x_px << ", " << truth.y_px;
    }
}

TEST(BestSearch, SameBitsWithAnyNumberOfThreads) {
  const Tray tray;
  for (const int most : {1, 20}) {
    SearchOptions options;
    options.max_matches = most;
    options.explain = true;
    std::vector<Match> first;
    for (const int threads : {1, 2, 3, 7}) {
      options.threads = threads;
      BestEngine engine;
      const auto found = engine.find(tray.pyramid, tray.models(), options);
      ASSERT_TRUE(found);
      std::vector<Match> all = found->matches;
      for (const Rejected& r : found->rejected) all.push_back(r.match);
      if (threads == 1) first = all;
      ASSERT_EQ(all.size(), first.size()) << threads;
      for (std::size_t i = 0; i < all.size(); ++i) {
        EXPECT_EQ(all[i].pose.x_px, first[i].pose.x_px);
        EXPECT_EQ(all[i].pose.y_px, first[i].pose.y_px);
        EXPECT_EQ(all[i].pose.angle_deg, first[i].pose.angle_deg);
        EXPECT_EQ(all[i].pose.scale, first[i].pose.scale);
        EXPECT_EQ(all[i].score, first[i].score);
        EXPECT_EQ(all[i].covariance, first[i].covariance);
      }
    }
  }
}

/// A clock that advances by one with each look: the engine must stop soon after the limit, whatever the machine.
TEST(BestSearch, ABudgetIsCountedInWork) {
  const Tray tray;
  const Texture other(64, 64, 77);
  const Model absent = testing::texture_model(other, 64, 64);
  const Model* one[] = {&absent};
  long looks = 0;
  BestEngine engine({}, [&] { return static_cast<double>(++looks); });
  SearchOptions options;
  options.budget_ms = 1e9;
  auto found = engine.find(tray.pyramid, one, options);
  ASSERT_TRUE(found);
  EXPECT_TRUE(found->complete);
  const long all = looks;
  for (const double budget : {5.0, 0.3 * static_cast<double>(all), 0.8 * static_cast<double>(all)}) {
    looks = 0;
    options.budget_ms = budget;
    found = engine.find(tray.pyramid, one, options);
    ASSERT_TRUE(found);
    EXPECT_FALSE(found->complete) << budget;
    EXPECT_LE(static_cast<double>(looks), budget + 3) << "of " << all;
  }
}

/// Too little for the coarse field, then for a candidate: nothing is found, and no more is done.
TEST(BestSearch, ABudgetMayEndBeforeAnythingIsFound) {
  const Tray tray;
  long looks = 0;
  for (const int most : {1, 20}) {
    BestEngine engine({}, [&] { return static_cast<double>(++looks); });
    for (const double budget : {0.5, 1.0, 3.0}) {
      looks = 0;
      SearchOptions options;
      options.budget_ms = budget;
      options.max_matches = most;
      const auto found = engine.find(tray.pyramid, tray.models(), options);
      ASSERT_TRUE(found);
      EXPECT_FALSE(found->complete);
      EXPECT_TRUE(found->matches.empty()) << budget;
      EXPECT_LE(looks, 8) << budget;
    }
  }
}

/// Found while 70 % are in the picture; turned down because of the border below that, never for another reason. The
/// answer is the same whether it is explained or not.
TEST(BestSearch, PartsAtTheBorder) {
  for (const unsigned seed : {12u, 30u}) {
    const Texture texture(80, 64, seed);
    const Model model = testing::texture_model(texture, 80, 64);
    const Model* one[] = {&model};
    for (const double visible : {0.9, 0.76, 0.6}) {
      const Pose2d truth{(visible - 0.5) * 80, 120, 0, 1};
      image::Image picture = testing::draw_ground(320, 240, 5);
      testing::draw_part(picture, texture, model, truth);
      image::Pyramid pyramid;
      pyramid.build(picture.view());
      SearchOptions options;
      BestEngine engine;
      const auto plain = engine.find(pyramid, one, options);
      options.explain = true;
      const auto found = engine.find(pyramid, one, options);
      ASSERT_TRUE(plain && found);
      ASSERT_EQ(found->matches.size(), plain->matches.size());
      if (visible > 0.7) {
        ASSERT_EQ(found->matches.size(), 1u) << visible;
        EXPECT_LT(testing::distance_px(found->matches[0].pose, truth), 0.3) << visible;
        EXPECT_EQ(found->matches[0].pose.x_px, plain->matches[0].pose.x_px);
      } else {
        EXPECT_TRUE(found->matches.empty());
        EXPECT_TRUE(std::any_of(found->rejected.begin(), found->rejected.end(),
                                [&](const Rejected& r) {
                                  return r.reason == RejectReason::border &&
                                         testing::distance_px(r.match.pose, truth) < 2;
                                }))
            << "seed " << seed;
      }
    }
  }
}

/// The share of a part's rectangle that lies in the picture.
double share_inside(int part_width, int part_height, const Pose2d& pose, const image::Image& picture) {
  const double c = pose.scale * std::cos(pose.angle_deg / kDegPerRad);
  const double s = pose.scale * std::sin(pose.angle_deg / kDegPerRad);
  int inside = 0;
  for (int i = 0; i < 50; ++i)
    for (int j = 0; j < 50; ++j) {
      const double u = ((i + 0.5) / 50 - 0.5) * part_width, v = ((j + 0.5) / 50 - 0.5) * part_height;
      const double x = pose.x_px + c * u + s * v, y = pose.y_px - s * u + c * v;
      inside += x > -0.5 && y > -0.5 && x < picture.width() - 0.5 && y < picture.height() - 0.5 ? 1 : 0;
    }
  return inside / 2500.0;
}

/// Pushed out of the picture at any turn, in any direction, until 71 to 89 % are left: found, or turned down because of
/// the border, in a search for one and for several.
TEST(BestSearch, PartsThatTheBorderCuts) {
  std::mt19937 rng(8);
  std::uniform_real_distribution<double> of_one(0, 1);
  int found = 0, named = 0, all = 0;
  for (unsigned seed = 1; seed <= 12; ++seed) {
    const int width = 34 + 2 * static_cast<int>(seed), height = 46;
    const Texture texture(width, height, seed);
    Model model = testing::texture_model(texture, width, height);
    model.learnt.suggested_min_score = 0.65;
    const Model* one[] = {&model};
    image::Image picture = testing::draw_ground(480, 360, seed + 70);
    const double least = 0.71 + 0.18 * of_one(rng), way = 2 * std::numbers::pi * of_one(rng);
    Pose2d truth{240, 180, 360 * of_one(rng) - 180, 0.92 + 0.16 * of_one(rng)};
    while (share_inside(width, height, truth, picture) > least) {
      truth.x_px += 0.25 * std::cos(way);
      truth.y_px += 0.25 * std::sin(way);
    }
    testing::draw_part(picture, texture, model, truth);
    testing::add_noise(picture, 4, seed);
    image::Pyramid pyramid;
    pyramid.build(picture.view());
    for (const int most : {1, 8}) {
      SearchOptions options;
      options.max_matches = most;
      options.explain = true;
      BestEngine engine;
      const auto result = engine.find(pyramid, one, options);
      ASSERT_TRUE(result);
      const auto there = [&](const Match& m) {
        return testing::distance_px(m.pose, truth) < 1 && testing::turn_deg(m.pose, truth) < 2;
      };
      const bool match = std::any_of(result->matches.begin(), result->matches.end(), there);
      found += match ? 1 : 0;
      named +=
          !match && std::any_of(result->rejected.begin(), result->rejected.end(),
                                [&](const Rejected& r) { return r.reason == RejectReason::border && there(r.match); })
              ? 1
              : 0;
      ++all;
    }
  }
  EXPECT_GE(found + named, all - 1) << found << " found, " << named << " named";
  EXPECT_GE(found, all - 4);
}

/// Judged anew where the match says it is, every match has the score it states.
TEST(BestSearch, TheScoreBelongsToTheReportedPose) {
  const Tray tray;
  SearchOptions options;
  options.max_matches = 20;
  options.min_score = 0.3;
  BestEngine engine;
  const auto found = engine.find(tray.pyramid, tray.models(), options);
  ASSERT_TRUE(found);
  ASSERT_GE(found->matches.size(), 5u);
  const BestSettings settings;
  const std::vector<BestModel> models{prepare_model(tray.first, tray.first.scale, settings),
                                      prepare_model(tray.second, tray.second.scale, settings)};
  BestScene scene;
  scene.start(tray.pyramid);
  RefineScratch scratch;
  for (const Match& m : found->matches) {
    const BestModel& model = models[static_cast<std::size_t>(m.model_index)];
    const Similarity place = similarity_of(m.pose, model.ref_dx, model.ref_dy);
    const Hypothesis there = evaluate(scene.level(0), model.levels[0], place, scratch);
    const double score = match_score(scene.level(0), model.levels[0], there, scratch);
    EXPECT_NEAR(std::clamp(score, 0.0, 1.0), m.score, 1e-4) << m.pose.x_px << ", " << m.pose.y_px;
  }
}

/// Covers a third of the part at x, y: what is left scores too little to be sure of.
void cover_third(image::Image& picture, int x, int y) {
  for (int v = y - 30; v < y + 30; ++v)
    for (int u = x + 8; u < x + 40; ++u) picture.at(u, v) = static_cast<std::uint8_t>(90 + 40 * ((u / 5 + v / 7) % 2));
}

/// Of one part: its score rises when nothing else in the picture comes near, and does not when its like lies beside it.
TEST(BestSearch, APartThatStandsOutScoresHigher) {
  const Texture texture(70, 54, 2);
  const Model part = testing::texture_model(texture, 70, 54);
  const Model* const one[] = {&part};
  for (const bool pair : {false, true}) {
    image::Image picture = testing::draw_ground(320, 200, 5);
    for (const int x : {90, 220}) {
      if (x == 220 && !pair) continue;
      testing::draw_part(picture, texture, part, {static_cast<double>(x), 100, 0, 1});
      cover_third(picture, x, 100);
    }
    testing::add_noise(picture, 6, 1);
    image::Pyramid pyramid;
    pyramid.build(picture.view());
    BestEngine engine;
    SearchOptions options;
    options.min_score = 0.2;
    const auto single = engine.find(pyramid, one, options);
    options.max_matches = 5;
    const auto several = engine.find(pyramid, one, options);
    ASSERT_TRUE(single && several);
    ASSERT_EQ(single->matches.size(), 1u);
    ASSERT_GE(several->matches.size(), 1u);
    EXPECT_LT(std::abs(single->matches[0].pose.y_px - 100), 2);
    if (pair)
      EXPECT_LT(single->matches[0].score, several->matches[0].score);
    else
      EXPECT_GT(single->matches[0].score, several->matches[0].score + 0.01);
  }
}

/// From places around the true one, at every level: never a lower score than at the start; at the end no further from
/// the truth.
TEST(BestSearch, RefinementNeverMakesAPlaceWorse) {
  const Tray tray;
  const BestModel model = prepare_model(tray.first, tray.first.scale, {});
  BestScene scene;
  scene.start(tray.pyramid);
  RefineScratch scratch;
  std::mt19937 rng(3);
  std::uniform_real_distribution<double> off(-1.5, 1.5);
  for (const Pose2d& truth : tray.firsts)
    for (int i = 0; i < 15; ++i) {
      const Pose2d start{truth.x_px + off(rng), truth.y_px + off(rng), truth.angle_deg + off(rng),
                         truth.scale * (1 + 0.01 * off(rng))};
      const Similarity place = similarity_of(start, model.ref_dx, model.ref_dy);
      const auto far = [&](const Hypothesis& h) {
        return testing::distance_px(pose_of(h.place, model.ref_dx, model.ref_dy), truth);
      };
      for (int l = 0; l < static_cast<int>(model.levels.size()); ++l) {
        const LevelModel& level = model.levels[static_cast<std::size_t>(l)];
        const Hypothesis before = evaluate(scene.level(l), level, place, scratch);
        EXPECT_GE(climb(scene.level(l), level, place, model.scale, 3, scratch).score, before.score) << l;
      }
      const Hypothesis before = evaluate(scene.level(0), model.levels[0], place, scratch);
      const Hypothesis settled = settle(scene.level(0), model.levels[0], place, model.scale, scratch);
      const Hypothesis polished = polish(scene.level(0), model.levels[0], settled, model.scale, scratch);
      EXPECT_TRUE(settled.score >= before.score || settled.ncc >= before.ncc);
      EXPECT_LE(far(settled), std::max(0.05, far(before)));
      EXPECT_LE(far(polished), std::max(0.05, far(settled)));
    }
}

/// An L of one grey, without anything inside: its model is cut on dark ground, the scene shows it on another.
bool in_flat_part(double x, double y) { return x >= 8 && y >= 8 && x < 62 && y < 78 && (x < 28 || y >= 58); }

void draw_flat_part(image::Image& scene, const Pose2d& pose) {
  const double c = pose.scale * std::cos(pose.angle_deg / kDegPerRad);
  const double s = pose.scale * std::sin(pose.angle_deg / kDegPerRad);
  const double size2 = pose.scale * pose.scale;
  for (int y = 0; y < scene.height(); ++y)
    for (int x = 0; x < scene.width(); ++x) {
      int inside = 0;
      for (int k = 0; k < 16; ++k) {
        const double dx = x + (k % 4 + 0.5) / 4 - 0.5 - pose.x_px, dy = y + (k / 4 + 0.5) / 4 - 0.5 - pose.y_px;
        inside += in_flat_part((c * dx - s * dy) / size2 + 34.5, (s * dx + c * dy) / size2 + 42.5) ? 1 : 0;
      }
      scene.at(x, y) = static_cast<std::uint8_t>(scene.at(x, y) + (180 - scene.at(x, y)) * inside / 16);
    }
}

TEST(BestSearch, AFlatPartIsFoundByItsEdges) {
  Model part;
  part.name = "flat";
  part.picture.resize(70, 86);
  part.picture.fill(60);
  draw_flat_part(part.picture, {34.5, 42.5, 0, 1});
  part.mask.resize(70, 86);
  for (int y = 0; y < 86; ++y)
    for (int x = 0; x < 70; ++x) part.mask.at(x, y) = in_flat_part(x, y) ? 255 : 0;
  part.ref_x_px = 34.5;
  part.ref_y_px = 42.5;
  part.scale = {0.9, 1.1};
  part.learnt.suggested_min_score = 0.65;
  const Pose2d truth{171.3, 112.8, 64, 1.04};
  image::Image picture(320, 240);
  picture.fill(110);
  draw_flat_part(picture, truth);
  testing::add_noise(picture, 3, 7);
  image::Pyramid pyramid;
  pyramid.build(picture.view());
  const Model* const one[] = {&part};
  BestEngine engine;
  const auto found = engine.find(pyramid, one, {});
  ASSERT_TRUE(found);
  ASSERT_EQ(found->matches.size(), 1u);
  EXPECT_LT(testing::distance_px(found->matches[0].pose, truth), 0.3);
  EXPECT_LT(testing::turn_deg(found->matches[0].pose, truth), 0.5);
  EXPECT_NEAR(found->matches[0].pose.scale, truth.scale, 0.01);
}

}  // namespace
}  // namespace pickcell::matches
