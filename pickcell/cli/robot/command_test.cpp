// `pickcell robot LINK ...` against the simulated controller, over both protocols.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <sstream>

#include "pickcell/cli/robot/jobs.hpp"
#include "pickcell/cli/robot/link.hpp"
#include "pickcell/cli/robot/moves.hpp"
#include "pickcell/cli/robot/names.hpp"
#include "pickcell/cli/subcommand.hpp"
#include "pickcell/sim/controller.hpp"
#include "pickcell/sim/shipped_jobs.hpp"

namespace pickcell::cli {
namespace {

using ::testing::HasSubstr;

class RobotCommand : public ::testing::TestWithParam<const char*> {
 protected:
  void SetUp() override {
    sim::ControllerSettings settings;
    settings.jobs = sim::shipped_jobs();
    settings.motoros_port = 0;
    auto on = sim::Controller::switch_on(settings, clock_, nullptr);
    ASSERT_TRUE(on) << on.error().line();
    controller_ = std::move(*on);
  }
  std::string link() const {
    const std::string protocol = GetParam();
    const int port = protocol == "hses"      ? controller_->hses_port()
                     : protocol == "motoros" ? controller_->motoros_port()
                                             : controller_->tcp80_port();
    return protocol + "://127.0.0.1:" + std::to_string(port) + (protocol == "motoros" ? "/gp7" : "");
  }
  int robot(std::vector<std::string> words) {
    words.insert(words.begin(), {"robot", link()});
    std::ostringstream out, err;
    const int code = run(std::move(words), {out, err});
    out_ = out.str(), err_ = err.str();
    return code;
  }
  core::Json json() const { return core::parse_json(out_, "answer").value(); }
  template <class T>
  T state(T (*look)(const sim::ControllerState&)) {
    return look(controller_->copy_of_state());
  }

