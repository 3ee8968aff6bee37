#include "pickcell/sim/motoros_server.hpp"

#include <arpa/inet.h>
#include <fcntl.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/eventfd.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <list>
#include <utility>

namespace pickcell::sim {

namespace {

using WallClock = std::chrono::steady_clock;
using robot::MotoFrame;
namespace moto = robot::moto;

enum Port : std::size_t { kMotion, kState, kIo };
constexpr std::array<std::size_t, 3> kMostHosts = {1, 4, 4};
constexpr auto kPair = std::chrono::milliseconds(25);
constexpr auto kLook = std::chrono::milliseconds(5);  ///< for an answer that comes later
constexpr int kTriesForPorts = 50;
/// A host that reads nothing is put out when this much waits for it.
constexpr std::size_t kMostUnsent = 1 << 18;

WallClock::duration wall(double s) {
  return std::chrono::duration_cast<WallClock::duration>(std::chrono::duration<double>(s));
}

void reset(int fd) {
  const linger at_once{1, 0};  // RST instead of FIN
  (void)::setsockopt(fd, SOL_SOCKET, SO_LINGER, &at_once, sizeof at_once);
  (void)::close(fd);
}

int bound_port(int fd) {
  sockaddr_in a{};
  socklen_t size = sizeof a;
  return ::getsockname(fd, reinterpret_cast<sockaddr*>(&a), &size) == 0 ? ntohs(a.sin_port) : 0;
}

core::Result<int> listen_on(const std::string& bind, int port) {
  sockaddr_in a{};
  a.sin_family = AF_INET;
  a.sin_port = htons(static_cast<std::uint16_t>(port));
  if (::inet_pton(AF_INET, bind.c_str(), &a.sin_addr) != 1)
    return core::failure(core::ErrorCode::usage, bind, "not an IPv4 address", "give one of this machine's, or 0.0.0.0");
  const int fd = ::socket(AF_INET, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
  const int yes = 1;
  if (fd < 0 || ::setsockopt(fd, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes) != 0 ||
      ::bind(fd, reinterpret_cast<const sockaddr*>(&a), sizeof a) != 0 || ::listen(fd, 8) != 0) {
    const std::string why = std::strerror(errno);
    if (fd >= 0) (void)::close(fd);
    return core::failure(core::ErrorCode::link, "TCP port " + std::to_string(port) + " on " + bind, why,
                         "choose another port (MotoROS takes three in a row)");
  }
  return fd;
}

/// Three listeners on ports in a row.
core::Result<std::array<int, 3>> listen_in_a_row(const std::string& bind, int port) {
  for (int tries = 1;; ++tries) {
    std::array<int, 3> fds{-1, -1, -1};
    core::Status status;
    int first = port;
    for (std::size_t i = 0; i < fds.size() && status; ++i) {
      auto fd = listen_on(bind, i == 0 ? port : first + static_cast<int>(i));
      if (!fd) {
        status = core::forward(fd);
        continue;
      }
      fds[i] = *fd;
      if (i == 0) first = bound_port(*fd);
    }
    if (status) return fds;
    for (const int fd : fds)
      if (fd >= 0) (void)::close(fd);
    if (port != 0 || tries >= kTriesForPorts) return core::forward(status);
  }
}

/// A host on one of the ports. Bytes to send wait in `out` until their time.
struct Connection {
  struct Out {
    WallClock::time_point due;
    std::string bytes;
    bool then_close = false, then_reset = false;
  };
  int fd;
  Port port;
  robot::MotoFrameSplitter splitter;
  std::list<Out> out;
  bool waits = false;  ///< an answer comes later; nothing else is looked at until then
  bool finished = false;

  [[nodiscard]] std::size_t unsent() const {
    std::size_t sum = 0;
    for (const Out& o : out) sum += o.bytes.size();
    return sum;
  }
};

}  // namespace

/// The thread's work: one poll over everything.
class MotoRosServer::Loop {
 public:
  explicit Loop(MotoRosServer& server) : server_(server), host_(server.host_) {}
  ~Loop() {
    for (const Connection& c : connections_) reset(c.fd);
    if (hosts_[kMotion] > 0) host_.motion_host_left();
  }
  Loop(const Loop&) = delete;
  Loop& operator=(const Loop&) = delete;

