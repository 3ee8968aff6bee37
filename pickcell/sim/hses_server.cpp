#include "pickcell/sim/hses_server.hpp"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <list>
#include <utility>

namespace pickcell::sim {

namespace {

constexpr int kPortTries = 100;
/// How long the file service waits for a job to end before it refuses, and how often it looks.
constexpr auto kPatience = std::chrono::milliseconds(300), kLook = std::chrono::milliseconds(10);
constexpr std::size_t kMostWaiting = 64;

auto taken(const std::string& bind, int port, int problem) {
  return core::failure(core::ErrorCode::link, "UDP port " + std::to_string(port) + " on " + bind,
                       std::strerror(problem), "choose another port with --hses-port (0: any free ones)");
}

core::Result<int> bind_one(const std::string& bind, int port) {
  sockaddr_in a{};
  a.sin_family = AF_INET;
  a.sin_port = htons(static_cast<std::uint16_t>(port));
  if (::inet_pton(AF_INET, bind.c_str(), &a.sin_addr) != 1)
    return core::failure(core::ErrorCode::usage, bind, "not an IPv4 address", "give one of this machine's, or 0.0.0.0");
  const int fd = ::socket(AF_INET, SOCK_DGRAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
  if (fd >= 0 && ::bind(fd, reinterpret_cast<const sockaddr*>(&a), sizeof a) == 0) return fd;
  const int problem = errno;
  if (fd >= 0) (void)::close(fd);
  return taken(bind, port, problem);
}

struct Pair {
  int robot = -1, files = -1;
};

core::Result<Pair> bind_pair(const std::string& bind, int port) {
  for (int attempt = 1;; ++attempt) {
    auto robot = bind_one(bind, port);
    if (!robot) return core::forward(robot);
    const int next = bound_port(*robot) + 1;
    auto files = next <= 65535 ? bind_one(bind, next) : core::Result<int>(taken(bind, next, EADDRNOTAVAIL));
    if (files) return Pair{*robot, *files};
    (void)::close(*robot);
    if (port != 0 || attempt == kPortTries) return core::forward(files);
  }
}

struct Peer {
  int socket = -1;
  sockaddr_in address{};
};

void send_to(const Peer& peer, const robot::HsesBytes& bytes) {
  (void)::sendto(peer.socket, bytes.data(), bytes.size(), 0, reinterpret_cast<const sockaddr*>(&peer.address),
                 sizeof peer.address);
}

}  // namespace

/// The thread's work: one poll over both ports and what is due later.
class HsesServer::Loop {
 public:
  explicit Loop(HsesServer& server) : server_(server) {}

  void run(const std::stop_token& stop) {
    while (!stop.stop_requested()) {
      std::array<pollfd, 3> fds{
          {{server_.wake_->fd(), POLLIN, 0}, {server_.robot_socket_, POLLIN, 0}, {server_.file_socket_, POLLIN, 0}}};
      (void)::poll(fds.data(), fds.size(), time_left_ms());
      if (stop.stop_requested()) return;
      send_late();
      look_again();
      receive(server_.robot_socket_);
      receive(server_.file_socket_);
    }
  }

 private:
  struct Late {
    WallClock::time_point due;
    Peer to;
    robot::HsesBytes bytes;
  };
  struct Waiting {
    WallClock::time_point until;
    Peer from;
    robot::HsesRequest request;
  };

