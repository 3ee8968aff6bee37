// The client against a controller that follows a script of datagrams on a real socket.

#include "pickcell/robot/hses_client.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>

#include "pickcell/robot/hses_scripted_test.hpp"

namespace pickcell::robot {
namespace {

using core::ErrorCode;
using ::testing::HasSubstr;

TEST(HsesClient, MatchesAnswersAndDropsTheRest) {
  const Reply noisy = [](const HsesRequest& r) {
    HsesAnswer late = answer_to(r, {99});
    late.id = static_cast<std::uint8_t>(r.id - 1);
    HsesAnswer other = answer_to(r, {98});
    other.service = HsesService::set_one;
    HsesAnswer file = answer_to(r, {97});
    file.division = HsesDivision::file;
    HsesBytes cut = hses_bytes(answer_to(r, {96}));
    cut.pop_back();
    return std::vector<HsesBytes>{hses_bytes(late),
                                  hses_bytes(other),
                                  hses_bytes(file),
                                  cut,
                                  HsesBytes{1, 2, 3},
                                  hses_bytes(answer_to(r, {7})),
                                  hses_bytes(answer_to(r, {95}))};
  };
  ScriptedController controller({says(kIdle), noisy, says({8})});
  HsesClient client(controller.settings());
  ASSERT_TRUE(client.connect());
  EXPECT_EQ(client.read_integer(VariableType::byte, 5).value(), 7);
  EXPECT_EQ(client.read_integer(VariableType::byte, 5).value(), 8) << "the duplicate of before was thrown away";
  const auto sent = controller.received();
  EXPECT_NE(sent[1].id, sent[2].id);
}

TEST(HsesClient, ReadsAndWritesOfVariablesAreRepeated) {
  ScriptedController controller({says(kIdle), kSilence, kSilence, says({3}), kSilence, says({})});
  HsesClient client(controller.settings(300));
  ASSERT_TRUE(client.connect());
  EXPECT_EQ(client.read_integer(VariableType::byte, 5).value(), 3);
  EXPECT_TRUE(client.write_integer(VariableType::double_integer, 10, 4));
  const auto sent = controller.received();
  ASSERT_EQ(sent.size(), 6u);
  EXPECT_NE(sent[1].id, sent[2].id) << "a late answer to the first try is told apart";
  EXPECT_EQ(sent[4].payload, (HsesBytes{4, 0, 0, 0}));
  EXPECT_EQ(sent[5].payload, sent[4].payload);
}

TEST(HsesClient, WhatStartsMovesOrSwitchesIsSentOnce) {
  const std::vector<std::function<core::Status(HsesClient&)>> orders = {
      [](HsesClient& c) { return c.start_job("A"); }, [](HsesClient& c) { return c.servo(true); },
      [](HsesClient& c) { return c.hold(false); }, [](HsesClient& c) { return c.reset_alarm(); },
      [](HsesClient& c) { return c.move({DirectMove::Kind::line, 5, false, {}}); }};
  for (const auto& order : orders) {
    ScriptedController controller({says(kIdle)});
    HsesClient client(controller.settings(300));
    ASSERT_TRUE(client.connect());
    const auto lost = order(client);
    ASSERT_FALSE(lost);
    EXPECT_EQ(lost.error().code, ErrorCode::timeout);
    EXPECT_THAT(lost.error().line(), HasSubstr("whether it was done is not known"));
    EXPECT_FALSE(lost.error().trail.empty());
    EXPECT_EQ(controller.received().size(), 2u) << "the status, and one order";
    EXPECT_FALSE(client.connected());
    EXPECT_EQ(client.read_status().error().code, ErrorCode::link) << "not before connect()";
  }
}

TEST(HsesClient, HoldOnIsRepeated) {
  ScriptedController controller({says(kIdle), kSilence, says({})});
  HsesClient client(controller.settings(300));
  ASSERT_TRUE(client.connect());
  EXPECT_TRUE(client.hold(true));
}

TEST(HsesClient, BusyIsWaitedForAndRefusalsAreTold) {
  ScriptedController controller({says(kIdle), refuses(0xD8F1), says({1}), refuses(0x2010), refuses(0xD8F1)});
  HsesClient client(controller.settings());
  ASSERT_TRUE(client.connect());
  EXPECT_EQ(client.read_integer(VariableType::byte, 5).value(), 1);
  const auto moving = client.servo(true);
  ASSERT_FALSE(moving);
  EXPECT_EQ(moving.error().code, ErrorCode::refused);
  EXPECT_THAT(moving.error().line(), HasSubstr("refused with 2010: the robot is moving"));
  EXPECT_TRUE(client.connected());
  EXPECT_FALSE(client.servo(true)) << "busy is no reason to send an order again";
  EXPECT_EQ(controller.received().size(), 5u);
}

TEST(HsesClient, AnswersOfTheWrongSizeAreNoValues) {
  ScriptedController controller(
      {says(kIdle), says({1, 2, 3}), says({}), says(HsesBytes(40)), says(HsesBytes(59)), says({1, 0, 0xC0, 0x7F})});
  HsesClient client(controller.settings());
  ASSERT_TRUE(client.connect());
  EXPECT_EQ(client.read_integer(VariableType::byte, 5).error().code, ErrorCode::link);
  EXPECT_FALSE(client.read_integer(VariableType::double_integer, 5));
  EXPECT_FALSE(client.read_position(kBaseFrame));
  EXPECT_FALSE(client.read_alarms());
  EXPECT_FALSE(client.read_real(1)) << "NaN";
  EXPECT_EQ(client.read_position(2).error().code, ErrorCode::usage) << "the base frame only";
}

TEST(HsesClient, StartSelectsTheJobFirst) {
  ScriptedController controller({says(kIdle), says({}), says({})});
  HsesClient client(controller.settings());
  ASSERT_TRUE(client.connect());
  ASSERT_TRUE(client.start_job("VISPICK"));
  const auto sent = controller.received();
  EXPECT_EQ(sent[1].command, 0x87);
  EXPECT_EQ(sent[2].command, 0x86);
}

TEST(HsesClient, NobodyThereIsKnownAtOnce) {
  HsesSettings settings;
  settings.host = "127.0.0.1";
  settings.port = 1;
  settings.timeout = std::chrono::seconds(20);
  HsesClient client(settings);
  const auto refused = client.connect();
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::link);
  EXPECT_FALSE(client.connected());
}

}  // namespace
}  // namespace pickcell::robot
