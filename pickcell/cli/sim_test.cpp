#include <fcntl.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cstdio>
#include <fstream>
#include <string>
#include <vector>

#include "pickcell/sim/loopback_test.hpp"

namespace pickcell::cli {
namespace {

/// `pickcell sim ...` as a process.
class SimProcess {
 public:
  explicit SimProcess(const std::vector<std::string>& options) {
    std::array<int, 2> ends{};
    if (::pipe2(ends.data(), O_CLOEXEC) != 0) return;
    std::vector<std::string> words{PICKCELL_BINARY, "sim"};
    words.insert(words.end(), options.begin(), options.end());
    std::vector<char*> argv;
    for (std::string& word : words) argv.push_back(word.data());
    argv.push_back(nullptr);
    pid_ = ::fork();
    if (pid_ == 0) {
      (void)::dup2(ends[1], STDOUT_FILENO);
      (void)::dup2(ends[1], STDERR_FILENO);
      ::execv(argv[0], argv.data());
      ::_exit(127);
    }
    (void)::close(ends[1]);
    out_ = ends[0];
  }
  ~SimProcess() {
    if (pid_ > 0) (void)stop(SIGKILL);
    if (out_ >= 0) (void)::close(out_);
  }
  SimProcess(const SimProcess&) = delete;
  SimProcess& operator=(const SimProcess&) = delete;

  /// What it prints up to and including the line; everything when it ends before.
  std::string until(const std::string& line) {
    std::array<char, 512> buffer{};
    while (said_.find(line) == std::string::npos) {
      pollfd p{out_, POLLIN, 0};
      const ssize_t n = ::poll(&p, 1, 20'000) > 0 ? ::read(out_, buffer.data(), buffer.size()) : 0;
      if (n <= 0) break;
      said_.append(buffer.data(), static_cast<std::size_t>(n));
    }
    return said_;
  }
  int exit_code() {
    int status = 0;
    (void)::waitpid(pid_, &status, 0);
    pid_ = -1;
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  }
  int stop(int signal) {
    (void)::kill(pid_, signal);
    return exit_code();
  }

 private:
  pid_t pid_ = -1;
  int out_ = -1;
  std::string said_;
};

int port_in(const std::string& said, const std::string& door = "tcp80") {
  const std::string before = door + ": listening on 127.0.0.1:";
  const std::size_t at = said.find(before);
  return at == std::string::npos ? 0 : std::stoi(said.substr(at + before.size()));
}

/// A scenario file for as long as the test runs.
class Scenario {
 public:
  explicit Scenario(const std::string& text)
      : path_(testing::TempDir() + "pickcell_scenario_" + std::to_string(::getpid()) + ".toml") {
    std::ofstream(path_) << text;
  }
  ~Scenario() { (void)std::remove(path_.c_str()); }
  Scenario(const Scenario&) = delete;
  Scenario& operator=(const Scenario&) = delete;
  [[nodiscard]] std::vector<std::string> options() const { return {"--tcp80-port", "0", "--scenario", path_}; }

