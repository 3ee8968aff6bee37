#include "pickcell/sim/tcp80_server.hpp"

#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <list>
#include <optional>
#include <utility>

#include "pickcell/sim/tcp80_session.hpp"
#include "pickcell/sim/tcp_door.hpp"

namespace pickcell::sim {

namespace {

constexpr std::size_t kMostConnections = 16;
constexpr double kDrain_s = 1;

}  // namespace

/// A host. Bytes to send wait in `out` until their time; commands are looked at only when nothing waits. A connection
/// that the server ends is first shut down for writing and drained, so that late bytes of the host do not turn the end
/// into a reset that could overtake the result.
struct Tcp80Server::Connection {
  int fd;
  Tcp80Session session;
  Outbox out{};
  WallClock::time_point ok_sent{};
  bool host_done = false;  ///< the host has closed its side
  std::optional<WallClock::time_point> draining_until{};
  bool finished = false;

  [[nodiscard]] bool wants_bytes() const { return !host_done && session.backlog() <= Tcp80Session::kEnough; }
};

/// The thread's work: one poll over everything.
class Tcp80Server::Loop {
 public:
  explicit Loop(Tcp80Server& server) : server_(server) {}
  ~Loop() {
    for (const Connection& c : connections_) reset(c.fd);
  }
  Loop(const Loop&) = delete;
  Loop& operator=(const Loop&) = delete;

  void run(const std::stop_token& stop) {
    while (!stop.stop_requested()) {
      wait();
      if (stop.stop_requested()) return;
      accept_hosts();
      for (Connection& c : connections_) serve(c);
      connections_.remove_if([](const Connection& c) { return c.finished; });
    }
  }

 private:
  void wait() {
    Poll poll;
    poll.add(server_.wake_->fd(), POLLIN);
    poll.add(server_.listener_, POLLIN);
    const auto now = WallClock::now();
    for (const Connection& c : connections_) {
      short events = c.wants_bytes() ? POLLIN : 0;
      if (c.draining_until)
        poll.wake_at(*c.draining_until);
      else if (c.out.due(poll, now))
        events |= POLLOUT;
      poll.add(c.fd, events);
    }
    poll.wait();
  }

  void accept_hosts() {
    for (int fd = 0; (fd = accept_host(server_.listener_)) >= 0;) {
      if (connections_.size() >= kMostConnections)
        reset(fd);
      else
        connections_.push_back({fd, Tcp80Session(server_.settings_.banner)});
    }
  }

  static void finish(Connection& c) {
    (void)::close(c.fd);
    c.finished = true;
  }

  static void end(Connection& c) {
    (void)::shutdown(c.fd, SHUT_WR);
    c.draining_until = WallClock::now() + wall(kDrain_s);
  }

  void serve(Connection& c) {
    if (!receive(c)) return finish(c);
    if (c.draining_until) {
      if (c.host_done || WallClock::now() >= *c.draining_until) finish(c);
      return;
    }
    while (send_due(c) && c.out.empty()) {
      auto step = c.session.next();
      if (step)
        take(c, std::move(*step));
      else if (c.host_done)
        return finish(c);
      else
        return;
    }
  }

  /// False when the connection is broken.
  static bool receive(Connection& c) {
    std::array<char, 4096> buffer{};
    while (c.wants_bytes()) {
      const ssize_t n = ::recv(c.fd, buffer.data(), buffer.size(), 0);
      if (n < 0) return errno == EAGAIN || errno == EINTR;
      if (n == 0)
        c.host_done = true;
      else if (!c.draining_until)
        c.session.feed({buffer.data(), static_cast<std::size_t>(n)});
    }
    return true;
  }

  /// Sends what is due. False when the connection ended.
  static bool send_due(Connection& c) {
    switch (c.out.send(c.fd)) {
      case Outbox::Sent::all:
      case Outbox::Sent::waits:
        return true;
      case Outbox::Sent::ends:
        end(c);
        return false;
      case Outbox::Sent::resets:
        reset(c.fd);
        c.finished = true;
        return false;
      case Outbox::Sent::broken:
        finish(c);
        return false;
    }
    return false;
  }

  void take(Connection& c, Tcp80Session::Step step) {
    const auto now = WallClock::now();
    const Out::Then then = step.close ? Out::Then::close : Out::Then::go_on;
    if (!step.command) {
      c.ok_sent = now;
      c.out.put({now, std::move(step.say), then});
      return;
    }
    const std::string bytes = server_.execute_(step.command->name, step.command->operands).bytes();
    const auto due = std::max(now, c.ok_sent + wall(server_.settings_.segment_pause_s));
    c.out.put(spoilt(server_.faults_.next(step.command->name), {due, bytes, then}));
  }

  Tcp80Server& server_;
  std::list<Connection> connections_;
};

Tcp80Server::Tcp80Server(Tcp80Settings settings, Execute execute, AnswerFaults& faults)
    : settings_(std::move(settings)), execute_(std::move(execute)), faults_(faults) {}

Tcp80Server::~Tcp80Server() { close(); }

core::Status Tcp80Server::open() {
  auto fd = listen_on(settings_.bind, port_ != 0 ? port_.load() : settings_.port,
                      "choose another port, or run with the rights that ports below 1024 need");
  if (!fd) return core::forward(fd);
  wake_ = std::make_unique<Wake>();
  listener_ = *fd;
  port_ = bound_port(*fd);
  thread_ = std::jthread([this](const std::stop_token& stop) { Loop(*this).run(stop); });
  return {};
}

void Tcp80Server::close() {
  if (!thread_.joinable()) return;
  thread_.request_stop();
  wake_->ring();
  thread_.join();
  (void)::close(std::exchange(listener_, -1));
}

}  // namespace pickcell::sim
