#include "pickcell/sim/job_interpreter.hpp"

#include <gtest/gtest.h>

#include <string>

#include "pickcell/core/units.hpp"
#include "pickcell/sim/controller_commands.hpp"
#include "pickcell/sim/position_solver.hpp"

namespace pickcell::sim {
namespace {

constexpr double kTick_s = 0.01;

std::string text(const std::string& instructions, const std::string& name = "JOB1", const std::string& pos = {}) {
  std::string out;
  for (const char c : "/JOB\n//NAME " + name + "\n//POS\n" + pos + "//INST\nNOP\n" + instructions + "END\n")
    out += c == '\n' ? std::string("\r\n") : std::string(1, c);
  return out;
}

struct Runner {
  explicit Runner(std::vector<std::string> jobs)
      : state([&] {
          ControllerSettings settings;
          settings.jobs = std::move(jobs);
          return settings;
        }()) {
    EXPECT_EQ(set_servo(state, true), Refusal::none);
  }
  explicit Runner(const std::string& instructions, const std::string& pos = {})
      : Runner(std::vector<std::string>{text(instructions, "JOB1", pos)}) {
    EXPECT_EQ(start(state, "JOB1"), Refusal::none);
  }
  /// Ticks until the job no longer runs; returns the seconds.
  double run(double limit_s = 100) {
    double t = 0;
    for (; state.running() && t < limit_s; t += kTick_s) run_tick(state, kTick_s);
    return t;
  }
  void ticks(int n) {
    for (int i = 0; i < n; ++i) run_tick(state, kTick_s);
  }
  ControllerState state;
};

const char* const kPositions =
    "///TOOL 1\n///POSTYPE BASE\n///RECTAN\n///RCONF 0,0,0,0,0,0\n"
    "P00001=400.000,100.000,-100.000,180.0000,0.0000,30.0000\n"
    "P00002=400.000,-100.000,-100.000,180.0000,0.0000,30.0000\n"
    "P00003=2000.000,0.000,0.000,180.0000,0.0000,0.0000\n";

TEST(JobInterpreter, CalculatesAndBranches) {
  Runner r(
      "SET B000 250\nSET I000 -5\nSET D000 7\nADD D000 I000\nMUL D000 -3\nDIV D000 4\nSET R000 2.5\nADD R000 1\n"
      "SET S001 \"HELLO\"\nSET S002 S001\nDEC I000\n"
      "IFTHENEXP D000=-1 AND R000>3\nSET B001 1\nELSE\nSET B001 2\nENDIF\n"
      "IFTHENEXP B001=2\nSET B002 1\nELSEIFEXP B001=1 OR B001=7\nSET B002 2\nELSE\nSET B002 3\nENDIF\n"
      "WHILEEXP I001<10\nINC I001\nENDWHILE\n");
  r.run();
  EXPECT_TRUE(r.state.alarms.empty());
  EXPECT_EQ(r.state.D[0], -1);  // (7 - 5) * -3 / 4, towards zero
  EXPECT_FLOAT_EQ(r.state.R[0], 3.5F);
  EXPECT_EQ(r.state.I[0], -6);
  EXPECT_EQ(r.state.B[1], 1);
  EXPECT_EQ(r.state.B[2], 2);
  EXPECT_EQ(r.state.I[1], 10);
  EXPECT_EQ(r.state.S[2], "HELLO");
}

TEST(JobInterpreter, ALoopEndingABranchDoesNotFallIntoTheNextOne) {
  Runner r("SET B000 1\nIFTHENEXP B000=1\nWHILEEXP I001<3\nINC I001\nENDWHILE\nELSE\nSET B009 9\nENDIF\nSET B008 8\n");
  r.run();
  EXPECT_EQ(r.state.I[1], 3);
  EXPECT_EQ(r.state.B[9], 0);
  EXPECT_EQ(r.state.B[8], 8);
}

TEST(JobInterpreter, ReadsAndWritesElementsOfPositions) {
  Runner r("SET P020 P001\nGETE D020 P020 (3)\nADD D020 80000\nSETE P020 (3) D020\nGETE D021 P020 (6)\n", kPositions);
  r.run();
  EXPECT_EQ(r.state.P[20]->axis[2], -20000);
  EXPECT_EQ(r.state.P[1]->axis[2], -100000) << "a copy";
  EXPECT_EQ(r.state.D[21], 300000);
}

TEST(JobInterpreter, TimersTakeTheirTime) {
  Runner r("TIMER T=1.50\nSET B000 1\n");
  EXPECT_NEAR(r.run(), 1.5, 2 * kTick_s);
  EXPECT_EQ(r.state.B[0], 1);
}

TEST(JobInterpreter, WaitsForInputsOrTheTimeout) {
  Runner r("WAIT IN#(1)=ON T=1.00\nJUMP *GOT IF IN#(1)=ON\nSET B000 2\nJUMP *OUT\n*GOT\nSET B000 1\n*OUT\n");
  r.ticks(20);
  EXPECT_TRUE(r.state.running());
  r.state.inputs[1] = true;
  r.run();
  EXPECT_EQ(r.state.B[0], 1);
  EXPECT_EQ(start(r.state, ""), Refusal::none) << "after END the job begins anew";
  r.state.inputs[1] = false;
  EXPECT_NEAR(r.run(), 1.0, 2 * kTick_s);
  EXPECT_EQ(r.state.B[0], 2);
}

TEST(JobInterpreter, OutputsGoOutBeforeTheJobLooksAgain) {
  Runner r("DOUT OT#(1) ON\nSET B000 1\n");
  r.ticks(1);
  ASSERT_EQ(r.state.output_events.size(), 1u);
  EXPECT_EQ(r.state.output_events[0].n, 1);
  EXPECT_TRUE(r.state.output_events[0].on);
  EXPECT_EQ(r.state.B[0], 0);
  r.ticks(1);
  EXPECT_EQ(r.state.B[0], 1);
}

TEST(JobInterpreter, MovesTakeTheTimeOfTheirProfile) {
  Runner r("MOVJ P001 VJ=30.00\nSET B000 1\nMOVL P002 V=200.0 PL=0\nSET B000 2\n", kPositions);
  double t = 0;
  for (; r.state.B[0] == 0; t += kTick_s) run_tick(r.state, kTick_s);
  EXPECT_EQ(present_position(r.state, 0).axis, r.state.P[1]->axis);
  EXPECT_EQ(r.state.task.step, 1);
  EXPECT_TRUE(r.state.status_bits()[0] & 8);
  const double line_s = r.run();
  EXPECT_NEAR(line_s, 0.2 / 0.2 + 0.2 / 3.0, 3 * kTick_s);
  EXPECT_EQ(present_position(r.state, 0).axis, r.state.P[2]->axis);
  EXPECT_FALSE(r.state.status_bits()[0] & 8);
}

TEST(JobInterpreter, HoldStopsInMidMoveAndStartCarriesOn) {
  Runner r("MOVJ P001 VJ=50.00\nSET B000 1\nMOVL P002 V=100.0\nSET B000 2\n", kPositions);
  while (r.state.B[0] == 0) run_tick(r.state, kTick_s);
  r.ticks(100);
  ASSERT_EQ(set_hold(r.state, true), Refusal::none);
  r.ticks(30);
  EXPECT_FALSE(r.state.running());
  const Joints rest = r.state.q;
  EXPECT_EQ(start(r.state, ""), Refusal::held_by_command);
  ASSERT_EQ(set_hold(r.state, false), Refusal::none);
  r.ticks(50);
  EXPECT_EQ(r.state.q, rest) << "releasing the hold alone moves nothing";
  EXPECT_EQ(r.state.B[0], 1);
  ASSERT_EQ(start(r.state, ""), Refusal::none);
  r.run();
  EXPECT_EQ(r.state.B[0], 2);
  EXPECT_EQ(present_position(r.state, 0).axis, r.state.P[2]->axis);
}

TEST(JobInterpreter, HoldInATimerKeepsTheRestOfIt) {
  Runner r("TIMER T=1.00\nSET B000 1\n");
  r.ticks(50);
  r.state.hold_pendant = true;
  r.ticks(500);
  EXPECT_FALSE(r.state.running());
  r.state.hold_pendant = false;
  ASSERT_EQ(start(r.state, ""), Refusal::none);
  EXPECT_NEAR(r.run(), 0.5, 3 * kTick_s);
}

TEST(JobInterpreter, EmergencyStopAndAlarmStopTheArmWithinTheirRamp) {
  for (const bool alarm : {false, true}) {
    Runner r("MOVJ P001 VJ=50.00\nMOVL P002 V=100.0\n", kPositions);
    r.ticks(150);
    ASSERT_TRUE(r.state.move.has_value());
    if (alarm)
      r.state.raise_alarm({4107, 1, "test"});
    else
      r.state.press_emergency_stop();
    r.ticks(6);
    const Joints rest = r.state.q;
    r.ticks(100);
    EXPECT_EQ(r.state.q, rest);
    EXPECT_FALSE(r.state.running());
    EXPECT_FALSE(r.state.servo);
    EXPECT_EQ(set_servo(r.state, true), alarm ? Refusal::alarm_or_error : Refusal::servo_cannot_go_on);
    r.state.release_emergency_stop();
    ASSERT_EQ(reset_alarms(r.state), Refusal::none);
    ASSERT_EQ(set_servo(r.state, true), Refusal::none);
    ASSERT_EQ(start(r.state, ""), Refusal::none);
    r.run();
    EXPECT_EQ(present_position(r.state, 0).axis, r.state.P[2]->axis);
  }
}

TEST(JobInterpreter, FaultsOfTheJobAreAlarmsAndStopIt) {
  const std::pair<const char*, int> faults[] = {{"MOVJ P003 VJ=10.00\n", kAlarmOutOfReach},
                                                {"MOVL P003 V=10.0\n", kAlarmOutOfReach},
                                                {"MOVJ P050 VJ=10.00\n", kAlarmUndefinedPosition},
                                                {"SET P001 P050\n", kAlarmUndefinedPosition},
                                                {"SET B000 256\n", kAlarmVariableRange},
                                                {"SET B100 1\n", kAlarmVariableRange},
                                                {"SET I000 D000\nSET D000 40000\nSET I000 D000\n", kAlarmVariableRange},
                                                {"DIV D000 0\n", kAlarmVariableRange},
                                                {"CALL JOB:NONE\n", kAlarmNoSuchJob},
                                                {"*A\nDOUT OT#(5000) ON\n", kAlarmVariableRange},
                                                {"WAIT B200=1\n", kAlarmVariableRange}};
  for (const auto& [instructions, code] : faults) {
    Runner r(std::string(instructions) + "SET B077 1\n", kPositions);
    r.run();
    ASSERT_EQ(r.state.alarms.size(), 1u) << instructions;
    EXPECT_EQ(r.state.alarms[0].code, code) << instructions;
    EXPECT_EQ(r.state.B[77], 0) << instructions;
    EXPECT_FALSE(r.state.servo);
  }
}

TEST(JobInterpreter, CallsJobsAndReturns) {
  Runner r(std::vector<std::string>{text("CALL JOB:SUB IF B000=0\nSET B001 B000\n", "MAIN"),
                                    text("INC B000\nRET\nINC B000\n", "SUB")});
  ASSERT_EQ(start(r.state, "MAIN"), Refusal::none);
  r.run();
  EXPECT_EQ(r.state.B[1], 1);
}

TEST(JobInterpreter, EndlessRecursionIsAnAlarm) {
  Runner r("CALL JOB:JOB1\n");
  r.run();
  ASSERT_FALSE(r.state.alarms.empty());
}

TEST(JobInterpreter, FollowsTheCycleMode) {
  Runner r("INC B000\nTIMER T=0.05\n");
  r.run();
  EXPECT_EQ(r.state.B[0], 1);
  ASSERT_EQ(set_cycle(r.state, CycleMode::continuous), Refusal::none);
  ASSERT_EQ(start(r.state, "JOB1"), Refusal::none);
  r.run(1.0);
  EXPECT_TRUE(r.state.running());
  EXPECT_GT(r.state.B[0], 10);
  r.state.hold_pendant = true;
  r.run();
  r.state.hold_pendant = false;
  ASSERT_EQ(set_cycle(r.state, CycleMode::step), Refusal::none);
  ASSERT_EQ(select_job(r.state, "JOB1", 1), Refusal::none);
  const int before = r.state.B[0];
  ASSERT_EQ(start(r.state, ""), Refusal::none);
  r.run();
  EXPECT_EQ(r.state.B[0], before + 1);
  EXPECT_EQ(r.state.task.at.line, 2u);
}

TEST(JobInterpreter, ABusyLoopLeavesRoomForEverythingElse) {
  Runner r("*A\nINC I000\nJUMP *A IF I000<30000\nSET B000 1\n");
  r.ticks(1);
  EXPECT_LT(r.state.I[0], 60);
  EXPECT_EQ(r.state.task.at.job->name, "JOB1");
  r.run();
  EXPECT_EQ(r.state.B[0], 1);
}

}  // namespace
}  // namespace pickcell::sim
