#pragma once
/// The High Speed Ethernet Server door: two UDP ports, robot control and files. One thread serves both; it only reacts
/// and has no seat on the clock.

#include <atomic>
#include <functional>
#include <memory>
#include <string>
#include <thread>

#include "pickcell/core/result.hpp"
#include "pickcell/robot/hses_frame_codec.hpp"
#include "pickcell/sim/answer_faults.hpp"
#include "pickcell/sim/tcp_door.hpp"

namespace pickcell::sim {

struct HsesSettings {
  std::string bind = "127.0.0.1";
  int port = 0;  ///< of robot control, files on the next one; 0: any two free ones
};

class HsesServer {
 public:
  /// An answer; `name` of the command for faults of answers.
  struct Executed {
    std::string name;
    std::optional<robot::HsesAnswer> answer;
    bool try_again_soon = false;  ///< refused because a job runs that may be over in a moment
  };
  using Execute = std::function<Executed(const robot::HsesRequest& request)>;

  /// `execute` is called in the server's thread. Nothing is open before open(). `faults` must outlive the server.
  HsesServer(HsesSettings settings, Execute execute, AnswerFaults& faults);
  ~HsesServer();
  HsesServer(const HsesServer&) = delete;
  HsesServer& operator=(const HsesServer&) = delete;

  /// Opens both ports; after close() again the same ones. Errors: link (port taken, no permission), usage (bad
  /// address).
  [[nodiscard]] core::Status open();
  /// Not from inside `execute`.
  void close();
  /// Of robot control, known after open(); files are on port() + 1.
  [[nodiscard]] int port() const { return port_; }

 private:
  class Loop;
  HsesSettings settings_;
  Execute execute_;
  AnswerFaults& faults_;
  std::atomic<int> port_ = 0;
  int robot_socket_ = -1, file_socket_ = -1;
  std::unique_ptr<Wake> wake_;
  std::jthread thread_;
};

}  // namespace pickcell::sim
