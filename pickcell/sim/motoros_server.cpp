#include "pickcell/sim/motoros_server.hpp"

#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <list>
#include <utility>

namespace pickcell::sim {

namespace {

using robot::MotoFrame;
namespace moto = robot::moto;

enum Port : std::size_t { kMotion, kState, kIo };
constexpr std::array<std::size_t, 3> kMostHosts = {1, 4, 4};
constexpr auto kPair = std::chrono::milliseconds(25);
constexpr auto kLook = std::chrono::milliseconds(5);  ///< for an answer that comes later
constexpr int kTriesForPorts = 50;
/// A host that reads nothing is put out when this much waits for it.
constexpr std::size_t kMostUnsent = 1 << 18;

/// Three listeners on ports in a row.
core::Result<std::array<int, 3>> listen_in_a_row(const std::string& bind, int port) {
  for (int tries = 1;; ++tries) {
    std::array<int, 3> fds{-1, -1, -1};
    core::Status status;
    int first = port;
    for (std::size_t i = 0; i < fds.size() && status; ++i) {
      auto fd = listen_on(bind, i == 0 ? port : first + static_cast<int>(i),
                          "choose another port (MotoROS takes three in a row)");
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

/// A host on one of the ports.
struct Connection {
  int fd;
  Port port;
  robot::MotoFrameSplitter splitter;
  Outbox out{};
  bool waits = false;  ///< an answer comes later; nothing else is looked at until then
  bool finished = false;
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
    Poll poll;
    poll.add(server_.wake_->fd(), POLLIN);
    for (const int fd : server_.listeners_) poll.add(fd, POLLIN);
    const auto now = WallClock::now();
    for (const Connection& c : connections_) {
      poll.add(c.fd, static_cast<short>(c.out.due(poll, now) ? POLLIN | POLLOUT : POLLIN));
      if (c.waits) poll.wake_at(now + kLook);
    }
    if (hosts_[kState] > 0) poll.wake_at(next_pair_);
    poll.wait();
  }

  void accept_hosts(Port port) {
    for (int fd = 0; (fd = accept_host(server_.listeners_[port])) >= 0;) {
      if (of_port(port) >= kMostHosts[port] && !make_room(port)) {
        (void)::close(fd);
        continue;
      }
      if (port == kState && hosts_[kState] == 0) next_pair_ = WallClock::now();
      connections_.push_back({fd, port, robot::MotoFrameSplitter(server_.settings_.order)});
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
      for (const MotoFrame& frame : pair) c.out.put({now, moto_bytes(frame, server_.settings_.order)});
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
    if (!receive(c) || !take(c)) return finish(c);
    if (!c.finished) send_due(c);
    if (!c.finished && c.out.bytes() > kMostUnsent) finish(c);
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
    while (!c.finished && !c.waits && c.out.empty()) {
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
      send_due(c);
    }
    return true;
  }

  /// A reply is not answered by a reply.
  void reply(Connection& c, const MotoFrame& message, const MotoFrame& answer, bool close) {
    if (message.comm != moto::kReply) post(c, motoros_command_name(message), answer, close);
  }

  void post(Connection& c, std::string_view command, const MotoFrame& frame, bool close) {
    c.out.put(spoilt(server_.faults_.next(command), {WallClock::now(), moto_bytes(frame, server_.settings_.order),
                                                     close ? Out::Then::close : Out::Then::go_on}));
  }

  static void send_due(Connection& c) {
    switch (c.out.send(c.fd)) {
      case Outbox::Sent::all:
      case Outbox::Sent::waits:
        return;
      case Outbox::Sent::ends:
      case Outbox::Sent::broken:
        return finish(c);
      case Outbox::Sent::resets:
        reset(c.fd);
        c.finished = true;
        return;
    }
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
  wake_ = std::make_unique<Wake>();
  port_ = bound_port(listeners_[kMotion]);
  thread_ = std::jthread([this](const std::stop_token& stop) { Loop(*this).run(stop); });
  return {};
}

void MotoRosServer::close() {
  if (!thread_.joinable()) return;
  thread_.request_stop();
  wake_->ring();
  thread_.join();
  for (int& fd : listeners_) (void)::close(std::exchange(fd, -1));
}

}  // namespace pickcell::sim
