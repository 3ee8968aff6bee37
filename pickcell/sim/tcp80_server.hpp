#pragma once
/// The Ethernet Server door: accepts hosts on a TCP port, speaks through Tcp80Session, hands commands to whoever owns
/// the controller. One thread serves all connections; it only reacts and has no seat on the clock.

#include <atomic>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <thread>

#include "pickcell/core/result.hpp"
#include "pickcell/sim/answer_faults.hpp"
#include "pickcell/sim/tcp80_commands.hpp"
#include "pickcell/sim/tcp_door.hpp"

namespace pickcell::sim {

struct Tcp80Settings {
  std::string bind = "127.0.0.1";
  int port = 0;  ///< 0: any free one
  std::string banner = "YR";
  double segment_pause_s = 0;  ///< wall time between the OK line and the result
};

class Tcp80Server {
 public:
  using Execute = std::function<Tcp80Answer(std::string_view command, std::string_view operands)>;

  /// `execute` is called in the server's thread. Nothing is open before open(). `faults` must outlive the server.
  Tcp80Server(Tcp80Settings settings, Execute execute, AnswerFaults& faults);
  ~Tcp80Server();
  Tcp80Server(const Tcp80Server&) = delete;
  Tcp80Server& operator=(const Tcp80Server&) = delete;

  /// Listens; after close() again on the same port. Errors: link (port taken, no permission), usage (bad address).
  [[nodiscard]] core::Status open();
  /// Resets all connections and stops listening. Not from inside `execute`.
  void close();
  /// The port it listens on, known after open().
  [[nodiscard]] int port() const { return port_; }

 private:
  struct Connection;
  class Loop;

  Tcp80Settings settings_;
  Execute execute_;
  AnswerFaults& faults_;
  std::atomic<int> port_ = 0;
  int listener_ = -1;
  std::unique_ptr<Wake> wake_;
  std::jthread thread_;
};

}  // namespace pickcell::sim
