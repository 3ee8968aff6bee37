// The symmetry that teaching tells, of parts drawn by formula: all families, sizes, turns, masks, noise and blur.

#include <gtest/gtest.h>

#include <random>
#include <string>

#include "pickcell/matches/learn/known_parts.hpp"
#include "pickcell/matches/learn/symmetry.hpp"

namespace pickcell::matches {
namespace {

using namespace testing;

Symmetry seen(const KnownPart& part, const Shot& shot) {
  const Photo photo = photograph(part, shot);
  return find_symmetry(photo.picture.view(), photo.mask.view());
}

TEST(Symmetry, OfSixtyAtRandomOneMayBeWrong) {
  std::mt19937 random(20);
  int right = 0, all = 0;
  std::string wrong;
  while (all < 60) {
    const KnownPart part = random_part(random);
    const Shot shot = random_shot(random, 15, 90);
    if (!resolvable(part, shot)) continue;
    ++all;
    const int order = seen(part, shot).order;
    right += order == part.order ? 1 : 0;
    if (order != part.order) wrong += words(part, shot) + ": " + std::to_string(order) + "\n";
  }
  EXPECT_GE(right, 59) << wrong;
}

}  // namespace
}  // namespace pickcell::matches
