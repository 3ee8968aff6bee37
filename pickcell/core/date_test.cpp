#include "pickcell/core/date.hpp"

#include <gtest/gtest.h>

namespace pickcell::core {
namespace {

TEST(Date, SpeaksUtcWhateverTheMachineThinks) {
  EXPECT_EQ(iso_utc(1'767'225'600'000'000), "2026-01-01T00:00:00Z");
  EXPECT_EQ(iso_utc(951'782'399'999'999), "2000-02-28T23:59:59Z");
  EXPECT_EQ(iso_utc(-1), "1969-12-31T23:59:59Z");
  EXPECT_EQ(utc(0, "%Y%m%d-%H%M%S"), "19700101-000000");
}

}  // namespace
}  // namespace pickcell::core
