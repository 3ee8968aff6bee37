#include "pickcell/sim/tcp80_commands.hpp"

#include <gtest/gtest.h>

#include <random>

#include "pickcell/sim/job_interpreter.hpp"
#include "pickcell/sim/shipped_jobs.hpp"

namespace pickcell::sim {
namespace {

class Tcp80Commands : public testing::Test {
 protected:
  static ControllerSettings settings(const std::string& type) {
    ControllerSettings s;
    s.type = type;
    s.jobs = shipped_jobs();
    return s;
  }
  std::string ask(std::string_view command, std::string_view operands = {}) {
    return execute_tcp80(state, command, operands).text;
  }
  /// The number in the brackets; 0 for 0000.
  int order(std::string_view command, std::string_view operands = {}) {
    const Tcp80Answer answer = execute_tcp80(state, command, operands);
    if (answer.kind == Tcp80Answer::Kind::accepted) {
      EXPECT_EQ(answer.bytes(), "0000\r\n");
      return 0;
    }
    EXPECT_EQ(answer.kind, Tcp80Answer::Kind::error) << answer.text;
    EXPECT_TRUE(answer.bytes().starts_with("ERROR: ") && answer.bytes().ends_with(").\r\n")) << answer.text;
    return std::stoi(answer.text.substr(answer.text.rfind('(') + 1));
  }
  void pass(double seconds) {
    for (int i = 0; i < seconds * 100; ++i) run_tick(state, 0.01);
  }
  static constexpr const char* kMovj = "10.00,0,400,0,100,180,0,0,0,1,0,0,0,0,0,0";
  ControllerState state{settings("yrc1000")};
};

TEST_F(Tcp80Commands, ReadsWhatAHealthyControllerSays) {
  EXPECT_EQ(ask("RALARM"), "0,0,0,0,0,0,0,0,0,0");
  EXPECT_EQ(ask("RSTATS"), "194,0");
  EXPECT_EQ(ask("RPOSJ"), "0,0,0,0,-90000,0,0,0,0,0,0,0");
  EXPECT_EQ(ask("RPOSC", "0,0"), "480.000,0.000,255.000,180.0000,0.0000,0.0000,0,1");
  EXPECT_EQ(ask("RPOSC", "1,1"), "480.000,0.000,255.000,180.0000,0.0000,0.0000,0,1,0,0,0,0,0,0");
  EXPECT_EQ(ask("RJDIR", "*"), "TEST1,TEST2,VISPICK");
  EXPECT_EQ(order("RJSEQ"), 4060);
  EXPECT_EQ(order("JSEQ", "TEST1,1"), 0);
  EXPECT_EQ(ask("RJSEQ"), "TEST1,1,0");
  EXPECT_EQ(order("RPOSC", "2,0"), 3350) << "user frame 1 is not taught";
  EXPECT_EQ(order("RPOSC", "66,0"), 1012);
}

TEST_F(Tcp80Commands, ReadsTheRunningJobAndItsBits) {
  ASSERT_EQ(order("SVON", "1"), 0);
  ASSERT_EQ(order("START", "VISPICK"), 0);
  EXPECT_EQ(ask("RSTATS"), "202,64");
  EXPECT_EQ(order("START"), 2010);
  pass(10);
  const std::string now = ask("RJSEQ");
  EXPECT_TRUE(now.starts_with("VISPICK,")) << now;
  EXPECT_TRUE(now.ends_with(",1")) << now;
  EXPECT_EQ(ask("SAVEV", "0,12"), "1") << "waiting, clear of the camera";
  ASSERT_EQ(order("HOLD", "1"), 0);
  pass(0.1);
  EXPECT_EQ(ask("RSTATS"), "194,72");
  EXPECT_EQ(order("START"), 2050);
  ASSERT_EQ(order("HOLD", "0"), 0);
  ASSERT_EQ(order("START"), 0);
  EXPECT_EQ(ask("RSTATS"), "202,64");
}

TEST_F(Tcp80Commands, VariablesOfEveryTypeComeBackAsWritten) {
  for (const auto& [write, read, value] :
       std::vector<std::array<std::string, 3>>{{"0,10,255", "0,10", "255"},
                                               {"1,99,-32768", "1,99", "-32768"},
                                               {"2,0,2147483647", "2,0", "2147483647"},
                                               {"3,5,-1.5", "3,5", "-1.500000"},
                                               {"7,3,ABC def", "7,3", "ABC def"},
                                               {"4,10,1,0,300.001,-2.5,250,180.0000,0,-90.1234,0,1", "4,10",
                                                "1,0,300.001,-2.500,250.000,180.0000,0.0000,-90.1234,0,1"},
                                               {"4,127,0,1,-2,3,4,5,-6,1", "4,127", "0,1,-2,3,4,5,-6,1"}}) {
    EXPECT_EQ(order("LOADV", write + "\r"), 0) << write;
    EXPECT_EQ(ask("SAVEV", read), value);
  }
}

TEST_F(Tcp80Commands, RefusesVariablesThatAreNot) {
  EXPECT_EQ(order("LOADV", "0,10"), 1011);
  EXPECT_EQ(order("LOADV", "0,10,1,2"), 1011);
  EXPECT_EQ(order("LOADV", "0,10,256"), 1012);
  EXPECT_EQ(order("LOADV", "0,10,-1"), 1012);
  EXPECT_EQ(order("LOADV", "0,10,1.5"), 1012);
  EXPECT_EQ(order("LOADV", "0,10,nan"), 1012);
  EXPECT_EQ(order("LOADV", "0,10,"), 1012);
  EXPECT_EQ(order("LOADV", "0,100,1"), 1012);
  EXPECT_EQ(order("LOADV", "1,0,32768"), 1012);
  EXPECT_EQ(order("LOADV", "2,0,2147483648"), 1012);
  EXPECT_EQ(order("LOADV", "3,0,1e5"), 1012);
  EXPECT_EQ(order("LOADV", "7,0,a text longer than it may"), 1013);
  EXPECT_EQ(order("LOADV", "5,0,1"), 1012) << "no base axis";
  EXPECT_EQ(order("LOADV", "4,128,1,0,0,0,0,0,0,0,0,0"), 1012);
  EXPECT_EQ(order("LOADV", "4,0,1,0,0,0,0,0,0,0,0"), 1011);
  EXPECT_EQ(order("LOADV", "4,0,1,0,0,0,0,0,0,0,0,64"), 1012);
  EXPECT_EQ(order("LOADV", "4,0,1,66,0,0,0,0,0,0,0,0"), 1012);
  EXPECT_EQ(order("LOADV", "4,0,1,0,1000000,0,0,0,0,0,0,0"), 1012);
  EXPECT_EQ(order("SAVEV", "4,77"), 4130) << "never set";
  EXPECT_EQ(order("SAVEV", "9,0"), 1012);
}

TEST_F(Tcp80Commands, ContactsAreReadInGroupsAndOnlyNetworkInputsWritten) {
  state.inputs[1] = state.inputs[3] = state.inputs[9] = true;
  state.outputs[2] = true;
  EXPECT_EQ(ask("IOREAD", "10,16"), "5,1");
  EXPECT_EQ(ask("IOREAD", "10010,8"), "2");
  EXPECT_EQ(order("IOWRITE", "27010,16,1,128"), 0);
  EXPECT_EQ(ask("IOREAD", "27010,16"), "1,128");
  ASSERT_EQ(state.contact_events.size(), 2u);
  EXPECT_EQ(state.contact_events[0].contact, 27010);
  EXPECT_EQ(state.contact_events[1].contact, 27027);
  EXPECT_EQ(order("IOWRITE", "27010,16,1,128"), 0);
  EXPECT_EQ(state.contact_events.size(), 2u) << "nothing changed";
  EXPECT_EQ(order("IOWRITE", "10010,8,1"), 2120);
  EXPECT_EQ(order("IOWRITE", "29560,16,1,1"), 2120);
  EXPECT_EQ(order("IOWRITE", "29560,8,1"), 0);
  EXPECT_EQ(order("IOWRITE", "27010,8,256"), 1012);
  EXPECT_EQ(order("IOWRITE", "27010,8,1,1"), 1011);
  EXPECT_EQ(order("IOREAD", "10,7"), 1012);
  EXPECT_EQ(order("IOREAD", "11,8"), 1012);
  EXPECT_EQ(order("IOREAD", "99990,8"), 1012);
  EXPECT_EQ(ask("IOREAD", "50070,8"), "0");
  ASSERT_EQ(order("SVON", "1"), 0);
  EXPECT_EQ(ask("IOREAD", "50070,8"), "8") << "servo";
  EXPECT_EQ(ask("IOREAD", "80010,8"), "2") << "remote";
}

TEST_F(Tcp80Commands, RefusesInTheOrderOfTheReference) {
  state.remote = state.play = false;
  state.hold_command = state.hold_external = state.hold_pendant = true;
  state.raise_alarm({4107, 0, ""});
  EXPECT_EQ(order("FLY"), 1010);
  EXPECT_EQ(order("PMOVL", "0,1"), 1010);
  EXPECT_EQ(order("MOVJ", "1,2,3"), 1011);
  EXPECT_EQ(order("MOVJ", "0,0,400,0,100,180,0,0,0,1,0,0,0,0,0,0"), 1012);
  for (const auto& [command, operands] :
       std::vector<std::pair<std::string, std::string>>{{"MOVJ", kMovj}, {"START", "NOJOB"}}) {
    state.remote = false;
    state.play = state.servo = false;
    state.hold_command = state.hold_external = state.hold_pendant = true;
    state.direct_move = true;
    state.alarms = {{4107, 0, ""}};
    EXPECT_EQ(order(command, operands), 2100);
    state.remote = true;
    EXPECT_EQ(order(command, operands), 2060);
    state.alarms.clear();
    state.error = true;
    EXPECT_EQ(order(command, operands), 2060);
    state.error = false;
    EXPECT_EQ(order(command, operands), 2020);
    state.hold_pendant = false;
    EXPECT_EQ(order(command, operands), 2040);
    state.hold_external = false;
    EXPECT_EQ(order(command, operands), 2050);
    state.hold_command = false;
    EXPECT_EQ(order(command, operands), 2080);
    state.play = true;
    EXPECT_EQ(order(command, operands), 3010);
    state.servo = true;
    EXPECT_EQ(order(command, operands), 2010);
    state.direct_move = false;
  }
  EXPECT_EQ(order("START", "NOJOB"), 4040);
  EXPECT_EQ(order("START"), 4060);
}

TEST_F(Tcp80Commands, NothingIsWrittenOrOrderedOutsideOfRemote) {
  state.turn_key_to_teach();
  for (const auto& [command, operands] : std::vector<std::pair<std::string, std::string>>{{"LOADV", "0,10,1"},
                                                                                          {"IOWRITE", "27010,8,1"},
                                                                                          {"HOLD", "1"},
                                                                                          {"RESET", ""},
                                                                                          {"CANCEL", ""},
                                                                                          {"SVON", "1"},
                                                                                          {"MODE", "2"},
                                                                                          {"CYCLE", "1"},
                                                                                          {"HLOCK", "1"},
                                                                                          {"MDSP", "text"},
                                                                                          {"START", "TEST1"},
                                                                                          {"JSEQ", "TEST1,0"},
                                                                                          {"SETMJ", "TEST1"},
                                                                                          {"DELETE", "TEST1"},
                                                                                          {"MOVJ", kMovj}})
    EXPECT_EQ(order(command, operands), 2100) << command;
  EXPECT_EQ(ask("RSTATS"), "34,0");
  EXPECT_EQ(ask("SAVEV", "0,10"), "0");
}

TEST_F(Tcp80Commands, ResetClearsMinorAlarmsOnly) {
  state.raise_alarm({4107, 2, "minor"});
  EXPECT_EQ(ask("RALARM"), "0,0,4107,2,0,0,0,0,0,0");
  EXPECT_EQ(ask("RSTATS"), "194,16");
  EXPECT_EQ(order("SVON", "1"), 2060);
  EXPECT_EQ(order("RESET"), 0);
  EXPECT_EQ(ask("RSTATS"), "194,0");
  state.raise_alarm({1325, 1, "major"});
  EXPECT_EQ(order("RESET"), 0);
  EXPECT_EQ(ask("RALARM"), "0,0,1325,1,0,0,0,0,0,0");
  state.reset_at_pendant();
  state.error = true;
  EXPECT_EQ(ask("RSTATS"), "194,32");
  EXPECT_EQ(order("CANCEL"), 0);
  EXPECT_EQ(ask("RSTATS"), "194,0");
}

TEST_F(Tcp80Commands, MovesDirectly) {
  ASSERT_EQ(order("SVON", "1"), 0);
  ASSERT_EQ(order("MOVJ", kMovj), 0);
  EXPECT_EQ(ask("RSTATS"), "202,64");
  EXPECT_EQ(order("MOVJ", kMovj), 2010);
  EXPECT_EQ(order("START", "TEST1"), 2010);
  pass(10);
  EXPECT_EQ(ask("RSTATS"), "194,64");
  EXPECT_EQ(ask("RPOSC", "0,0"), "400.000,0.000,100.000,180.0000,0.0000,0.0000,0,1");
  ASSERT_EQ(order("MOVL", "0,100.0,0,400,50,50,180,0,30,0,1,0,0,0,0,0,0"), 0);
  pass(10);
  EXPECT_EQ(ask("RPOSC", "0,0"), "400.000,50.000,50.000,180.0000,0.0000,30.0000,0,1");
  ASSERT_EQ(order("IMOV", "0,50,0,-10,0,20.5,0,0,-30,0,1,0,0,0,0,0,0"), 0);
  pass(10);
  EXPECT_EQ(ask("RPOSC", "0,0"), "390.000,50.000,70.500,180.0000,0.0000,0.0000,0,1");
  ASSERT_EQ(order("PMOVJ", "20,0,0,0,0,-90000,0,0,0,0,0,0,0,1"), 0);
  pass(10);
  EXPECT_EQ(ask("RPOSJ"), "0,0,0,0,-90000,0,0,0,0,0,0,0");
  EXPECT_EQ(order("MOVJ", "10,0,2000,0,100,180,0,0,0,1,0,0,0,0,0,0"), 4130) << "out of reach";
  EXPECT_EQ(order("PMOVJ", "20,0,0,0,0,-200000,0,0,0,0,0,0,0,1"), 4130) << "beyond the axis";
}

TEST_F(Tcp80Commands, AHoldOfAMomentStopsTheArmForGood) {
  ASSERT_EQ(order("SVON", "1"), 0);
  ASSERT_EQ(order("MOVJ", kMovj), 0);
  pass(0.3);
  ASSERT_EQ(order("HOLD", "1"), 0);
  ASSERT_EQ(order("HOLD", "0"), 0);
  pass(0.5);
  EXPECT_EQ(ask("RSTATS"), "194,64") << "it stands, and nothing holds it";
  const std::string stood = ask("RPOSJ");
  pass(5);
  EXPECT_EQ(ask("RPOSJ"), stood);
}

TEST_F(Tcp80Commands, HoldEndsADirectMove) {
  ASSERT_EQ(order("SVON", "1"), 0);
  ASSERT_EQ(order("MOVJ", kMovj), 0);
  pass(0.3);
  ASSERT_EQ(order("HOLD", "1"), 0);
  pass(0.5);
  EXPECT_EQ(ask("RSTATS"), "194,72");
  const std::string stopped = ask("RPOSJ");
  ASSERT_EQ(order("HOLD", "0"), 0);
  pass(2);
  EXPECT_EQ(ask("RPOSJ"), stopped);
}

TEST_F(Tcp80Commands, DeletesJobsThatDoNotRun) {
  ASSERT_EQ(order("SETMJ", "TEST1"), 0);
  ASSERT_EQ(order("JSEQ", "TEST1,0"), 0);
  EXPECT_EQ(order("DELETE", "TEST1"), 0);
  EXPECT_EQ(order("DELETE", "TEST1"), 4040);
  EXPECT_EQ(order("SETMJ", "TEST1"), 4040);
  EXPECT_EQ(order("RJSEQ"), 4060);
  EXPECT_EQ(order("DELETE", "*"), 0);
  EXPECT_EQ(order("RJDIR", "*"), 4040);
}

TEST_F(Tcp80Commands, ShowsMessagesWithCommas) {
  EXPECT_EQ(order("MDSP", "hello, world\r"), 0);
  EXPECT_EQ(state.pendant_message, "hello, world");
  EXPECT_EQ(order("MDSP", std::string(31, 'x')), 1013);
}

TEST(Tcp80Controllers, DifferInContactsFramesAndDecimals) {
  ControllerSettings settings;
  settings.type = "nx100";
  ControllerState nx100(settings);
  EXPECT_EQ(execute_tcp80(nx100, "RPOSC", "0,0").text, "480.000,0.000,255.000,180.00,0.00,0.00,0,1");
  EXPECT_EQ(execute_tcp80(nx100, "IOWRITE", "22010,8,1").text, "0000");
  EXPECT_EQ(execute_tcp80(nx100, "IOWRITE", "27010,8,1").text, "ERROR: IOWRITE is not successful(2120).");
  EXPECT_EQ(execute_tcp80(nx100, "RPOSC", "26,0").text, "ERROR: RPOSC is not successful(1012).");
  settings.type = "fs100";
  ControllerState fs100(settings);
  EXPECT_EQ(execute_tcp80(fs100, "IOWRITE", "25010,8,1").text, "0000");
}

TEST_F(Tcp80Commands, SurvivesAnything) {
  std::mt19937 random(5);
  const auto any = [&](int n) { return std::uniform_int_distribution<int>(0, n - 1)(random); };
  const std::vector<std::string> names = {"RALARM", "RSTATS", "RPOSC", "RJDIR", "SAVEV",  "LOADV", "IOREAD", "IOWRITE",
                                          "HOLD",   "RESET",  "SVON",  "MODE",  "CYCLE",  "START", "JSEQ",   "MOVJ",
                                          "MOVL",   "IMOV",   "PMOVJ", "MDSP",  "DELETE", "XXX"};
  const std::vector<std::string> pieces = {"0",     "1", "4",           "-1",  "99",  "127",   "1e9",
                                           "27010", "8", "400",         "0.5", "nan", "TEST1", "*",
                                           "",      " ", "99999999999", "-0",  "180", "\xff"};
  for (int i = 0; i < 20'000; ++i) {
    std::string operands;
    for (int k = any(20); k > 0; --k)
      operands += pieces[static_cast<std::size_t>(any(static_cast<int>(pieces.size())))] + ",";
    const auto answer =
        execute_tcp80(state, names[static_cast<std::size_t>(any(static_cast<int>(names.size())))], operands);
    ASSERT_EQ(answer.kind == Tcp80Answer::Kind::error, answer.text.starts_with("ERROR: "));
    pass(0.02);
    ASSERT_TRUE(inside_limits(*state.arm, state.q));
  }
}

}  // namespace
}  // namespace pickcell::sim