  core::RealClock clock_;
  std::unique_ptr<sim::Controller> controller_;
  std::string out_, err_;
};

TEST_P(RobotCommand, StatusSaysWhatIsMissing) {
  ASSERT_EQ(robot({"status", "--json", "--reads", "5"}), 0) << err_;
  EXPECT_EQ(json()["mode"].string(), "play");
  EXPECT_EQ(json()["ready"].boolean(), true);
  EXPECT_NEAR(json()["pose_base"]["z_mm"].number().value(), 255, 1e-6);
  EXPECT_EQ(json()["answer_ms"]["reads"].integer(), 5);
  controller_->with_state([](sim::ControllerState& s) {
    s.turn_key_to_teach();
    s.raise_alarm({4107, 3, "OUT OF RANGE"});
    s.jobs.erase("VISPICK");
  });
  ASSERT_EQ(robot({"status"}), 0);
  EXPECT_THAT(out_, HasSubstr("alarm 4107 [3]"));
  EXPECT_THAT(out_, HasSubstr("missing:   the key switch stands on TEACH; turn it to REMOTE"));
  EXPECT_THAT(out_, HasSubstr("missing:   command remote is not on"));
  EXPECT_THAT(out_, HasSubstr("missing:   there is no job VISPICK"));
  ASSERT_EQ(robot({"alarms", "--json"}), 0);
  EXPECT_EQ(json()["alarms"].items().at(0)["code"].integer(), 4107);
}

TEST_P(RobotCommand, WhatIsWrittenIsRead) {
  ASSERT_EQ(
      robot({"write", "B020=7", "I020=-5", "D020=100000", "R020=1.5", "P020=300,-10.5,20,180,0,45,2,3", "27011=1"}), 0)
      << err_;
  ASSERT_EQ(robot({"read", "B020", "I020", "D020", "R020", "P020", "27011", "27010", "--json"}), 0) << err_;
  EXPECT_EQ(
      out_,
      "{\"B020\":7,\"I020\":-5,\"D020\":100000,\"R020\":1.5,\"P020\":{\"x_mm\":300.0,\"y_mm\":-10.5,\"z_mm\":20.0,"
      "\"rx_deg\":180.0,\"ry_deg\":0.0,\"rz_deg\":45.0,\"frame\":3,\"tool\":2},\"27011\":true,\"27010\":false}\n");
  EXPECT_EQ(state<int>([](const sim::ControllerState& s) { return int{s.B[20]}; }), 7);
  for (const char* bad :
       {"B020=256", "B020=1.5", "I020=40000", "X1=1", "B020", "P020=1,2,3", "27011=2", "27018=1", "R001=x"})
    EXPECT_EQ(robot({"write", bad}), 2) << bad;
  EXPECT_EQ(robot({"read", "B777"}), 3) << "the controller has none";
  EXPECT_EQ(robot({"write", "10=1"}), 3) << "an input of the machine is not writable";
}

TEST_P(RobotCommand, WhatIsRefusedDoesNotHideTheRest) {
  EXPECT_EQ(robot({"read", "B010", "P099", "D010", "--json"}), 3);
  EXPECT_EQ(out_, "{\"B010\":0,\"D010\":0}\n");
  EXPECT_THAT(err_, HasSubstr("pickcell: P099: "));
}

TEST_P(RobotCommand, StringsCyclesMessagesAndTheJobToCome) {
  ASSERT_EQ(robot({"write", "S005=PART LEFT"}), 0) << err_;
  EXPECT_EQ(out_, "S005 = \"PART LEFT\"\n");
  EXPECT_EQ(robot({"write", "S005=" + std::string(33, 'A')}), 2);
  EXPECT_EQ(robot({"write", "S005=A\rB"}), 2);
  ASSERT_EQ(robot({"cycle", "continuous"}), 0) << err_;
  EXPECT_TRUE(state<bool>([](const sim::ControllerState& s) { return s.cycle == sim::CycleMode::continuous; }));
  EXPECT_EQ(robot({"cycle", "twice"}), 2);
  ASSERT_EQ(robot({"message", "Hello, you"}), 0) << err_;
  EXPECT_EQ(robot({"message", std::string(31, 'A')}), 2);
  ASSERT_EQ(robot({"job", "select", "TEST2"}), 0) << err_;
  ASSERT_EQ(robot({"job", "master", "TEST1"}), 0) << err_;
  EXPECT_EQ(state<std::string>([](const sim::ControllerState& s) { return s.master_job; }), "TEST1");
  EXPECT_EQ(robot({"job", "select", "A\rB"}), 2);
  EXPECT_EQ(robot({"servo", "on"}), 3);
  ASSERT_EQ(robot({"servo", "on", "--allow-motion"}), 0) << err_;
  EXPECT_TRUE(state<bool>([](const sim::ControllerState& s) { return s.servo; }));
}

TEST_P(RobotCommand, TheHistoryOfAlarms) {
  controller_->with_state([](sim::ControllerState& s) {
    s.raise_alarm({4107, 3, "OUT OF RANGE"});
    s.reset_at_pendant();
  });
  const bool hses = std::string(GetParam()) == "hses";
  ASSERT_EQ(robot({"alarms", "--history", "5", "--json"}), hses ? 0 : 2) << err_;
  if (hses) {
    EXPECT_THAT(out_, HasSubstr("4107"));
  }
}

TEST_P(RobotCommand, NothingMovesWithoutPermission) {
  for (const std::vector<std::string>& words : std::vector<std::vector<std::string>>{
           {"jog", "z", "-1"}, {"goto", "470,0,250"}, {"home"}, {"job", "start", "VISPICK"}}) {
    EXPECT_EQ(robot(words), 3) << words[0];
    EXPECT_THAT(err_, HasSubstr("--allow-motion"));
  }
  EXPECT_FALSE(state<bool>([](const sim::ControllerState& s) { return s.servo || s.running(); }));
}

TEST_P(RobotCommand, JogsAndGoes) {
  ASSERT_EQ(robot({"jog", "z", "-2", "--allow-motion", "--json"}), 0) << err_;
  EXPECT_NEAR(json()["pose_base"]["z_mm"].number().value(), 253, 0.01);
  ASSERT_EQ(robot({"goto", "482,1,253", "--line", "--allow-motion", "--json"}), 0) << err_;
  EXPECT_NEAR(json()["pose_base"]["x_mm"].number().value(), 482, 0.01);
  ASSERT_EQ(robot({"jog", "rz", "2", "--allow-motion", "--json"}), 0) << err_;
  EXPECT_NEAR(json()["pose_base"]["rz_deg"].number().value(), 2, 0.001);
  ASSERT_EQ(robot({"goto", "480,0,255,180,0,0", "--speed-pct", "5", "--allow-motion", "--json"}), 0) << err_;
  EXPECT_NEAR(json()["pose_base"]["x_mm"].number().value(), 480, 0.01);
}

TEST_P(RobotCommand, TargetsAreCheckedBeforeAnythingIsSent) {
  const auto refused = [&](std::vector<std::string> words, const char* why) {
    words.push_back("--allow-motion");
    EXPECT_EQ(robot(words), 3) << why;
    EXPECT_THAT(err_, HasSubstr(why));
  };
  refused({"goto", "1200,0,255"}, "more than 500.0 mm");
  refused({"goto", "480,0,100", "--box", "400,-100,200,500,100,300"}, "z = 100.0 mm is outside the box");
  refused({"goto", "480,0,255,180,0,170"}, "turns by");
  refused({"goto", "480,0,250", "--speed-pct", "50"}, "--speed-pct");
  refused({"jog", "x", "1", "--speed-mm-s", "51"}, "--speed-mm-s");
  EXPECT_EQ(robot({"jog", "x", "1", "--allow-motion", "--max-speed-mm-s", "1000"}), 2);
  EXPECT_EQ(robot({"goto", "nan,0,0", "--allow-motion"}), 2);
  EXPECT_EQ(robot({"jog", "w", "1", "--allow-motion"}), 2);
  controller_->with_state([](sim::ControllerState& s) { s.turn_key_to_teach(); });
  refused({"jog", "x", "1"}, "the key switch stands on TEACH");
  EXPECT_FALSE(state<bool>([](const sim::ControllerState& s) { return s.servo; }));
}

TEST_P(RobotCommand, AnAlarmInTheMoveLeavesTheArmHeld) {
  sim::FaultEvent event;
  event.fault = sim::Fault::alarm;
  event.mid_move = true;
  controller_->inject(event);
  EXPECT_EQ(robot({"jog", "z", "-20", "--allow-motion"}), 3);
  EXPECT_THAT(err_, HasSubstr("stopped: the controller is in alarm; the arm is held"));
  EXPECT_TRUE(state<bool>([](const sim::ControllerState& s) { return s.hold_command; }));
  ASSERT_EQ(robot({"reset"}), 0) << err_;
  EXPECT_FALSE(state<bool>([](const sim::ControllerState& s) { return s.held() || !s.alarms.empty(); }));
}

TEST_P(RobotCommand, ALostAnswerToAMoveIsNeverAnsweredByAnotherMove) {
  for (const sim::Fault fault : {sim::Fault::drop, sim::Fault::truncate}) {
    sim::FaultEvent event;
    event.fault = fault;
    event.after_command = "IMOV";
    controller_->follow({event});
    EXPECT_EQ(robot({"jog", "z", "-3", "--allow-motion"}), 3);
    EXPECT_THAT(err_, HasSubstr("the arm is held"));
    controller_->follow({});
    ASSERT_EQ(robot({"reset"}), 0) << err_;
  }
  EXPECT_GE(controller_->T_base_tool().translation_m().z(), 0.255 - 2 * 0.003 - 1e-6) << "each was carried out once";
}

TEST_P(RobotCommand, JobsAreListedAndTransferred) {
  const std::string folder = ::testing::TempDir() + "pickcell_robot_jobs_" + GetParam();
  std::filesystem::create_directories(folder);
  ASSERT_EQ(robot({"job", "list", "--json"}), 0) << err_;
  EXPECT_EQ(json()["jobs"].items().size(), 3u);
  const std::string text =
      "/JOB\r\n//NAME MINE\r\n//POS\r\n///NPOS 0,0,0,0,0,0\r\n//INST\r\n///DATE 2026/11/22 08:00\r\n"
      "///ATTR SC,RW\r\n///GROUP1 RB1\r\nNOP\r\nSET B030 9\r\nEND\r\n";
  std::ofstream(folder + "/MINE.JBI", std::ios::binary) << text;
  std::ofstream(folder + "/LF.JBI", std::ios::binary) << "/JOB\n//NAME LF\n//INST\nNOP\nEND\n";
  const bool files = std::string(GetParam()) == "hses";
  EXPECT_EQ(robot({"job", "upload", folder + "/LF.JBI"}), 2);
  EXPECT_EQ(robot({"job", "upload", folder + "/MINE.JBI"}), files ? 0 : 2) << err_;
  if (files) {
    ASSERT_EQ(robot({"job", "show", "MINE"}), 0);
    EXPECT_EQ(out_, text);
    ASSERT_EQ(robot({"job", "download", "VISPICK", "-o", folder + "/V.JBI"}), 0);
    std::ifstream in(folder + "/V.JBI", std::ios::binary);
    const std::string got((std::istreambuf_iterator<char>(in)), {});
    EXPECT_EQ(got, state<std::string>([](const sim::ControllerState& s) { return s.jobs.at("VISPICK")->text; }));
    ASSERT_EQ(robot({"job", "start", "MINE", "--allow-motion"}), 0) << err_;
  }
  EXPECT_EQ(robot({"job", "delete", "TEST1"}), 0) << err_;
  EXPECT_FALSE(state<bool>([](const sim::ControllerState& s) { return s.jobs.contains("TEST1"); }));
  EXPECT_EQ(robot({"job", "delete", "NONE"}), 3);
  EXPECT_EQ(robot({"job", "dance"}), 2);
  std::filesystem::remove_all(folder);
}

INSTANTIATE_TEST_SUITE_P(Over, RobotCommand, ::testing::Values("tcp80", "hses"),
                         [](const auto& tested) { return std::string(tested.param); });

/// Over MotoROS there are neither variables nor jobs; what there is, works, and the rest is said in words.
class RobotCommandOverMotoRos : public RobotCommand {};

TEST_P(RobotCommandOverMotoRos, SaysWhatItHas) {
  ASSERT_EQ(robot({"status"}), 0) << err_;
  EXPECT_THAT(out_, HasSubstr("base:      X 480.000 Y 0.000"));
  EXPECT_THAT(out_, HasSubstr("missing:   picks need the job VISPICK, and MotoROS has no jobs"));
  EXPECT_EQ(robot({"read", "B010"}), 2);
  ASSERT_EQ(robot({"write", "M100=700", "27010=1"}), 0) << err_;
  EXPECT_EQ(out_, "M100 = 700\n27010 = true\n");
  EXPECT_EQ(robot({"job", "start", "VISPICK", "--allow-motion"}), 2);
  EXPECT_EQ(err_.find("held"), std::string::npos) << err_;
}

TEST_P(RobotCommandOverMotoRos, MovesStopsAndResets) {
  ASSERT_EQ(robot({"jog", "z", "-2", "--allow-motion", "--json"}), 0) << err_;
  EXPECT_NEAR(json()["pose_base"]["z_mm"].number().value(), 403, 0.01) << "of the flange";
  EXPECT_EQ(robot({"goto", "900,0,403", "--max-way-mm", "2000", "--allow-motion"}), 3);
  EXPECT_THAT(err_, HasSubstr("out of reach"));
  EXPECT_EQ(err_.find("held"), std::string::npos) << "nothing was sent, nothing is held: " << err_;
  ASSERT_EQ(robot({"hold"}), 0) << err_;
  EXPECT_THAT(out_, HasSubstr("no hold stays"));
  ASSERT_EQ(robot({"reset"}), 0) << err_;
}

INSTANTIATE_TEST_SUITE_P(Over, RobotCommandOverMotoRos, ::testing::Values("motoros"));

TEST(RobotLink, IsTakenApart) {
  EXPECT_EQ(parse_robot_link("tcp80://10.0.0.2", "x")->port, 80);
  EXPECT_EQ(parse_robot_link("hses://10.0.0.2", "x")->port, 10040);
  EXPECT_EQ(parse_robot_link("motoros://arm.local:50300", "x")->host, "arm.local");
  for (const char* bad : {"hses://h:65535", "tcp80://h:0", "tcp80://", "tcp80://:80", "udp://h", "h", "hses://h:1x"}) {
    const auto refused = parse_robot_link(bad, "robot");
    ASSERT_FALSE(refused) << bad;
    EXPECT_EQ(core::exit_code(refused.error().code), 2);
  }
}

TEST(RobotLink, NobodyThereIsAnErrorOfTheLink) {
  std::ostringstream out, err;
  EXPECT_EQ(run({"robot", "hses://127.0.0.1:1", "status"}, {out, err}), 3);
  EXPECT_THAT(err.str(), HasSubstr("nobody listens there"));
}

}  // namespace
}  // namespace pickcell::cli