  void run(const std::stop_token& stop) {
    host_.connected(hosts_);
    while (!stop.stop_requested()) {
      wait();
      if (stop.stop_requested()) return;
      send_state();
      for (Connection& c : connections_) serve(c);
      forget_finished();  // who left makes room for who comes
      for (const Port port : {kMotion, kState, kIo}) accept_hosts(port);
    }
  }

 private:
  void wait() {
    std::vector<pollfd> fds{{server_.wake_, POLLIN, 0}};
    for (const int fd : server_.listeners_) fds.push_back({fd, POLLIN, 0});
    auto until = WallClock::now() + std::chrono::minutes(1);
    const auto now = WallClock::now();
    for (const Connection& c : connections_) {
      short events = POLLIN;
      if (!c.out.empty() && c.out.front().due <= now) events |= POLLOUT;
      if (!c.out.empty() && c.out.front().due > now) until = std::min(until, c.out.front().due);
      if (c.waits) until = std::min(until, now + kLook);
      fds.push_back({c.fd, events, 0});
    }
    if (hosts_[kState] > 0) until = std::min(until, next_pair_);
    const auto left = std::chrono::ceil<std::chrono::milliseconds>(until - now).count();
    (void)::poll(fds.data(), fds.size(), static_cast<int>(std::clamp<long long>(left, 0, 60'000)));
  }

  void accept_hosts(Port port) {
    for (;;) {
      const int fd = ::accept4(server_.listeners_[port], nullptr, nullptr, SOCK_NONBLOCK | SOCK_CLOEXEC);
      if (fd < 0) return;
      if (of_port(port) >= kMostHosts[port] && !make_room(port)) {
        (void)::close(fd);
        continue;
      }
      const int yes = 1;
      (void)::setsockopt(fd, IPPROTO_TCP, TCP_NODELAY, &yes, sizeof yes);
      if (port == kState && hosts_[kState] == 0) next_pair_ = WallClock::now();
      connections_.push_back({fd, port, robot::MotoFrameSplitter(server_.settings_.order), {}, false, false});
      count();
    }
  }

  [[nodiscard]] std::size_t of_port(Port port) const {
    return static_cast<std::size_t>(
        std::count_if(connections_.begin(), connections_.end(),
                      [port](const Connection& c) { return c.port == port && !c.finished; }));
  }

  /// A newcomer for motion puts out a host that moves nothing.
  bool make_room(Port port) {
    if (port != kMotion || host_.holds_motion()) return false;
    for (Connection& c : connections_)
      if (c.port == kMotion && !c.finished) finish(c);
    forget_finished();
    return true;
  }

  static void finish(Connection& c) {
    (void)::close(c.fd);
    c.finished = true;
  }

  void forget_finished() {
    const bool motion = of_port(kMotion) > 0;
    if (connections_.remove_if([](const Connection& c) { return c.finished; }) == 0) return;
    if (!motion && hosts_[kMotion] > 0) host_.motion_host_left();
    count();
  }

  void count() {
    const std::array<int, 3> before = hosts_;
    for (const Port port : {kMotion, kState, kIo}) hosts_[port] = static_cast<int>(of_port(port));
    if (hosts_ != before) host_.connected(hosts_);
  }

  /// Two writes of one pair, to every host of the state port.
  void send_state() {
    const auto now = WallClock::now();
    if (hosts_[kState] == 0 || now < next_pair_) return;
    const auto pair = host_.state();
    for (Connection& c : connections_) {
      if (c.port != kState) continue;
      for (const MotoFrame& frame : pair) c.out.push_back({now, moto_bytes(frame, server_.settings_.order)});
    }
    next_pair_ = now + kPair;  // a fixed sleep, as on the controller
  }

  void serve(Connection& c) {
    if (c.finished) return;
    if (c.waits) {
      if (auto answer = host_.waited()) {
        c.waits = false;
        post(c, motoros_command_name({moto::kMotionControl, 0, 0, {}}), *answer, false);
      }
    }
    if (!receive(c) || !take(c) || !send_due(c) || c.unsent() > kMostUnsent) finish(c);
  }

  static bool receive(Connection& c) {
    std::array<char, 4096> buffer{};
    for (;;) {
      const ssize_t n = ::recv(c.fd, buffer.data(), buffer.size(), 0);
      if (n < 0) return errno == EAGAIN || errno == EINTR;
      if (n == 0) return false;
      if (c.port == kState) continue;  // nobody listens there
      c.splitter.feed({buffer.data(), static_cast<std::size_t>(n)});
      if (c.splitter.pending() > kMostUnsent) return false;
    }
  }

  /// Carries out what has come. False when the stream is lost.
  bool take(Connection& c) {
    while (!c.waits && c.out.empty()) {
      auto message = c.splitter.next();
      if (!message) return false;
      if (!*message) return true;
      if (c.port == kIo) {
        reply(c, **message, host_.io(**message), false);
      } else {
        MotoRosAnswer answer = host_.motion(**message);
        c.waits = answer.later;
        if (answer.frame) reply(c, **message, *answer.frame, answer.close);
      }
      if (!send_due(c)) return false;
    }
    return true;
  }

  /// A reply is not answered by a reply.
  void reply(Connection& c, const MotoFrame& message, const MotoFrame& answer, bool close) {
    if (message.comm != moto::kReply) post(c, motoros_command_name(message), answer, close);
  }

  void post(Connection& c, std::string_view command, const MotoFrame& frame, bool close) {
    const std::string bytes = moto_bytes(frame, server_.settings_.order);
    const auto now = WallClock::now();
    const auto spoil = server_.faults_.next(command);
    if (!spoil) {
      c.out.push_back({now, bytes, close});
      return;
    }
    const std::string half = bytes.substr(0, bytes.size() / 2);
    switch (spoil->kind) {
      case AnswerFault::drop:
        return;
      case AnswerFault::twice:
        c.out.push_back({now, bytes + bytes, close});
        return;
      case AnswerFault::late:
        c.out.push_back({now + wall(spoil->delay_s), bytes, close});
        return;
      case AnswerFault::half_line:
        c.out.push_back({now, half, close});
        return;
      case AnswerFault::truncate:
        c.out.push_back({now, half, true});
        return;
      case AnswerFault::reset_after_ok:
        c.out.push_back({now, {}, false, true});
        return;
    }
  }

  /// False when the connection ends.
  static bool send_due(Connection& c) {
    while (!c.out.empty() && c.out.front().due <= WallClock::now()) {
      Connection::Out& out = c.out.front();
      while (!out.bytes.empty()) {
        const ssize_t n = ::send(c.fd, out.bytes.data(), out.bytes.size(), MSG_NOSIGNAL);
        if (n < 0) return errno == EAGAIN || errno == EINTR;
        out.bytes.erase(0, static_cast<std::size_t>(n));
      }
      if (out.then_reset) {
        const linger at_once{1, 0};
        (void)::setsockopt(c.fd, SOL_SOCKET, SO_LINGER, &at_once, sizeof at_once);
      }
      if (out.then_reset || out.then_close) return false;
      c.out.pop_front();
    }
    return true;
  }

  MotoRosServer& server_;
  MotoRosHost& host_;
  std::list<Connection> connections_;
  std::array<int, 3> hosts_{};
  WallClock::time_point next_pair_{};
};

MotoRosServer::MotoRosServer(MotoRosDoorSettings settings, MotoRosHost& host, AnswerFaults& faults)
    : settings_(std::move(settings)), host_(host), faults_(faults) {}

MotoRosServer::~MotoRosServer() { close(); }

core::Status MotoRosServer::open() {
  auto fds = listen_in_a_row(settings_.bind, port_ != 0 ? port_.load() : settings_.port);
  if (!fds) return core::forward(fds);
  listeners_ = *fds;
  wake_ = ::eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK);
  port_ = bound_port(listeners_[kMotion]);
  thread_ = std::jthread([this](const std::stop_token& stop) { Loop(*this).run(stop); });
  return {};
}

void MotoRosServer::close() {
  if (!thread_.joinable()) return;
  thread_.request_stop();
  const std::uint64_t one = 1;
  (void)!::write(wake_, &one, sizeof one);
  thread_.join();
  for (int& fd : listeners_) (void)::close(std::exchange(fd, -1));
  (void)::close(std::exchange(wake_, -1));
}

}  // namespace pickcell::sim
