#include "pickcell/sim/world.hpp"

#include <gtest/gtest.h>

#include <thread>

#include "pickcell/core/units.hpp"

namespace pickcell::sim {
namespace {

using core::Base;
using core::duration_s;
using core::Part;
using core::TimePoint;
using core::Tool;
using core::Transform;

TimePoint at_s(double s) { return TimePoint(duration_s(s)); }

/// A displacement in the part's frame: mm, mm, mm up, degrees about the part's z.
Transform<Part, Part> offset(double x_mm, double y_mm, double z_mm, double deg) {
  return {core::rotation_z(core::rad_from_deg(deg)), Eigen::Vector3d(x_mm, y_mm, z_mm) * 1e-3};
}

const TaughtGrasp& grasp_of(const PartTruth& part) { return part_kind(part.kind).grasps.front(); }

/// The tool at the part's first grasp, off by the given displacement about the grasp point.
Transform<Base, Tool> tool_at(const PartTruth& part, double x_mm, double y_mm, double z_mm, double deg) {
  const TaughtGrasp& g = grasp_of(part);
  const Transform<Part, Part> to_grasp = offset(g.x_mm, g.y_mm, 0, 0);
  return part.T_base_part * to_grasp * offset(x_mm, y_mm, z_mm, deg) * to_grasp.inverse() * grasp_pose(g);
}

Transform<Base, Tool> over_tray(double z_m) {
  Eigen::Matrix3d down;
  down << 1, 0, 0, 0, -1, 0, 0, 0, -1;
  return {core::rotation_z(0.4) * down, {0.1, 0.5, z_m}};
}

bool takes(double x_mm, double y_mm, double z_mm, double deg) {
  World world(default_world(4));
  const TimePoint t = at_s(1);
  const PartTruth part = world.parts(t).front();
  world.output_changed(kGripperOutput, true, tool_at(part, x_mm, y_mm, z_mm, deg), t);
  EXPECT_EQ(world.input(kGripSensorInput, t), world.held().has_value());
  EXPECT_EQ(world.counts(t).taken + world.counts(t).empty, 1);
  return world.held().has_value();
}

TEST(Gripper, TakesWithinItsTolerancesOnly) {
  EXPECT_TRUE(takes(0, 0, 0, 0));
  for (const double a : {0.0, 1.1, 2.9, 4.4}) {
    const double c = std::cos(a), s = std::sin(a);
    EXPECT_TRUE(takes(2.9 * c, 2.9 * s, 0, 0));
    EXPECT_FALSE(takes(3.1 * c, 3.1 * s, 0, 0));
  }
  EXPECT_TRUE(takes(0, 0, 0, 4.9));
  EXPECT_FALSE(takes(0, 0, 0, 5.1));
  EXPECT_TRUE(takes(0, 0, 0, -4.9));
  EXPECT_FALSE(takes(0, 0, 0, -5.1));
  EXPECT_TRUE(takes(0, 0, 0, 180 - 4.9));  // two fingers
  EXPECT_FALSE(takes(0, 0, 0, 90));
  EXPECT_TRUE(takes(0, 0, 3.9, 0));
  EXPECT_FALSE(takes(0, 0, 4.1, 0));
  EXPECT_FALSE(takes(0, 0, -4.1, 0));
  EXPECT_TRUE(takes(2, 2, 2, 4));
}

TEST(Gripper, ClosesOnNothingBesideThePart) {
  World world(default_world(4));
  world.output_changed(kGripperOutput, true, over_tray(0.02), at_s(0));
  EXPECT_FALSE(world.input(kGripSensorInput, at_s(0)));
  EXPECT_EQ(world.counts(at_s(0)).empty, 1);
  world.output_changed(kGripperOutput, false, over_tray(0.02), at_s(1));
  EXPECT_EQ(world.counts(at_s(1)).placed + world.counts(at_s(1)).dropped, 0);
}

TEST(Gripper, KeepsTheOffsetThePartHad) {
  World world(default_world(5));
  const PartTruth part = world.parts(at_s(0)).front();
  const std::size_t before = world.parts(at_s(0)).size();
  const Transform<Base, Tool> there = tool_at(part, 1.2, -0.8, 0.5, 2.5);
  world.output_changed(kGripperOutput, true, there, at_s(1));
  EXPECT_EQ(world.parts(at_s(1)).size(), before - 1);
  const double z = 0.01 + part_kind(part.kind).height_mm * 1e-3;
  world.output_changed(kGripperOutput, false, over_tray(z), at_s(3));
  ASSERT_EQ(world.placed().size(), 1U);
  const PlacedPart placed = world.placed()[0];
  EXPECT_EQ(placed.kind, part.kind);
  EXPECT_EQ(placed.id, part.id);
  EXPECT_EQ(placed.picked, at_s(1));
  EXPECT_EQ(placed.placed, at_s(3));
  const Transform<Base, Part> expected = over_tray(z) * (there.inverse() * part.T_base_part);
  EXPECT_TRUE(placed.T_base_part.iso().isApprox(expected.iso(), 1e-12));

  // Against the place that a tool without any offset would have reached: exactly the offset of the grasp.
  const WantedPlace wanted{part.kind, over_tray(z) * grasp_pose(grasp_of(part)).inverse()};
  const auto error = place_error(placed, std::vector{wanted});
  ASSERT_TRUE(error);
  EXPECT_NEAR(error->deg, 2.5, 1e-9);
  EXPECT_GT(error->mm, 1.0);
}

TEST(Gripper, LetsGoInTheAirOrInTheFloor) {
  for (const double z : {0.2, 0.0}) {
    World world(default_world(5));
    const PartTruth part = world.parts(at_s(0)).front();
    world.output_changed(kGripperOutput, true, tool_at(part, 0, 0, 0, 0), at_s(1));
    world.output_changed(kGripperOutput, false, over_tray(z), at_s(2));
    EXPECT_EQ(world.counts(at_s(2)).dropped, 1) << z;
    EXPECT_TRUE(world.placed().empty());
    EXPECT_FALSE(world.input(kGripSensorInput, at_s(2)));
  }
}

TEST(Gripper, PutsBackOnTheBelt) {
  World world(default_world(6));
  const PartTruth part = world.parts(at_s(0)).front();
  world.output_changed(kGripperOutput, true, tool_at(part, 0.5, 0, 0, 1), at_s(1));
  world.output_changed(kGripperOutput, false, tool_at(part, 3.5, 0, 0, 1), at_s(2));
  EXPECT_EQ(world.counts(at_s(2)).returned, 1);
  EXPECT_TRUE(world.placed().empty());
  const PartTruth back = world.parts(at_s(2)).back();
  EXPECT_EQ(back.id, part.id);
  EXPECT_NEAR(core::mm_from_m((back.T_base_part.translation_m() - part.T_base_part.translation_m()).norm()), 3, 0.02);
  world.output_changed(kGripperOutput, true, tool_at(back, 0, 0, 0, 0), at_s(3));
  EXPECT_TRUE(world.input(kGripSensorInput, at_s(3)));
}

TEST(Belt, MovesOnePitchPerRisingEdge) {
  WorldSettings settings = default_world(7);
  settings.feed.pitch_mm = 180, settings.feed.speed_mm_s = 250;
  World world(settings);
  const PartTruth first = world.parts(at_s(0)).front();
  const auto x_mm = [&](double t) {  // along the belt, of the first part
    for (const auto& [id, laid] : world.view(at_s(t)).parts)
      if (id == first.id) return laid.at_mm.x();
    return 1e9;
  };
  const double x0 = x_mm(0);
  EXPECT_FALSE(world.input(kFeedMovingInput, at_s(1)));
  world.contact_written(kFeedAdvanceContact, true, at_s(1));
  EXPECT_TRUE(world.input(kFeedMovingInput, at_s(1)));
  EXPECT_NEAR(x_mm(1.36), x0 + 90, 1e-6);
  world.contact_written(kFeedAdvanceContact, false, at_s(1.4));
  world.contact_written(kFeedAdvanceContact, true, at_s(1.5));  // while it moves: nobody waits for it
  EXPECT_TRUE(world.input(kFeedMovingInput, at_s(1.719)));
  EXPECT_FALSE(world.input(kFeedMovingInput, at_s(1.721)));
  world.contact_written(kFeedAdvanceContact, true, at_s(2));  // no edge
  EXPECT_FALSE(world.input(kFeedMovingInput, at_s(2)));
  EXPECT_NEAR(x_mm(2), x0 + 180, 1e-6);
  EXPECT_NEAR(world.belt_mm(at_s(2)), 180, 1e-9);
}

TEST(Belt, BringsNewPartsAndCountsTheMissed) {
  World world(default_world(8));
  const int at_first = static_cast<int>(world.parts(at_s(0)).size());
  EXPECT_GE(at_first, 5);
  int seen = 0;
  for (int i = 0; i < 12; ++i) {
    world.contact_written(kFeedAdvanceContact, true, at_s(2 * i + 1));
    world.contact_written(kFeedAdvanceContact, false, at_s(2 * i + 1.5));
    const WorldView view = world.view(at_s(2 * i + 2.5));
    int inside = 0;
    for (const auto& [id, laid] : view.parts) {
      seen = std::max(seen, static_cast<int>(id));
      const Box2 box = extent_mm(laid), &area = world.settings().feed.area_mm;
      inside += (box.lo.array() >= area.lo.array() - 0.1).all() && (box.hi.array() <= area.hi.array() + 0.1).all();
    }
    EXPECT_GE(inside, 4) << "no work after pitch " << i;
    EXPECT_EQ(seen - world.counts(at_s(2 * i + 2.5)).missed, inside);  // all others have left
  }
  EXPECT_GT(seen, 40);
}

TEST(Belt, LaysPartsApart) {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    World world(default_world(seed));
    world.contact_written(kFeedAdvanceContact, true, at_s(1));
    const WorldView view = world.view(at_s(3));
    for (std::size_t i = 0; i < view.parts.size(); ++i)
      for (std::size_t k = 0; k < i; ++k)
        EXPECT_GE(std::max(gap_mm(view.parts[i].second, view.parts[k].second),
                           gap_mm(view.parts[k].second, view.parts[i].second)),
                  world.settings().feed.gap_mm - 1);
  }
}

TEST(Table, IsLaidAnewOnRequest) {
  WorldSettings settings = default_world(9);
  settings.feed.supply = Supply::table;
  World world(settings);
  const int before = static_cast<int>(world.parts(at_s(0)).size());
  world.contact_written(kFeedAdvanceContact, true, at_s(1));
  EXPECT_TRUE(world.input(kFeedMovingInput, at_s(1.5)));
  EXPECT_TRUE(world.parts(at_s(1.5)).empty());
  EXPECT_FALSE(world.input(kFeedMovingInput, at_s(2.1)));
  EXPECT_GE(world.parts(at_s(2.1)).size(), 5U);
  EXPECT_EQ(world.counts(at_s(2.1)).missed, before);
  EXPECT_EQ(world.belt_mm(at_s(3)), 0);
}

TEST(World, FollowsFromItsSeed) {
  const auto fingerprint = [](std::uint64_t seed) {
    World world(default_world(seed));
    world.contact_written(kFeedAdvanceContact, true, at_s(1));
    std::string text;
    for (const PartTruth& p : world.parts(at_s(2)))
      text +=
          p.kind + std::to_string(p.T_base_part.translation_m().x()) + std::to_string(p.T_base_part.rotation()(0, 0));
    return text;
  };
  EXPECT_EQ(fingerprint(3), fingerprint(3));
  EXPECT_NE(fingerprint(3), fingerprint(4));
}

TEST(World, RefusesImpossibleSettings) {
  WorldSettings settings = default_world(1);
  settings.feed.kinds = {"spoon"};
  EXPECT_THROW(World{settings}, std::invalid_argument);
  settings.feed.kinds = {};
  EXPECT_THROW(World{settings}, std::invalid_argument);
  settings = default_world(1);
  settings.feed.speed_mm_s = 0;
  EXPECT_THROW(World{settings}, std::invalid_argument);
}

TEST(World, ManyThreadsMayAsk) {
  World world(default_world(2));
  std::vector<std::thread> threads;
  for (int i = 0; i < 3; ++i)
    threads.emplace_back([&world, i] {
      for (int k = 0; k < 30; ++k) {
        world.contact_written(kFeedAdvanceContact, k % 2 == 0, at_s(k));
        (void)world.input(kFeedMovingInput, at_s(k));
        world.output_changed(kGripperOutput, k % 3 == i, over_tray(0.02), at_s(k));
        EXPECT_LE(world.view(at_s(k)).parts.size(), 40U);
      }
    });
  for (std::thread& t : threads) t.join();
}

TEST(PlaceError, IsThatOfTheNearestPlaceOfTheKind) {
  const auto pose = [](double x_mm, double y_mm, double deg) {
    return Transform<Base, Part>(core::rotation_z(core::rad_from_deg(deg)), Eigen::Vector3d(x_mm, y_mm, 0) * 1e-3);
  };
  const std::vector<WantedPlace> wanted{{"a", pose(0, 0, 0)}, {"a", pose(100, 0, 179)}, {"b", pose(101, 0, 0)}};
  const auto error = place_error({1, "a", pose(100.3, 0.4, -179), {}, {}}, wanted);
  ASSERT_TRUE(error);
  EXPECT_EQ(error->slot, 1U);
  EXPECT_NEAR(error->mm, 0.5, 1e-9);
  EXPECT_NEAR(error->deg, 2, 1e-9);
  EXPECT_FALSE(place_error({1, "c", pose(0, 0, 0), {}, {}}, wanted));
}

}  // namespace
}  // namespace pickcell::sim