  [[nodiscard]] int time_left_ms() const {
    auto next = WallClock::time_point::max();
    for (const Late& l : late_) next = std::min(next, l.due);
    if (!waiting_.empty()) next = std::min(next, WallClock::now() + kLook);
    if (next == WallClock::time_point::max()) return -1;
    const auto left = std::chrono::ceil<std::chrono::milliseconds>(next - WallClock::now()).count();
    return static_cast<int>(std::clamp<long long>(left, 0, 60'000));
  }

  void send_late() {
    const auto now = WallClock::now();
    for (const Late& l : late_)
      if (l.due <= now) send_to(l.to, l.bytes);
    late_.remove_if([&](const Late& l) { return l.due <= now; });
  }

  void look_again() {
    const auto now = WallClock::now();
    waiting_.remove_if([&](const Waiting& w) {
      Executed done = server_.execute_(w.request);
      if (done.try_again_soon && now < w.until) return false;
      answer(w.from, std::move(done));
      return true;
    });
  }

  void receive(int socket) {
    std::array<std::uint8_t, 2048> buffer;
    for (int n = 0; n < 64; ++n) {  // then the other port's turn
      Peer from{socket, {}};
      socklen_t size = sizeof from.address;
      const ssize_t bytes =
          ::recvfrom(socket, buffer.data(), buffer.size(), 0, reinterpret_cast<sockaddr*>(&from.address), &size);
      if (bytes < 0 && (errno == EINTR || errno == ECONNREFUSED)) continue;
      if (bytes < 0) return;
      take(from, robot::HsesView(buffer).first(static_cast<std::size_t>(bytes)));
    }
  }

  void take(const Peer& from, robot::HsesView datagram) {
    auto request = robot::parse_hses_request(datagram);
    const auto division = from.socket == server_.file_socket_ ? robot::HsesDivision::file : robot::HsesDivision::robot;
    if (request && request->division != division)
      request = tl::unexpected(
          robot::HsesBadRequest{robot::kHsesBadDivision, request->id, static_cast<std::uint8_t>(request->service)});
    if (!request) return refuse(from, division, request.error());
    Executed done = server_.execute_(*request);
    if (done.try_again_soon && waiting_.size() < kMostWaiting)
      waiting_.push_back({WallClock::now() + kPatience, from, std::move(*request)});
    else
      answer(from, std::move(done));
  }

  static void refuse(const Peer& to, robot::HsesDivision division, const robot::HsesBadRequest& bad) {
    if (!bad.added_status) return;  // nothing that begins like a request: no answer
    robot::HsesAnswer a;
    a.division = division;
    a.id = bad.id;
    a.service = static_cast<robot::HsesService>(bad.service & 0x7F);
    a.status = 0x1F;
    a.added_status = *bad.added_status;
    send_to(to, robot::hses_bytes(a));
  }

  void answer(const Peer& to, Executed done) {
    if (!done.answer) return;
    const robot::HsesBytes bytes = robot::hses_bytes(*done.answer);
    const auto fault = server_.faults_.next(done.name);
    if (!fault) return send_to(to, bytes);
    switch (fault->kind) {
      case AnswerFault::drop:
      case AnswerFault::reset_after_ok:
        return;
      case AnswerFault::twice:
        send_to(to, bytes);
        return send_to(to, bytes);
      case AnswerFault::late:
        late_.push_back({WallClock::now() + wall(fault->delay_s), to, bytes});
        return;
      case AnswerFault::half_line:
      case AnswerFault::truncate:
        return send_to(to, {bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(bytes.size() / 2)});
    }
  }

  HsesServer& server_;
  std::list<Late> late_;
  std::list<Waiting> waiting_;
};

HsesServer::HsesServer(HsesSettings settings, Execute execute, AnswerFaults& faults)
    : settings_(std::move(settings)), execute_(std::move(execute)), faults_(faults) {}

HsesServer::~HsesServer() { close(); }

core::Status HsesServer::open() {
  auto pair = bind_pair(settings_.bind, port_ != 0 ? port_.load() : settings_.port);
  if (!pair) return core::forward(pair);
  wake_ = std::make_unique<Wake>();
  robot_socket_ = pair->robot;
  file_socket_ = pair->files;
  port_ = bound_port(robot_socket_);
  thread_ = std::jthread([this](const std::stop_token& stop) { Loop(*this).run(stop); });
  return {};
}

void HsesServer::close() {
  if (!thread_.joinable()) return;
  thread_.request_stop();
  wake_->ring();
  thread_.join();
  for (int* fd : {&robot_socket_, &file_socket_}) (void)::close(std::exchange(*fd, -1));
}

}  // namespace pickcell::sim
