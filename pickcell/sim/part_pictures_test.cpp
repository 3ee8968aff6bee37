#include "pickcell/sim/part_pictures.hpp"

#include <gtest/gtest.h>

#include <set>

#include "pickcell/core/units.hpp"
#include "pickcell/sim/part_texture.hpp"

namespace pickcell::sim {
namespace {

using core::kPi;

TEST(Shape, AreasFollowTheFormulas) {
  EXPECT_NEAR(area_mm2(circle(10)), kPi * 100, 0.5);
  EXPECT_NEAR(area_mm2(rectangle(30, 20, 4)), 600 - (4 - kPi) * 16, 0.5);
  EXPECT_NEAR(area_mm2(capsule({-5, 0}, {5, 3}, 2)), kPi * 4 + std::hypot(10, 3) * 4, 0.5);
  EXPECT_NEAR(area_mm2(polygon({{0, 0}, {12, 0}, {0, 9}})), 54, 0.3);
  EXPECT_NEAR(area_mm2(cut(circle(22), {circle(9)})), kPi * (484 - 81), 1);
  EXPECT_NEAR(area_mm2(rectangle(10, 4).moved(3, -2, 33)), 40, 0.3);
  EXPECT_NEAR(area_mm2(rectangle(10, 4).grown(1)), 40 + 28 + kPi, 0.3);
}

TEST(Shape, DistanceIsSignedAndExactForPrimitives) {
  EXPECT_DOUBLE_EQ(circle(3).distance({5, 0}), 2);
  EXPECT_DOUBLE_EQ(rectangle(10, 4).distance({0, 0}), -2);
  EXPECT_DOUBLE_EQ(polygon({{0, 0}, {4, 0}, {4, 4}, {0, 4}}).distance({2, 7}), 3);
  EXPECT_NEAR(rectangle(2, 2).moved(10, 0, 45).distance({10, 0}), -1, 1e-12);
}

TEST(Shape, LetteringRefusesWhatItCannotWrite) {
  EXPECT_NO_THROW((void)lettering("A-1/2.", 5, 1));
  EXPECT_THROW((void)lettering("a", 5, 1), std::invalid_argument);
  EXPECT_THROW((void)lettering("  ", 5, 1), std::invalid_argument);
}

TEST(Catalogue, HoldsDifferentPartsOfCredibleSize) {
  std::set<std::string> names, families;
  for (const PartKind& kind : part_catalogue()) {
    names.insert(kind.name);
    families.insert(kind.family);
    const Point2 size = kind.outline.bounds().size();
    EXPECT_GE(size.maxCoeff(), 30) << kind.name;
    EXPECT_LE(size.maxCoeff(), 81) << kind.name;
    EXPECT_GE(kind.height_mm, 5) << kind.name;
    EXPECT_LE(kind.height_mm, 20) << kind.name;
    EXPECT_FALSE(kind.grasps.empty()) << kind.name;
    for (const Mark& mark : kind.marks)  // print and engraving stay on the part
      EXPECT_LT(kind.outline.distance(mark.shape.bounds().center()), kind.bevel_mm + 12) << kind.name;
  }
  EXPECT_EQ(names.size(), part_catalogue().size());
  EXPECT_GE(names.size(), 12U);
  EXPECT_GE(families.size(), 5U);
  EXPECT_THROW((void)part_kind("spoon"), std::invalid_argument);
}

TEST(Catalogue, PartsComeInWoodAndMetalToo) {
  const PartKind& plain = part_kind("lever_arm");
  EXPECT_EQ(part_kind("wooden_lever_arm").finish, Finish::wood);
  EXPECT_EQ(part_kind("metal_lever_arm").finish, Finish::brushed);
  EXPECT_EQ(&part_kind("wooden_lever_arm"), &part_kind("wooden_lever_arm"));
  for (const char* name : {"wooden_lever_arm", "metal_lever_arm"}) {
    EXPECT_TRUE(is_part_kind(name));
    EXPECT_EQ(part_kind(name).name, name);
    EXPECT_EQ(part_kind(name).outline.bounds().size(), plain.outline.bounds().size());
    EXPECT_EQ(part_kind(name).grasps.size(), plain.grasps.size());
  }
  for (const char* name : {"wooden_", "wooden_spoon", "golden_lever_arm", ""}) {
    EXPECT_FALSE(is_part_kind(name)) << name;
    EXPECT_THROW((void)part_kind(name), std::invalid_argument) << name;
  }
  for (const PartKind& kind : part_catalogue()) EXPECT_NE(kind.finish, Finish::wood);
}

TEST(PartTexture, CoversTheOutlinesArea) {
  for (const PartKind& kind : part_catalogue()) {
    const PartTexture& texture = part_texture(kind.name);
    const Box2& b = kind.outline.bounds();
    constexpr double kStep = 0.43;
    double covered = 0;
    for (double y = b.lo.y(); y < b.hi.y(); y += kStep)
      for (double x = b.lo.x(); x < b.hi.x(); x += kStep)
        covered += kStep * kStep * static_cast<double>(texture.sample(x, y).coverage);
    const double area = area_mm2(kind.outline, 0.25);
    EXPECT_NEAR(covered, area, 0.012 * area) << kind.name;
    EXPECT_NEAR(static_cast<double>(texture.inside().size()), area, 0.04 * area) << kind.name;
  }
}

/// No part looks the same after a turn: its face differs from itself turned, else an angle could not be told.
TEST(PartTexture, NoPartIsSymmetric) {
  for (const PartKind& kind : part_catalogue()) {
    const PartTexture& texture = part_texture(kind.name);
    for (double turn_deg = 15; turn_deg < 346; turn_deg += 15) {
      const double c = std::cos(core::rad_from_deg(turn_deg)), s = std::sin(core::rad_from_deg(turn_deg));
      double different = 0;
      for (const Point2& p : texture.inside()) {
        const Surfel here = texture.sample(p.x(), p.y()),
                     there = texture.sample(c * p.x() - s * p.y(), s * p.x() + c * p.y());
        different += there.coverage < 0.5F || std::abs(here.albedo - there.albedo) > 0.15F * here.albedo ? 1 : 0;
      }
      EXPECT_GT(different / static_cast<double>(texture.inside().size()), 0.02)
          << kind.name << " turned by " << turn_deg;
    }
  }
}

}  // namespace
}  // namespace pickcell::sim
