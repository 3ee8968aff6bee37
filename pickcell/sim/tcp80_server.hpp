#pragma once
/// The Ethernet Server door: accepts hosts on a TCP port, speaks through Tcp80Session, hands commands to whoever owns
/// the controller. One thread serves all connections; it only reacts and has no seat on the clock.

#include <atomic>
#include <deque>
#include <functional>
#include <mutex>
#include <string>
#include <string_view>
#include <thread>

#include "pickcell/core/result.hpp"
#include "pickcell/sim/tcp80_commands.hpp"

namespace pickcell::sim {

/// What can go wrong with an answer; the command itself has been carried out.
enum class AnswerFault {
  drop,            ///< no result
  twice,           ///< the result two times
  late,            ///< after delay_s
  half_line,       ///< the first half of the result, then silence
  truncate,        ///< the first half of the result, then the connection is closed
  reset_after_ok,  ///< TCP reset after the OK line
};

struct Tcp80Fault {
  AnswerFault kind = AnswerFault::drop;
  int count = 1;        ///< this many answers
  std::string command;  ///< only to this command; empty: to any
  double delay_s = 2;   ///< wall time, for late
};

struct Tcp80Settings {
  std::string bind = "127.0.0.1";
  int port = 0;  ///< 0: any free one
  std::string banner = "YR";
  double segment_pause_s = 0;  ///< wall time between the OK line and the result
};

class Tcp80Server {
 public:
  using Execute = std::function<Tcp80Answer(std::string_view command, std::string_view operands)>;

  /// `execute` is called in the server's thread. Nothing is open before open().
  Tcp80Server(Tcp80Settings settings, Execute execute);
  ~Tcp80Server();
  Tcp80Server(const Tcp80Server&) = delete;
  Tcp80Server& operator=(const Tcp80Server&) = delete;

  /// Listens; after close() again on the same port. Errors: link (port taken, no permission), usage (bad address).
  [[nodiscard]] core::Status open();
  /// Resets all connections and stops listening. Not from inside `execute`.
  void close();
  /// The port it listens on, known after open().
  [[nodiscard]] int port() const { return port_; }
  /// Thread-safe.
  void inject(Tcp80Fault fault);

 private:
  struct Connection;
  class Loop;
  [[nodiscard]] std::optional<Tcp80Fault> next_fault(std::string_view command);

  Tcp80Settings settings_;
  Execute execute_;
  std::atomic<int> port_ = 0;
  int listener_ = -1;
  int wake_ = -1;
  std::jthread thread_;
  std::mutex faults_mutex_;
  std::deque<Tcp80Fault> faults_;
};

}  // namespace pickcell::sim
