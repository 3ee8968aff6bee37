#include "pickcell/sim/controller.hpp"

#include <gtest/gtest.h>

#include "pickcell/sim/loopback_test.hpp"
#include "pickcell/sim/shipped_jobs.hpp"

namespace pickcell::sim {
namespace {

using namespace std::chrono_literals;

/// A gripper whose sensor sees something whenever it is closed, and a list of what was heard.
class Gripper final : public Plant {
 public:
  void output_changed(int n, bool on, const ToolPose& T_base_tool, core::TimePoint t) override {
    const std::lock_guard lock(mutex_);
    if (n != kGripperOutput) return;
    closed_ = on;
    events.push_back({on, T_base_tool, t});
  }
  bool input(int n, core::TimePoint) override {
    const std::lock_guard lock(mutex_);
    return n == kGripSensorInput && closed_ && grips;
  }
  void contact_written(int contact, bool on, core::TimePoint) override {
    const std::lock_guard lock(mutex_);
    contacts.emplace_back(contact, on);
  }
  struct Event {
    bool closed;
    ToolPose T_base_tool;
    core::TimePoint t;
  };
  std::vector<Event> events;
  std::vector<std::pair<int, bool>> contacts;
  bool grips = true;

 private:
  std::mutex mutex_;
  bool closed_ = false;
};

/// The PC's side of the hand-over as raw commands, in the clock's time.
class Rig {
 public:
  Rig() {
    ControllerSettings settings;
    settings.jobs = shipped_jobs();
    controller = std::move(*Controller::switch_on(settings, clock, &gripper));
    connect();
  }
  void connect() {
    host = std::make_unique<LoopbackHost>(controller->tcp80_port());
    host->send("CONNECT Robot_access Keep-Alive:-1\r\n");
    ASSERT_EQ(host->until("\n").substr(0, 3), "OK:");
  }
  std::string ask(const std::string& command, const std::string& operands = {}) {
    std::string answer = host->command(command, operands);
    if (answer.starts_with("0000") || answer.starts_with("ERROR")) (void)host->until("\n");
    return answer.substr(0, answer.find('\r'));
  }
  void write(const std::string& what) { ASSERT_EQ(ask("LOADV", what), "0000") << what; }
  bool wait_for(const std::string& variable, const std::string& value, double limit_s = 30) {
    const double end = core::seconds(clock.now()) + limit_s;
    while (core::seconds(clock.now()) < end) {
      if (ask("SAVEV", variable) == value) return true;
      seat->sleep_for(50ms);
    }
    return false;
  }
  void start_job() {
    ASSERT_EQ(ask("SVON", "1"), "0000");
    ASSERT_EQ(ask("START", "VISPICK"), "0000");
    ASSERT_TRUE(wait_for("0,12", "1"));
  }
  void hand_over(int sequence) {
    write("4,10,1,0,450.000,120.000,-200.000,180.0000,0.0000,35.0000,0,1");
    write("4,11,1,0,400.000,-200.000,-150.000,180.0000,0.0000,-90.0000,0,1");
    write("1,13,0");
    write("2,13," + std::to_string(sequence));
    write("2,10," + std::to_string(sequence));
    write("0,10,1");
  }
  core::SimulatedClock clock;
  std::unique_ptr<core::Seat> seat = clock.join("cell");
  Gripper gripper;
  std::unique_ptr<Controller> controller;
  std::unique_ptr<LoopbackHost> host;
};

class Cell : public testing::Test, protected Rig {};

TEST_F(Cell, PicksAndPlacesByTheHandshake) {
  start_job();
  const double before = core::seconds(clock.now());
  hand_over(1);
  ASSERT_TRUE(wait_for("0,10", "3"));
  const double took = core::seconds(clock.now()) - before;
  EXPECT_EQ(ask("SAVEV", "2,11"), "1");
  EXPECT_EQ(ask("SAVEV", "0,13"), "3");
  EXPECT_GT(took, 3);
  EXPECT_LT(took, 15);
  ASSERT_EQ(gripper.events.size(), 2u);
  EXPECT_TRUE(gripper.events[0].closed);
  const auto place_of = [&](std::size_t i) { return cartesian_from_pose(gripper.events[i].T_base_tool.iso()); };
  EXPECT_EQ(place_of(0), (Cartesian{450000, 120000, -200000, 1800000, 0, 350000}));
  EXPECT_EQ(place_of(1), (Cartesian{400000, -200000, -150000, 1800000, 0, -900000}));
}

TEST_F(Cell, AnEmptyGripIsRefusedWithReasonTwo) {
  gripper.grips = false;
  start_job();
  hand_over(1);
  ASSERT_TRUE(wait_for("0,10", "9"));
  EXPECT_EQ(ask("SAVEV", "0,11"), "2");
}

TEST_F(Cell, TheSameSequenceNeverMovesTwice) {
  start_job();
  hand_over(1);
  ASSERT_TRUE(wait_for("0,10", "3"));
  ASSERT_TRUE(wait_for("0,12", "1"));
  const std::string stands = ask("RPOSJ");
  write("0,10,1");
  ASSERT_TRUE(wait_for("0,10", "3"));
  EXPECT_EQ(ask("RPOSJ"), stands);
  EXPECT_EQ(gripper.events.size(), 2u);
}

TEST_F(Cell, AnAlarmInMidMoveStopsTheJobAndIsRead) {
  start_job();
  FaultEvent event;
  event.fault = Fault::alarm;
  event.mid_move = true;
  event.code = 4107;
  controller->inject(event);
  hand_over(1);
  seat->sleep_for(2s);
  EXPECT_EQ(ask("RALARM"), "0,0,4107,0,0,0,0,0,0,0");
  EXPECT_EQ(ask("RSTATS"), "194,16");
  EXPECT_EQ(ask("START"), "ERROR: START is not successful(2060).");
  EXPECT_EQ(ask("SAVEV", "0,10"), "2") << "taken, not finished";
  ASSERT_EQ(ask("RESET"), "0000");
  ASSERT_EQ(ask("SVON", "1"), "0000");
  ASSERT_EQ(ask("START"), "0000");
  EXPECT_TRUE(wait_for("0,10", "3"));
  EXPECT_EQ(gripper.events.size(), 2u);
}

TEST_F(Cell, AKilledControllerKnowsItsRegistersAndWaitsForAPerson) {
  start_job();
  hand_over(1);
  ASSERT_TRUE(wait_for("0,10", "2"));
  seat->sleep_for(1s);
  controller->kill();
  seat->sleep_for(1s);
  ASSERT_TRUE(controller->revive().has_value());
  connect();
  EXPECT_EQ(ask("SAVEV", "2,12"), "1");
  EXPECT_EQ(ask("SAVEV", "2,11"), "0");
  ASSERT_EQ(ask("SVON", "1"), "0000");
  ASSERT_EQ(ask("START", "VISPICK"), "0000");
  const std::string stands = ask("RPOSJ");
  seat->sleep_for(5s);
  EXPECT_EQ(ask("RPOSJ"), stands) << "an accepted pick without outcome: no motion";
}

TEST_F(Cell, ScenariosActInTheClocksTime) {
  auto config = core::Config::parse(
      "[[event]]\nat_s = 2\nfault = \"hold\"\n[[event]]\nafter_command = \"HOLD\"\nfault = \"teach\"\n", "scenario");
  ASSERT_TRUE(config.has_value());
  auto events = parse_scenario(*config);
  ASSERT_TRUE(events.has_value()) << events.error().line();
  controller->follow(std::move(*events));
  seat->sleep_for(1900ms);
  EXPECT_EQ(ask("RSTATS"), "194,0");
  seat->sleep_for(200ms);
  EXPECT_EQ(ask("RSTATS"), "194,2");
  EXPECT_EQ(ask("HOLD", "1"), "0000");
  EXPECT_EQ(ask("RSTATS"), "34,10");
  EXPECT_EQ(ask("HOLD", "0"), "ERROR: HOLD is not successful(2100).");
}

TEST_F(Cell, NetworkInputsReachThePlant) {
  EXPECT_EQ(ask("IOWRITE", "27010,8,1"), "0000");
  EXPECT_EQ(ask("IOWRITE", "27010,8,0"), "0000");
  EXPECT_EQ(gripper.contacts, (std::vector<std::pair<int, bool>>{{27010, true}, {27010, false}}));
}

TEST(Controller, TheSameRunTakesTheSameTimeEveryTime) {
  const auto run = [] {
    Rig rig;
    rig.start_job();
    rig.hand_over(1);
    EXPECT_TRUE(rig.wait_for("0,10", "3"));
    return std::pair(rig.clock.now(), rig.gripper.events.at(0).t);
  };
  EXPECT_EQ(run(), run());
}

/// Switched off at any moment, also while the clock stands because somebody else is awake.
TEST(Controller, CanBeSwitchedOffWhileTimeStandsStill) {
  for (int i = 0; i < 20; ++i) {
    core::SimulatedClock clock;
    auto awake = clock.join("cell");
    auto controller = std::move(*Controller::switch_on({}, clock, nullptr));
    LoopbackHost host(controller->tcp80_port());
    host.send("CONNECT Robot_access Keep-Alive:-1\r\nHOSTCTRL_REQUEST RSTATS 0\r\n");
    if (i % 2 == 0) awake->sleep_for(15ms);
    controller.reset();
  }
}

TEST(Controller, LivesInRealTimeToo) {
  core::RealClock clock;
  ControllerSettings settings;
  settings.jobs = {"/JOB\r\n//NAME J\r\n//INST\r\nNOP\r\nTIMER T=0.05\r\nSET B000 1\r\nEND\r\n"};
  auto controller = std::move(*Controller::switch_on(settings, clock, nullptr));
  LoopbackHost host(controller->tcp80_port());
  host.send("CONNECT Robot_access Keep-Alive:-1\r\n");
  (void)host.until("\n");
  EXPECT_EQ(host.command("SVON", "1"), "0000\r");
  (void)host.until("\n");
  EXPECT_EQ(host.command("START", "J"), "0000\r");
  (void)host.until("\n");
  const auto end = std::chrono::steady_clock::now() + 10s;
  while (host.command("SAVEV", "0,0") != "1\r" && std::chrono::steady_clock::now() < end) {
  }
  EXPECT_EQ(host.command("SAVEV", "0,0"), "1\r");
}

TEST(Controller, RefusesSettingsThatCannotBe) {
  core::SimulatedClock clock;
  ControllerSettings settings;
  settings.type = "abc";
  EXPECT_THROW((void)Controller::switch_on(settings, clock, nullptr), std::invalid_argument);
  settings = {};
  settings.jobs = {"/JOB\n"};
  EXPECT_THROW((void)Controller::switch_on(settings, clock, nullptr), std::invalid_argument);
  settings = {};
  settings.bind = "not an address";
  auto result = Controller::switch_on(settings, clock, nullptr);
  ASSERT_FALSE(result.has_value());
  EXPECT_EQ(result.error().code, core::ErrorCode::usage);
}

TEST(Scenario, RefusesWhatItDoesNotKnow) {
  const auto refused = [](const std::string& text) {
    auto config = core::Config::parse(text, "s.toml");
    if (!config) return config.error().line();
    auto events = parse_scenario(*config);
    return events ? std::string() : events.error().line();
  };
  EXPECT_EQ(refused("[[event]]\nat_s = 1\nfault = \"drop\"\ncount = 3\n"), "");
  EXPECT_EQ(refused("[[event]]\nafter_command = 12\nfault = \"double\"\n"), "");
  EXPECT_NE(refused("[[event]]\nat_s = 1\nfault = \"fire\"\n").find("fault"), std::string::npos);
  EXPECT_NE(refused("[[event]]\nfault = \"drop\"\n").find("at_s"), std::string::npos);
  EXPECT_NE(refused("[[event]]\nat_s = 1\nafter_command = \"START\"\nfault = \"drop\"\n"), "");
  EXPECT_NE(refused("[[event]]\nat_s = 1\nfault = \"drop\"\ncuont = 3\n").find("count"), std::string::npos);
  EXPECT_EQ(refused("[[event]]\nat_s = 0\nfault = \"busy\"\n"), "");
  for (const char* at_s : {"-1", "-0.001", "nan", "+inf", "-inf", "1e300", "\"soon\""})
    EXPECT_NE(refused(std::string("[[event]]\nat_s = ") + at_s + "\nfault = \"drop\"\n").find("at_s"),
              std::string::npos)
        << at_s;
  for (const char* command : {"START", "MDSP", "FILE", "0x89", "JOINTTRAJPT", "1"})
    EXPECT_EQ(refused(std::string("[[event]]\nafter_command = \"") + command + "\"\nfault = \"drop\"\n"), "")
        << command;
  for (const char* command : {"start", "STRAT", "PMOVL", "0x72", "-1", "0", "", "1.5"})
    EXPECT_NE(refused(std::string("[[event]]\nafter_command = \"") + command + "\"\nfault = \"drop\"\n")
                  .find("after_command"),
              std::string::npos)
        << command;
}

}  // namespace
}  // namespace pickcell::sim
