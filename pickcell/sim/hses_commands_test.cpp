// What hosts of the High Speed Ethernet Server see (docs/yaskawa-protocols 2.2-2.7), and that it is the state that TCP
// port 80 sees.

#include "pickcell/sim/hses_commands.hpp"

#include <gtest/gtest.h>

#include <random>

#include "pickcell/sim/job_interpreter.hpp"
#include "pickcell/sim/shipped_jobs.hpp"
#include "pickcell/sim/tcp80_commands.hpp"

namespace pickcell::sim {
namespace {

using namespace robot;

class HsesCommands : public testing::Test {
 protected:
  static ControllerSettings settings(const std::string& type) {
    ControllerSettings s;
    s.type = type;
    s.jobs = shipped_jobs();
    return s;
  }
  HsesBytes ask(const HsesRequest& request) {
    const HsesAnswer a = execute_hses(state, request);
    EXPECT_EQ(a.status, 0) << std::hex << a.added_status;
    return a.payload;
  }
  /// The added status; 0 when it was done.
  int order(const HsesRequest& request) {
    const HsesAnswer a = execute_hses(state, request);
    EXPECT_EQ(a.status == 0, a.added_status == 0);
    EXPECT_TRUE(a.status == 0 || a.status == 0x1F);
    return a.added_status;
  }
  static HsesRequest raw(std::uint16_t command, std::uint16_t instance, std::uint8_t attribute, int service,
                         HsesBytes payload = {}) {
    HsesRequest r = hses_get(command, instance, attribute);
    r.service = static_cast<HsesService>(service);
    r.payload = std::move(payload);
    return r;
  }
  std::string tcp(std::string_view command, std::string_view operands = {}) {
    return execute_tcp80(state, command, operands).text;
  }
  void pass(double seconds) {
    for (int i = 0; i < seconds * 100; ++i) run_tick(state, 0.01);
  }
  ControllerState state{settings("yrc1000")};
};

TEST_F(HsesCommands, StatusHasTheBitsOfRstats) {
  EXPECT_EQ(ask(hses_get(0x72, 1)), (HsesBytes{194, 0, 0, 0, 0, 0, 0, 0}));
  EXPECT_EQ(ask(hses_get(0x72, 1, 1)), (HsesBytes{194, 0, 0, 0}));
  EXPECT_EQ(order(hses_get(0x72, 2)), 0xA001);
  ASSERT_EQ(order(hses_power(kHsesServo, true)), 0);
  ASSERT_EQ(order(hses_select_job("VISPICK", 0)), 0);
  ASSERT_EQ(order(hses_start()), 0);
  EXPECT_EQ(ask(hses_get(0x72, 1)), (HsesBytes{202, 0, 0, 0, 64, 0, 0, 0}));
  EXPECT_EQ(tcp("RSTATS"), "202,64");
  EXPECT_EQ(order(hses_start()), 0x2010) << "it runs";
  pass(2);
  const auto job = parse_hses_job(ask(hses_get(0x73, 1)));
  EXPECT_EQ(job->name + ',' + std::to_string(job->line) + ',' + std::to_string(job->step), tcp("RJSEQ"));
  EXPECT_EQ(parse_hses_job(ask(hses_get(0x73, 2)))->name, "");
}

TEST_F(HsesCommands, AVariableWrittenOverOneDoorIsReadOverTheOther) {
  ASSERT_EQ(tcp("LOADV", "0,5,200"), "0000");
  EXPECT_EQ(ask(hses_get(0x7A, 5, 1)), (HsesBytes{200}));
  ASSERT_EQ(order(hses_set_one(0x7C, 9, {0xFB, 0xFF, 0xFF, 0xFF})), 0);
  EXPECT_EQ(tcp("SAVEV", "2,9"), "-5");
  ASSERT_EQ(order(hses_set_one(0x7B, 3, {0x00, 0x80})), 0);
  EXPECT_EQ(tcp("SAVEV", "1,3"), "-32768");
  ASSERT_EQ(order(hses_set_one(0x7D, 3, HsesWriter().f32(1.5f).take())), 0);
  EXPECT_EQ(tcp("SAVEV", "3,3"), "1.500000");
  ASSERT_EQ(order(hses_set_one(0x7E, 3, HsesWriter().text("HELLO", 16).take())), 0);
  EXPECT_EQ(tcp("SAVEV", "7,3"), "HELLO");
  ASSERT_EQ(tcp("LOADV", "4,30,1,4,300.000,-0.500,12.346,180.0000,-0.0001,90.0000,1,2"), "0000");
  const auto p = parse_hses_position(ask(hses_get(0x7F, 30)));
  EXPECT_EQ(*p, (HsesPosition{18, 4, 2, 3, 0, {300000, -500, 12346, 1800000, -1, 900000, 0, 0}}))
      << "no-flip is bit 0 over TCP, bit 2 here; frame 4 is user 3";
  HsesPosition q = *p;
  q.type = 16, q.user = 0, q.form = 1;
  ASSERT_EQ(order(hses_set_all(0x7F, 31, hses_payload(q))), 0);
  EXPECT_EQ(tcp("SAVEV", "4,31"), "1,0,300.000,-0.500,12.346,180.0000,-0.0001,90.0000,4,2");
}

TEST_F(HsesCommands, BothFormsOfVariableAccessAreTaken) {
  EXPECT_EQ(order(raw(0x7A, 5, 1, 0x10, {7})), 0);
  EXPECT_EQ(ask(raw(0x7A, 5, 0, 0x01)), (HsesBytes{7})) << "attribute 0 with get all";
  EXPECT_EQ(order(raw(0x7A, 5, 0, 0x02, {8})), 0);
  EXPECT_EQ(ask(raw(0x7A, 5, 1, 0x0E)), (HsesBytes{8}));
  EXPECT_EQ(order(raw(0x7A, 5, 1, 0x10, {9, 0, 0, 0})), 0) << "a row of 32 bits, as the manual draws it";
  EXPECT_EQ(state.B[5], 9);
  EXPECT_EQ(order(raw(0x7A, 5, 1, 0x10, {0, 1, 0, 0})), 0x1012) << "256 is no byte";
  EXPECT_EQ(order(raw(0x7A, 5, 1, 0x10, {})), 0x1013);
  EXPECT_EQ(order(raw(0x7A, 100, 1, 0x0E)), 0xA001);
  EXPECT_EQ(order(raw(0x7A, 5, 2, 0x0E)), 0xA002);
  EXPECT_EQ(order(raw(0x7A, 5, 1, 0x33)), 0xA002) << "no such service here";
  EXPECT_EQ(order(raw(0x6F, 1, 0, 0x01)), 0xA000);
  EXPECT_EQ(order(raw(0x30A, 1, 0, 0x33)), 0xA000);
}

TEST_F(HsesCommands, WordsOfAPositionOneByOne) {
  EXPECT_EQ(order(hses_get(0x7F, 99)), 0xB001) << "never written";
  const Position set;
  state.P[40] = set;
  EXPECT_EQ(order(raw(0x7F, 40, 3, 0x10, {5, 0, 0, 0})), 0);
  EXPECT_EQ(state.P[40]->tool, 5);
  EXPECT_EQ(ask(hses_get(0x7F, 40, 3)), (HsesBytes{5, 0, 0, 0}));
  EXPECT_EQ(order(raw(0x7F, 40, 3, 0x10, {64, 0, 0, 0})), 0xB00D);
  EXPECT_EQ(order(raw(0x7F, 40, 1, 0x10, {3, 0, 0, 0})), 0xB007);
  EXPECT_EQ(order(raw(0x7F, 40, 14, 0x0E)), 0xA002);
  EXPECT_EQ(ask(hses_get(0x80, 0)).size(), 36u);
  EXPECT_EQ(order(hses_set_all(0x81, 1, HsesBytes(36, 1))), 0);
  EXPECT_EQ(ask(hses_get(0x81, 1)), HsesBytes(36, 1));
}

TEST_F(HsesCommands, PluralsAreAllOrNothing) {
  ASSERT_EQ(order(hses_write_plural(0x304, 10, 2, {1, 0, 0, 0, 2, 0, 0, 0})), 0);
  EXPECT_EQ(state.D[10], 1);
  EXPECT_EQ(state.D[11], 2);
  EXPECT_EQ(ask(hses_read_plural(0x304, 10, 2)), (HsesBytes{2, 0, 0, 0, 1, 0, 0, 0, 2, 0, 0, 0}));
  EXPECT_EQ(order(hses_write_plural(0x304, 99, 2, {9, 0, 0, 0, 9, 0, 0, 0})), 0xA001);
  EXPECT_EQ(state.D[99], 0) << "the first of the two was not written either";
  EXPECT_EQ(ask(hses_read_plural(0x302, 0, 4)).size(), 8u);
  EXPECT_EQ(order(raw(0x302, 0, 0, 0x33, {3, 0, 0, 0})), 0x1012) << "B in twos";
  EXPECT_EQ(order(raw(0x304, 0, 0, 0x33, {119, 0, 0, 0})), 0xA100);
  EXPECT_EQ(order(raw(0x304, 0, 0, 0x33, {0xFF, 0xFF, 0xFF, 0xFF})), 0xA100);
  EXPECT_EQ(order(raw(0x304, 0, 0, 0x34, {2, 0, 0, 0, 1})), 0x1013);
  EXPECT_EQ(order(hses_read_plural(0x307, 0, 2)), 0xB001) << "P001 was never written";
  state.P[1] = state.P[0];
  EXPECT_EQ(ask(hses_read_plural(0x307, 0, 2)).size(), 4 + 2 * 52u);
  EXPECT_EQ(order(hses_write_plural(0x300, 2701, 2, {0x81, 1})), 0);
  EXPECT_EQ(tcp("IOREAD", "27010,16"), "129,1");
}

TEST_F(HsesCommands, ContactsAreWritableWhereTheControllerSays) {
  ASSERT_EQ(order(hses_set_one(0x78, 2701, {5})), 0);
  EXPECT_EQ(ask(hses_get(0x78, 2701, 1)), (HsesBytes{5}));
  EXPECT_EQ(order(hses_set_one(0x78, 1, {5})), 0x2120);
  EXPECT_EQ(order(hses_get(0x78, 999, 1)), 0xA001);
  EXPECT_EQ(ask(hses_get(0x78, 5007, 1)), (HsesBytes{0}));
  state.servo = true;
  EXPECT_EQ(ask(hses_get(0x78, 5007, 1)), (HsesBytes{8})) << "bit 3: servo";
  ControllerState fs100{settings("fs100")};
  EXPECT_EQ(execute_hses(fs100, hses_set_one(0x78, 2501, {5})).status, 0);
  ASSERT_EQ(order(hses_set_one(0x79, 0, {7, 0})), 0);
  EXPECT_EQ(ask(hses_get(0x79, 0, 1)), (HsesBytes{7, 0}));
  EXPECT_EQ(order(hses_set_one(0x79, 999, {7, 0})), 0x2120);
}

TEST_F(HsesCommands, TheContactsOfEachControllerAreThoseOfTheReference) {
  struct Range {
    int first, last;
  };
  // docs/yaskawa-protocols 2.5, column by column; the next one after `last` is no contact.
  const std::vector<Range> older{{1, 256},     {1001, 1256}, {2001, 2256}, {2501, 2756}, {3001, 3256}, {3501, 3756},
                                 {4001, 4160}, {5001, 5200}, {6001, 6064}, {7001, 7999}, {8001, 8064}, {8201, 8220}};
  const std::vector<Range> newer{{1, 512},     {1001, 1512}, {2001, 2512}, {2701, 2956}, {3001, 3512}, {3701, 3956},
                                 {4001, 4256}, {5001, 5512}, {6001, 6064}, {7001, 7999}, {8001, 8512}, {8701, 8720}};
  for (const auto& [type, ranges] :
       {std::pair("dx100", older), {"fs100", older}, {"dx200", newer}, {"yrc1000", newer}}) {
    state = ControllerState(settings(type));
    for (const Range& r : ranges) {
      for (const int there : {r.first, r.last})
        EXPECT_EQ(order(hses_get(0x78, static_cast<std::uint16_t>(there), 1)), 0) << type << " " << there;
      EXPECT_EQ(order(hses_get(0x78, static_cast<std::uint16_t>(r.last + 1), 1)), 0xA001) << type << " " << r.last + 1;
    }
  }
}

TEST_F(HsesCommands, AnEmergencyStopIsSeenAndKeepsTheServoOff) {
  ASSERT_EQ(order(hses_power(kHsesServo, true)), 0);
  ASSERT_EQ(order(hses_select_job("VISPICK", 0)), 0);
  ASSERT_EQ(order(hses_start()), 0);
  pass(0.3);
  ASSERT_TRUE(state.move) << "to its waiting place";
  state.press_emergency_stop();
  EXPECT_EQ(ask(hses_get(0x78, 8002, 1)), (HsesBytes{0x40})) << "contact 80026, at the pendant";
  pass(0.3);
  const Joints stands = state.q;
  EXPECT_EQ(ask(hses_get(0x72, 1)), (HsesBytes{194, 0, 0, 0, 0, 0, 0, 0})) << "neither running nor servo on";
  EXPECT_EQ(order(hses_power(kHsesServo, true)), 0x3450);
  EXPECT_EQ(order(hses_start()), 0x3010);
  pass(1);
  EXPECT_EQ(state.q, stands);
  state.release_emergency_stop();
  ASSERT_EQ(order(hses_power(kHsesServo, true)), 0);
  ASSERT_EQ(order(hses_start()), 0);
  pass(0.5);
  EXPECT_NE(state.q, stands) << "START carries on";
}

TEST_F(HsesCommands, PositionInPulsesAndInTheBaseFrame) {
  EXPECT_EQ(*parse_hses_position(ask(hses_get(0x75, 101))),
            (HsesPosition{16, 0, 1, 0, 0, {480000, 0, 255000, 1800000, 0, 0, 0, 0}}));
  EXPECT_EQ(*parse_hses_position(ask(hses_get(0x75, 1))), (HsesPosition{0, 0, 1, 0, 0, {0, 0, 0, 0, -90000, 0, 0, 0}}));
  EXPECT_EQ(ask(hses_get(0x75, 101, 6)), (HsesBytes{0x00, 0x53, 0x07, 0x00})) << "attribute 6: the first axis";
  EXPECT_EQ(order(hses_get(0x75, 11)), 0xA001) << "no base axis";
  EXPECT_EQ((*parse_hses_axis_names(ask(hses_get(0x74, 1))))[5], "T");
  EXPECT_EQ(ask(hses_get(0x76, 1)).size(), 32u);
  EXPECT_EQ(ask(hses_get(0x77, 1)).size(), 32u);
  EXPECT_EQ(ask(hses_get(0x88, 1)).size(), 28u);
  EXPECT_EQ(parse_hses_system(ask(hses_get(0x89, 11)))->model, "SIM-gp7");
}

TEST_F(HsesCommands, AlarmsNowAndBefore) {
  EXPECT_EQ(ask(hses_get(0x70, 1)), HsesBytes(60)) << "healthy";
  EXPECT_EQ(ask(hses_get(0x71, 1)), HsesBytes(60));
  state.unix_us = 1'764'028'800'000'000;  // 2025-11-25 00:00 UTC
  state.raise_alarm({4107, 3, "OUT OF RANGE"});
  const auto a = parse_hses_alarm(ask(hses_get(0x70, 1)));
  EXPECT_EQ(a->code, 4107u);
  EXPECT_EQ(a->data, 3u);
  EXPECT_EQ(a->time, "2025/11/25 00:00");
  EXPECT_EQ(a->name, "OUT OF RANGE");
  EXPECT_EQ(ask(hses_get(0x70, 1, 1)), (HsesBytes{0x0B, 0x10, 0, 0}));
  EXPECT_EQ(order(hses_power(kHsesServo, true)), 0x2060);
  EXPECT_EQ(order(hses_set_one(kHsesReset, kHsesResetAlarm, {1, 0, 0, 0})), 0);
  EXPECT_EQ(ask(hses_get(0x70, 1)), HsesBytes(60));
  EXPECT_EQ(parse_hses_alarm(ask(hses_get(0x71, 1001)))->code, 4107u) << "remembered";
  EXPECT_EQ(order(hses_get(0x70, 5)), 0xA001);
}

TEST_F(HsesCommands, MovesAndTheirRefusals) {
  HsesMoveData m;
  m.speed = {0, 5000};
  m.target = {16, 0, 1, 0, 0, {470000, 10000, 250000, 1800000, 0, 0, 0, 0}};
  const auto joint = [&] { return hses_move(HsesMoveKind::joint, m); };
  EXPECT_EQ(order(joint()), 0x3010);
  ASSERT_EQ(order(hses_power(kHsesServo, true)), 0);
  ASSERT_EQ(order(joint()), 0);
  EXPECT_EQ(order(joint()), 0x2010);
  pass(5);
  EXPECT_EQ(parse_hses_position(ask(hses_get(0x75, 101)))->axes[0], 470000);

  HsesMoveData by;
  by.speed = {1, 1000};
  by.target = {19, 0, 1, 0, 0, {0, 0, 5000, 0, 0, 0, 0, 0}};
  ASSERT_EQ(order(hses_move(HsesMoveKind::line_by, by)), 0);
  pass(3);
  EXPECT_EQ(parse_hses_position(ask(hses_get(0x75, 101)))->axes[2], 245000) << "the tool looks down";
  by.target.type = 17;
  ASSERT_EQ(order(hses_move(HsesMoveKind::line_by, by)), 0);
  pass(3);
  EXPECT_EQ(parse_hses_position(ask(hses_get(0x75, 101)))->axes[2], 250000);

  HsesPulseMoveData p;
  p.speed = {0, 1000};
  p.pulses = {0, 0, 0, 0, -90000, 0, 1000, 1000};  // axes this arm has not
  p.tool = 1;
  ASSERT_EQ(order(hses_pulse_move(HsesMoveKind::joint, p)), 0);
  pass(20);
  EXPECT_EQ(parse_hses_position(ask(hses_get(0x75, 1)))->axes[4], -90000);

  const auto with = [&](auto change) {
    HsesMoveData other = m;
    change(other);
    return order(hses_move(HsesMoveKind::line, other));
  };
  EXPECT_EQ(with([](auto& x) { x.speed = {0, 100}; }), 0xB009) << "% is no speed of a line";
  EXPECT_EQ(with([](auto& x) { x.speed = {1, 0}; }), 0xB009);
  EXPECT_EQ(with([](auto& x) { x.speed = {1, 100}, x.target.tool = 64; }), 0xB00D);
  EXPECT_EQ(with([](auto& x) { x.speed = {1, 100}, x.robot = 2; }), 0xB008);
  EXPECT_EQ(with([](auto& x) { x.speed = {1, 100}, x.target.type = 18, x.target.user = 65; }), 0xB00E);
  EXPECT_EQ(with([](auto& x) { x.speed = {1, 100}, x.target.type = 18, x.target.user = 1; }), 0x3350);
  EXPECT_EQ(with([](auto& x) { x.speed = {1, 100}, x.target.axes[0] = 9'000'000; }), 0x4130) << "out of reach";
  state.turn_key_to_teach();
  m.speed = {0, 5000};
  EXPECT_EQ(order(joint()), 0x2100);
  EXPECT_EQ(order(hses_set_one(0x7A, 5, {1})), 0x2100);
  EXPECT_EQ(order(hses_get(0x7A, 5, 1)), 0) << "reading works always";
}

TEST_F(HsesCommands, SwitchesAndMessages) {
  HsesRequest both = hses_select_job("TEST1", 0);
  both.attribute = 2;
  EXPECT_EQ(order(both), 0) << "name and line, whatever the attribute says";
  both.service = HsesService::set_one;
  EXPECT_EQ(order(both), 0xA002);
  EXPECT_EQ(order(hses_cycle(3)), 0);
  EXPECT_EQ(state.cycle, CycleMode::continuous);
  EXPECT_EQ(order(hses_cycle(4)), 0x1012);
  EXPECT_EQ(order(raw(0x84, 1, 1, 0x10, {1, 0, 0, 0})), 0xA001);
  EXPECT_EQ(order(hses_power(kHsesHold, true)), 0);
  EXPECT_TRUE(state.hold_command);
  EXPECT_EQ(order(hses_power(kHsesHold, false)), 0);
  EXPECT_EQ(order(raw(0x83, 2, 1, 0x10, {3, 0, 0, 0})), 0x1012);
  EXPECT_EQ(order(raw(0x83, 4, 1, 0x10, {1, 0, 0, 0})), 0xA001);
  EXPECT_EQ(order(raw(0x85, 1, 1, 0x10, HsesWriter().text("Hello, FS100!", 32).take())), 0) << "filled up with NULs";
  EXPECT_EQ(state.pendant_message, "Hello, FS100!");
  EXPECT_EQ(order(raw(0x85, 1, 1, 0x10, HsesBytes(31, 'x'))), 0x1013);
  EXPECT_EQ(order(hses_select_job("NONE", 0)), 0x4040);
  EXPECT_EQ(order(hses_start()), 0x3010);
  HsesRequest master = hses_select_job("TEST1", 0);
  master.instance = 10;
  EXPECT_EQ(order(master), 0);
  EXPECT_EQ(state.master_job, "TEST1");
}

TEST_F(HsesCommands, NamesForScenariosAreThoseOfTcp) {
  EXPECT_EQ(hses_command_name(hses_start()), "START");
  EXPECT_EQ(hses_command_name(hses_power(kHsesServo, true)), "SVON");
  EXPECT_EQ(hses_command_name(hses_power(kHsesHold, true)), "HOLD");
  EXPECT_EQ(hses_command_name(hses_get(0x7A, 1, 1)), "SAVEV");
  EXPECT_EQ(hses_command_name(hses_read_plural(0x302, 0, 2)), "SAVEV");
  EXPECT_EQ(hses_command_name(hses_set_one(0x78, 2701, {1})), "IOWRITE");
  EXPECT_EQ(hses_command_name(hses_get(0x89, 11)), "0x89");
}

TEST_F(HsesCommands, AnyRequestIsAnsweredAndNothingBreaks) {
  std::mt19937 random(17);
  for (int i = 0; i < 100000; ++i) {
    HsesRequest r;
    r.id = static_cast<std::uint8_t>(random());
    r.command = static_cast<std::uint16_t>(random() % 4 == 0 ? 0x300 + random() % 12 : 0x6F + random() % 32);
    r.instance = static_cast<std::uint16_t>(random() % 3 == 0 ? random() : random() % 120);
    r.attribute = static_cast<std::uint8_t>(random() % 16);
    constexpr std::array kServices = {0x01, 0x02, 0x0E, 0x10, 0x33, 0x34, 0x09};
    r.service = static_cast<HsesService>(kServices[random() % kServices.size()]);
    constexpr std::array<std::size_t, 8> kSizes = {0, 1, 2, 4, 36, 52, 88, 104};
    r.payload.resize(random() % 8 == 0 ? random() % 480 : kSizes[random() % kSizes.size()]);
    for (std::uint8_t& b : r.payload) b = static_cast<std::uint8_t>(random() % 3 ? random() % 4 : random());
    const HsesAnswer a = execute_hses(state, r);
    ASSERT_LE(a.payload.size(), kHsesMostPayload);
    ASSERT_EQ(a.id, r.id);
    if (i % 50 == 0) {
      run_tick(state, 0.01);
      ASSERT_TRUE(inside_limits(*state.arm, state.q));
      state.reset_at_pendant();
    }
  }
}

}  // namespace
}  // namespace pickcell::sim
