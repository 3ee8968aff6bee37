#pragma once
/// What the TCP doors of the simulated controller have in common: listening, one poll over everything, bytes that wait
/// for their time, answers that a scenario spoils. Wall time.

#include <poll.h>

#include <algorithm>
#include <chrono>
#include <deque>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "pickcell/core/result.hpp"
#include "pickcell/sim/answer_faults.hpp"

namespace pickcell::sim {

using WallClock = std::chrono::steady_clock;
[[nodiscard]] WallClock::duration wall(double s);

/// A listening socket that does not block. port 0: any free one. Errors: link (taken, no permission; the remedy is the
/// caller's), usage (not an IPv4 address).
[[nodiscard]] core::Result<int> listen_on(const std::string& bind, int port, const std::string& remedy);
/// The port of a bound socket; 0 when there is none.
[[nodiscard]] int bound_port(int fd);
/// The next host that has come, not blocking and without delay; -1: none.
[[nodiscard]] int accept_host(int listener);
/// Closes with RST instead of FIN.
void reset(int fd);

/// Wakes a poll from another thread.
class Wake {
 public:
  Wake();  ///< throws std::system_error when the process has no descriptor left
  ~Wake();
  Wake(const Wake&) = delete;
  Wake& operator=(const Wake&) = delete;
  void ring() const;
  [[nodiscard]] int fd() const { return fd_; }

 private:
  int fd_;
};

/// Waits for any of these descriptors, or until a time.
class Poll {
 public:
  void add(int fd, short events) { fds_.push_back({fd, events, 0}); }
  void wake_at(WallClock::time_point t) { until_ = std::min(until_.value_or(t), t); }
  void wait();

 private:
  std::vector<pollfd> fds_;
  std::optional<WallClock::time_point> until_;
};

/// Bytes for a host, sent when they are due.
struct Out {
  enum class Then { go_on, close, reset };
  WallClock::time_point due;
  std::string bytes;
  Then then = Then::go_on;
};

/// The answer as a scenario wants it; as it is without a fault.
[[nodiscard]] Out spoilt(const std::optional<SpoiltAnswers>& fault, Out answer);

/// What waits for one host.
class Outbox {
 public:
  void put(Out out) { waiting_.push_back(std::move(out)); }
  [[nodiscard]] bool empty() const { return waiting_.empty(); }
  [[nodiscard]] std::size_t bytes() const;
  /// What the poll is to do for it: true when something is due now, else the poll wakes in time.
  [[nodiscard]] bool due(Poll& poll, WallClock::time_point now) const;

  enum class Sent { all, waits, ends, resets, broken };
  /// Sends what is due. ends, resets: the connection is to be closed in that way.
  [[nodiscard]] Sent send(int fd);

 private:
  std::deque<Out> waiting_;
};

}  // namespace pickcell::sim
