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

int port_in(const std::string& said) {
  const std::size_t at = said.find("127.0.0.1:");
  return at == std::string::npos ? 0 : std::stoi(said.substr(at + 10));
}

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

}  // namespace
}  // namespace pickcell::cli
