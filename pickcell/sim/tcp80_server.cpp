#include "pickcell/sim/tcp80_server.hpp"

#include <arpa/inet.h>
#include <fcntl.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/eventfd.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <list>
#include <optional>
#include <utility>
#include <vector>

#include "pickcell/sim/tcp80_session.hpp"

namespace pickcell::sim {

namespace {

using WallClock = std::chrono::steady_clock;
constexpr std::size_t kMostConnections = 16;
constexpr double kDrain_s = 1;

WallClock::duration wall(double s) {
  return std::chrono::duration_cast<WallClock::duration>(std::chrono::duration<double>(s));
}

void reset(int fd) {
  const linger at_once{1, 0};  // RST instead of FIN
  (void)::setsockopt(fd, SOL_SOCKET, SO_LINGER, &at_once, sizeof at_once);
  (void)::close(fd);
}

core::Result<sockaddr_in> address(const std::string& bind, int port) {
  sockaddr_in a{};
  a.sin_family = AF_INET;
  a.sin_port = htons(static_cast<std::uint16_t>(port));
  if (::inet_pton(AF_INET, bind.c_str(), &a.sin_addr) != 1)
    return core::failure(core::ErrorCode::usage, bind, "not an IPv4 address", "give one of this machine's, or 0.0.0.0");
  return a;
}

core::Result<int> listen_on(const std::string& bind, int port) {
  auto a = address(bind, port);
  if (!a) return core::forward(a);
  const int fd = ::socket(AF_INET, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
  const int yes = 1;
  if (fd < 0 || ::setsockopt(fd, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes) != 0 ||
      ::bind(fd, reinterpret_cast<const sockaddr*>(&*a), sizeof *a) != 0 || ::listen(fd, 8) != 0) {
    const std::string why = std::strerror(errno);
    if (fd >= 0) (void)::close(fd);
    return core::failure(core::ErrorCode::link, "TCP port " + std::to_string(port) + " on " + bind, why,
                         "choose another port, or run with the rights that ports below 1024 need");
  }
  return fd;
}

int bound_port(int fd) {
  sockaddr_in a{};
  socklen_t size = sizeof a;
  return ::getsockname(fd, reinterpret_cast<sockaddr*>(&a), &size) == 0 ? ntohs(a.sin_port) : 0;
}

}  // namespace

/// A host. Bytes to send wait in `out` until their time; commands are looked at only when nothing waits. A connection
/// that the server ends is first shut down for writing and drained, so that late bytes of the host do not turn the end
/// into a reset that could overtake the result.
struct Tcp80Server::Connection {
  enum class Then { go_on, close, reset };
  struct Out {
    WallClock::time_point due;
    std::string bytes;
    Then then = Then::go_on;
  };
  int fd;
  Tcp80Session session;
  std::deque<Out> out;
  WallClock::time_point ok_sent{};
  bool host_done = false;  ///< the host has closed its side
  std::optional<WallClock::time_point> draining_until;
  bool finished = false;

  [[nodiscard]] bool wants_bytes() const { return !host_done && session.backlog() <= Tcp80Session::kEnough; }