 private:
  std::string path_;
};

/// Connected and greeted.
struct Host : sim::LoopbackHost {
  explicit Host(int port) : LoopbackHost(port) {
    send("CONNECT Robot_access Keep-Alive:-1\r\n");
    EXPECT_EQ(until("\n").substr(0, 3), "OK:");
  }
};

TEST(Sim, SpeaksToAHostUntilItIsStopped) {
  SimProcess sim({"--tcp80-port", "0", "--hses-port", "0", "--controller", "nx100", "--model", "motomini"});
  const int port = port_in(sim.until("ready\n"));
  ASSERT_GT(port, 0);
  sim::LoopbackHost host(port);
  ASSERT_TRUE(host.connected());
  host.send("CONNECT Robot_access Keep-Alive:-1\r\n");
  EXPECT_EQ(host.until("\n").substr(0, 25), "OK: NX Information Server");
  EXPECT_EQ(host.command("RSTATS"), "194,0\r");
  EXPECT_EQ(host.command("RJDIR", "*"), "TEST1,TEST2,VISPICK\r");
  EXPECT_EQ(sim.stop(SIGTERM), 0);
  EXPECT_TRUE(host.ended());
}

TEST(Sim, StopsOnInterruptToo) {
  SimProcess sim({"--tcp80-port", "0", "--hses-port", "0", "--no-camera"});
  ASSERT_GT(port_in(sim.until("ready\n")), 0);
  EXPECT_EQ(sim.stop(SIGINT), 0);
}

TEST(Sim, RefusesDoorsThatItDoesNotHaveAndBadValues) {
  for (const auto& options : std::vector<std::vector<std::string>>{{"--hses-port", "65535"},
                                                                   {"--motoros-port", "65534"},
                                                                   {"--motoros-endian", "middle"},
                                                                   {"--model", "ur5"},
                                                                   {"--controller", "krc4"},
                                                                   {"--banner", "XX"},
                                                                   {"--tcp80-port", "70000"},
                                                                   {"/no/such/file.toml"},
                                                                   {"--scenario", "/no/such/file.toml"}}) {
    std::vector<std::string> words = options;
    if (options[0] != "--tcp80-port") words.insert(words.end(), {"--tcp80-port", "0"});
    if (options[0] != "--hses-port") words.insert(words.end(), {"--hses-port", "0"});
    SimProcess sim(words);
    const std::string said = sim.until("ready\n");
    EXPECT_EQ(sim.exit_code(), 2) << options[0];
    EXPECT_EQ(said.substr(0, 10), "pickcell: ") << said;
    EXPECT_EQ(said.find('\n'), said.size() - 1) << said;
  }
}

TEST(Sim, ReadsItsFileAndItsScenario) {
  const std::string path = testing::TempDir() + "pickcell_sim_test.toml";
  std::ofstream(path) << "controller = \"dx200\"\ntcp80_port = 0\nhses_port = 0\nmotoros_port = "
                         "0\n[[event]]\nafter_command = 2\nfault = \"hold\"\n";
  SimProcess sim({path});
  const int port = port_in(sim.until("ready\n"));
  ASSERT_GT(port, 0);
  sim::LoopbackHost host(port);
  host.send("CONNECT Robot_access Keep-Alive:-1\r\n");
  EXPECT_EQ(host.until("\n").substr(0, 6), "OK: DX");
  EXPECT_EQ(host.command("RSTATS"), "194,0\r");
  EXPECT_EQ(host.command("RSTATS"), "194,0\r");
  EXPECT_EQ(host.command("RSTATS"), "194,2\r");
  (void)std::remove(path.c_str());
}

TEST(SimScenario, SpoilsAnswersOverTcp80) {
  const Scenario scenario(
      "[[event]]\nafter_command = 1\nfault = \"double\"\n[[event]]\nafter_command = 2\nfault = \"late\"\ndelay_s = "
      "0.1\n"
      "[[event]]\nafter_command = 3\nfault = \"drop\"\n[[event]]\nafter_command = 4\nfault = \"half_line\"\n"
      "[[event]]\nafter_command = 5\nfault = \"truncate\"\n[[event]]\nafter_command = 6\nfault = \"reset_after_ok\"\n");
  SimProcess sim(scenario.options());
  const int port = port_in(sim.until("ready\n"));
  ASSERT_GT(port, 0);
  const auto ask_status = [](Host& host) {
    host.send("HOSTCTRL_REQUEST RSTATS 0\r\n");
    EXPECT_EQ(host.until("\r\n"), "OK: RSTATS\r\n");
  };
  Host host(port);
  ask_status(host);
  EXPECT_EQ(host.receive(12), "194,0\r194,0\r") << "double";
  ask_status(host);
  EXPECT_EQ(host.receive(6), "194,0\r") << "late";
  ask_status(host);
  EXPECT_TRUE(host.silent(200)) << "drop";
  ask_status(host);
  EXPECT_EQ(host.receive(3), "194") << "half a line";
  EXPECT_TRUE(host.silent(200));
  Host second(port);
  ask_status(second);
  EXPECT_EQ(second.receive(3), "194") << "truncate";
  EXPECT_TRUE(second.ended());
  EXPECT_FALSE(second.was_reset());
  Host third(port);
  ask_status(third);
  EXPECT_TRUE(third.ended()) << "reset after OK";
  EXPECT_TRUE(third.was_reset());
  Host fourth(port);
  EXPECT_EQ(fourth.command("RSTATS"), "194,0\r");
}

TEST(SimScenario, SpoilsDatagramsAndIsBusyOverHses) {
  const Scenario scenario(
      "[[event]]\nafter_command = \"RSTATS\"\nfault = \"double\"\n[[event]]\nafter_command = 2\nfault = \"late\"\n"
      "delay_s = 0.1\n[[event]]\nafter_command = 3\nfault = \"truncate\"\n[[event]]\nafter_command = 4\nfault = "
      "\"busy\"\n"
      "[[event]]\nafter_command = 5\nfault = \"drop\"\n");
  SimProcess sim(scenario.options());
  sim::UdpHost host(port_in(sim.until("ready\n"), "hses"));
  using namespace std::string_literals;
  const std::string request =
      "YERC\x20\0\0\0\x03\x01\0\x07\0\0\0\0\x39\x39\x39\x39\x39\x39\x39\x39"
      "\x72\0\x01\0\0\x01\0\0"s;
  const std::string idle =
      "YERC\x20\0\x08\0\x03\x01\x01\x07\0\0\0\x80\x39\x39\x39\x39\x39\x39\x39\x39"
      "\x81\0\0\0\0\0\0\0\xc2\0\0\0\0\0\0\0"s;
  EXPECT_EQ(host.exchange(request), idle);
  EXPECT_EQ(host.receive(), idle) << "double";
  EXPECT_EQ(host.exchange(request), idle) << "late";
  EXPECT_EQ(host.exchange(request), idle.substr(0, 20)) << "truncate";
  const std::string busy = host.exchange(request);
  ASSERT_EQ(busy.size(), 32u);
  EXPECT_EQ(busy.substr(24, 6), "\x81\x1f\x01\0\xf1\xd8"s) << "D8F1";
  host.send(request);
  EXPECT_EQ(host.receive(200), "") << "drop";
  EXPECT_EQ(host.exchange(request), idle);
}

TEST(SimScenario, KeysButtonsAndPower) {
  const Scenario scenario(
      "[[event]]\nafter_command = \"RJDIR\"\nfault = \"servo_off\"\n[[event]]\nafter_command = \"MDSP\"\nfault = "
      "\"hold\"\n"
      "[[event]]\nafter_command = \"IOREAD\"\nfault = \"estop\"\n[[event]]\nafter_command = \"RPOSJ\"\nfault = "
      "\"teach\"\n");
  SimProcess sim(scenario.options());
  Host host(port_in(sim.until("ready\n")));
  EXPECT_EQ(host.command("SVON", "1"), "0000\r");
  (void)host.until("\n");
  EXPECT_EQ(host.command("RSTATS"), "194,64\r");
  (void)host.command("RJDIR", "*");
  EXPECT_EQ(host.command("RSTATS"), "194,0\r") << "servo off";
  (void)host.command("MDSP", "hello");
  (void)host.until("\n");
  EXPECT_EQ(host.command("RSTATS"), "194,2\r") << "held from the pendant";
  EXPECT_EQ(host.command("IOREAD", "80020,8"), "0\r");
  EXPECT_EQ(host.command("IOREAD", "80020,8"), "64\r") << "emergency stop";
  EXPECT_EQ(host.command("SVON", "1"), "ERROR: SVON is not successful(3450).\r");
  (void)host.until("\n");
  (void)host.command("RPOSJ");
  EXPECT_EQ(host.command("RSTATS"), "34,2\r") << "teach";
}

TEST(SimScenario, AnAlarmInMidMoveStopsTheArm) {
  const Scenario scenario("[[event]]\nafter_command = \"START\"\nfault = \"alarm\"\nmid_move = true\ncode = 4321\n");
  SimProcess sim(scenario.options());
  Host host(port_in(sim.until("ready\n")));
  (void)host.command("SVON", "1");
  (void)host.until("\n");
  ASSERT_EQ(host.command("START", "VISPICK"), "0000\r");
  (void)host.until("\n");
  std::string alarms, status = "?";
  for (int i = 0; i < 500 && alarms.find("4321") == std::string::npos; ++i) alarms = host.command("RALARM");
  EXPECT_EQ(alarms, "0,0,4321,0,0,0,0,0,0,0\r");
  for (int i = 0; i < 500 && status != "194,16\r"; ++i) status = host.command("RSTATS");
  EXPECT_EQ(status, "194,16\r") << "an alarm, servo off, not running";
  const std::string stands = host.command("RPOSJ");
  EXPECT_NE(stands, "0,0,0,0,-90000,0,0,0,0,0,0,0\r") << "it had left its place";
  EXPECT_EQ(host.command("RPOSJ"), stands);
}

TEST(SimScenario, WhatMakesNoSenseIsRefusedInOneLine) {
  for (const char* event :
       {"at_s = -1\nfault = \"drop\"", "at_s = nan\nfault = \"drop\"", "at_s = 1e300\nfault = \"drop\"",
        "after_command = \"STRAT\"\nfault = \"drop\"", "at_s = 1\nfault = \"fire\"",
        "at_s = 1\nfault = \"late\"\ndelay_s = nan", "at_s = 1\nfault = \"drop\"\ncount = 0"}) {
    const Scenario scenario("[[event]]\n" + std::string(event) + "\n");
    SimProcess sim(scenario.options());
    const std::string said = sim.until("ready\n");
    EXPECT_EQ(sim.exit_code(), 2) << event;
    EXPECT_EQ(said.substr(0, 10), "pickcell: ") << said;
    EXPECT_EQ(said.find('\n'), said.size() - 1) << said;
  }
}

}  // namespace
}  // namespace pickcell::cli
