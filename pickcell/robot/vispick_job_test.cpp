#include "pickcell/robot/vispick_job.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <stdexcept>

#include "pickcell/core/file.hpp"

namespace pickcell::robot {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

TEST(VispickJob, TheShippedOneIsMadeFromTheDefaults) {
  const auto shipped =
      core::read_text_file(std::filesystem::path(PICKCELL_SOURCE_DIR) / "docs" / "inform" / "VISPICK.JBI");
  ASSERT_TRUE(shipped);
  EXPECT_EQ(vispick_job({}), *shipped);
}

TEST(VispickJob, UsesTheVariablesContactsAndWindowOfTheCell) {
  VispickSettings s;
  s.name = "PICK-2", s.first_variable = 60, s.tool = 5, s.gripper_output = 7, s.grip_sensor_input = 12;
  s.window_min_mm = {-100.5, -1, -2}, s.window_max_mm = {200, 3, 4}, s.approach_mm = 50;
  const std::string job = vispick_job(s);
  EXPECT_THAT(job, HasSubstr("//NAME PICK-2\r\n"));
  EXPECT_THAT(job, HasSubstr("///TOOL 5\r\n"));
  EXPECT_THAT(job, HasSubstr("JUMP *GO IF B060=1\r\n"));
  EXPECT_THAT(job, HasSubstr("SET P071 P060\r\n"));
  EXPECT_THAT(job, HasSubstr("SET D062 D071\r\n"));
  EXPECT_THAT(job, HasSubstr("DOUT OT#(7) ON\r\n"));
  EXPECT_THAT(job, HasSubstr("WAIT IN#(12)=ON T=1.00\r\n"));
  EXPECT_THAT(job, HasSubstr("IF D070<-100500\r\n"));
  EXPECT_THAT(job, HasSubstr("ADD D070 50000\r\n"));
  EXPECT_THAT(job, Not(HasSubstr("@")));
  EXPECT_THAT(job, Not(HasSubstr("{")));
  EXPECT_THAT(job, Not(HasSubstr("010")));
}

TEST(VispickJob, SettingsThatCannotBeAreRefused) {
  const auto with = [](auto change) {
    VispickSettings s;
    change(s);
    return s;
  };
  for (const VispickSettings& bad :
       {with([](auto& s) { s.name = "vispick"; }), with([](auto& s) { s.name = std::string(33, 'A'); }),
        with([](auto& s) { s.first_variable = 0; }), with([](auto& s) { s.first_variable = 87; }),
        with([](auto& s) { s.tool = 64; }), with([](auto& s) { s.window_max_mm[1] = -600; }),
        with([](auto& s) { s.travel_mm_s = 0; }), with([](auto& s) { s.approach_mm = -1; })}) {
    EXPECT_THROW((void)vispick_job(bad), std::invalid_argument);
  }
}

}  // namespace
}  // namespace pickcell::robot