  Connection(int socket, std::string banner) : fd(socket), session(std::move(banner)) {}
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
    std::vector<pollfd> fds{{server_.wake_, POLLIN, 0}, {server_.listener_, POLLIN, 0}};
    int timeout_ms = -1;
    const auto now = WallClock::now();
    const auto wake_at = [&](WallClock::time_point t) {
      const auto left = std::chrono::ceil<std::chrono::milliseconds>(t - now).count();
      const int left_ms = static_cast<int>(std::clamp<long long>(left, 0, 60'000));
      timeout_ms = timeout_ms < 0 ? left_ms : std::min(timeout_ms, left_ms);
    };
    for (const Connection& c : connections_) {
      short events = c.wants_bytes() ? POLLIN : 0;
      if (c.draining_until)
        wake_at(*c.draining_until);
      else if (!c.out.empty() && c.out.front().due <= now)
        events |= POLLOUT;
      else if (!c.out.empty())
        wake_at(c.out.front().due);
      fds.push_back({c.fd, events, 0});
    }
    (void)::poll(fds.data(), fds.size(), timeout_ms);
  }

  void accept_hosts() {
    while (true) {
      const int fd = ::accept4(server_.listener_, nullptr, nullptr, SOCK_NONBLOCK | SOCK_CLOEXEC);
      if (fd < 0) return;
      if (connections_.size() >= kMostConnections) {
        reset(fd);
        continue;
      }
      const int yes = 1;
      (void)::setsockopt(fd, IPPROTO_TCP, TCP_NODELAY, &yes, sizeof yes);
      connections_.emplace_back(fd, server_.settings_.banner);
    }
  }

  static void finish(Connection& c) {
    (void)::close(c.fd);
    c.finished = true;
  }

  static void end(Connection& c, Connection::Then how) {
    if (how == Connection::Then::reset) {
      reset(c.fd);
      c.finished = true;
      return;
    }
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
  bool send_due(Connection& c) {
    while (!c.out.empty() && c.out.front().due <= WallClock::now()) {
      Connection::Out& out = c.out.front();
      while (!out.bytes.empty()) {
        const ssize_t n = ::send(c.fd, out.bytes.data(), out.bytes.size(), MSG_NOSIGNAL);
        if (n < 0 && (errno == EAGAIN || errno == EINTR)) return true;
        if (n < 0) {
          finish(c);
          return false;
        }
        out.bytes.erase(0, static_cast<std::size_t>(n));
      }
      const Connection::Then then = out.then;
      c.out.pop_front();
      if (then != Connection::Then::go_on) {
        end(c, then);
        return false;
      }
    }
    return true;
  }

  void take(Connection& c, Tcp80Session::Step step) {
    using Then = Connection::Then;
    const auto now = WallClock::now();
    if (!step.command) {
      c.ok_sent = now;
      c.out.push_back({now, std::move(step.say), step.close ? Then::close : Then::go_on});
      return;
    }
    const std::string bytes = server_.execute_(step.command->name, step.command->operands).bytes();
    const auto due = std::max(now, c.ok_sent + wall(server_.settings_.segment_pause_s));
    const Then then = step.close ? Then::close : Then::go_on;
    const auto fault = server_.faults_.next(step.command->name);
    if (!fault) {
      c.out.push_back({due, bytes, then});
      return;
    }
    switch (fault->kind) {
      case AnswerFault::drop:
        c.out.push_back({due, {}, then});
        break;
      case AnswerFault::twice:
        c.out.push_back({due, bytes + bytes, then});
        break;
      case AnswerFault::late:
        c.out.push_back({due + wall(fault->delay_s), bytes, then});
        break;
      case AnswerFault::half_line:
        c.out.push_back({due, bytes.substr(0, bytes.size() / 2), then});
        break;
      case AnswerFault::truncate:
        c.out.push_back({due, bytes.substr(0, bytes.size() / 2), Then::close});
        break;
      case AnswerFault::reset_after_ok:
        c.out.push_back({due, {}, Then::reset});
        break;
    }
  }

  Tcp80Server& server_;
  std::list<Connection> connections_;
};

Tcp80Server::Tcp80Server(Tcp80Settings settings, Execute execute, AnswerFaults& faults)
    : settings_(std::move(settings)), execute_(std::move(execute)), faults_(faults) {}

Tcp80Server::~Tcp80Server() { close(); }

core::Status Tcp80Server::open() {
  auto fd = listen_on(settings_.bind, port_ != 0 ? port_.load() : settings_.port);
  if (!fd) return core::forward(fd);
  wake_ = ::eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK);
  if (wake_ < 0) {
    (void)::close(*fd);
    return core::failure(core::ErrorCode::device, "eventfd", std::strerror(errno));
  }
  listener_ = *fd;
  port_ = bound_port(*fd);
  thread_ = std::jthread([this](const std::stop_token& stop) { Loop(*this).run(stop); });
  return {};
}

void Tcp80Server::close() {
  if (!thread_.joinable()) return;
  thread_.request_stop();
  const std::uint64_t one = 1;
  (void)!::write(wake_, &one, sizeof one);
  thread_.join();
  (void)::close(std::exchange(listener_, -1));
  (void)::close(std::exchange(wake_, -1));
}

}  // namespace pickcell::sim
