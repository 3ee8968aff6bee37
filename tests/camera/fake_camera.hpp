#pragma once
/// Aravis' own fake GigE Vision camera as a process, in a network of the test's own.

#include <fcntl.h>
#include <gtest/gtest.h>
#include <net/if.h>
#include <sched.h>
#include <signal.h>
#include <spawn.h>
#include <sys/file.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <filesystem>
#include <string>
#include <vector>

#include "pickcell/frames/gvcp_probe.hpp"

extern char** environ;

namespace pickcell {

constexpr std::uint32_t kLoopback = 0x7f000001;

/// A network namespace with nothing but loopback: the protocol has one port only, which tests that run side by side
/// would fight for. False where the machine does not allow it; then the test takes the machine's own network.
inline bool own_network() {
  if (::unshare(CLONE_NEWNET) != 0 && ::unshare(CLONE_NEWUSER | CLONE_NEWNET) != 0) return false;
  const int s = ::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  ifreq request{};
  std::string("lo").copy(request.ifr_name, sizeof request.ifr_name - 1);
  request.ifr_flags = IFF_UP | IFF_RUNNING | IFF_LOOPBACK;
  const bool up = ::ioctl(s, SIOCSIFFLAGS, &request) == 0;
  (void)::close(s);
  return up;
}

/// Before any thread of the test program begins.
inline const bool kOwnNetwork = own_network();

/// On the machine's own network one test after the other; held until the program ends.
inline void wait_for_turn() {
  if (kOwnNetwork) return;
  const std::string path = (std::filesystem::temp_directory_path() / "pickcell_gige_tests.lock").string();
  static const int fd = ::open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666);
  if (fd >= 0) (void)::flock(fd, LOCK_EX);
}

/// A process, killed with its object.
class Process {
 public:
  explicit Process(std::vector<std::string> words) {
    std::vector<char*> argv;
    for (std::string& word : words) argv.push_back(word.data());
    argv.push_back(nullptr);
    posix_spawn_file_actions_t files;
    posix_spawn_file_actions_init(&files);
    posix_spawn_file_actions_addopen(&files, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
    posix_spawn_file_actions_addopen(&files, STDERR_FILENO, "/dev/null", O_WRONLY, 0);
    if (::posix_spawn(&pid_, argv[0], &files, nullptr, argv.data(), environ) != 0) pid_ = -1;
    posix_spawn_file_actions_destroy(&files);
  }
  ~Process() { kill(); }
  Process(const Process&) = delete;
  Process& operator=(const Process&) = delete;
  void kill() {
    if (pid_ <= 0) return;
    (void)::kill(pid_, SIGKILL);
    (void)::waitpid(pid_, nullptr, 0);
    pid_ = -1;
  }
  [[nodiscard]] bool started() const { return pid_ > 0; }

 private:
  pid_t pid_ = -1;
};

/// arv-fake-gv-camera of Debian's aravis-tools, serial GV01 on 127.0.0.1, losing so many packets of a thousand.
class FakeCamera {
 public:
  static constexpr const char* kProgram = "/usr/bin/arv-fake-gv-camera-0.8";
  explicit FakeCamera(int lost_per_thousand = 0) : lost_(lost_per_thousand) { start(); }
  void start() {
    process_.reset();
    process_ =
        std::make_unique<Process>(std::vector<std::string>{kProgram, "-i", "127.0.0.1", "-r", std::to_string(lost_)});
    frames::GvcpProbe probe(kLoopback);
    for (int i = 0; i < 100 && !probe.identify(std::chrono::milliseconds(50)); ++i) continue;
  }
  void kill() { process_->kill(); }

 private:
  int lost_;
  std::unique_ptr<Process> process_;
};

}  // namespace pickcell
