#include "pickcell/robot/datagram_link.hpp"

#include <netdb.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <memory>
#include <string_view>
#include <utility>

namespace pickcell::robot {

using core::ErrorCode;

namespace {

constexpr std::string_view kCheckCable =
    "check address and cable, and that the controller's High Speed Ethernet Server is on";

auto broken(const std::string& peer, std::string why) {
  return core::failure(ErrorCode::link, peer, std::move(why), std::string(kCheckCable));
}

struct FreeAddresses {
  void operator()(addrinfo* list) const { freeaddrinfo(list); }
};

}  // namespace

core::Result<DatagramLink> DatagramLink::open(const std::string& host, int port) {
  const std::string peer = host + ':' + std::to_string(port);
  addrinfo hints{};
  hints.ai_socktype = SOCK_DGRAM;
  addrinfo* found = nullptr;
  if (const int problem = getaddrinfo(host.c_str(), std::to_string(port).c_str(), &hints, &found); problem != 0)
    return broken(peer, gai_strerror(problem));
  const std::unique_ptr<addrinfo, FreeAddresses> addresses(found);
  int problem = EHOSTUNREACH;
  for (const addrinfo* a = addresses.get(); a; a = a->ai_next) {
    DatagramLink link(::socket(a->ai_family, a->ai_socktype | SOCK_NONBLOCK | SOCK_CLOEXEC, a->ai_protocol), peer);
    if (link.socket_ >= 0 && ::connect(link.socket_, a->ai_addr, a->ai_addrlen) == 0) return link;
    problem = errno;
  }
  return broken(peer, std::string("cannot open a socket: ") + std::strerror(problem));
}

DatagramLink::DatagramLink(DatagramLink&& other) noexcept
    : socket_(std::exchange(other.socket_, -1)), peer_(std::move(other.peer_)) {}

DatagramLink& DatagramLink::operator=(DatagramLink&& other) noexcept {
  std::swap(socket_, other.socket_);
  std::swap(peer_, other.peer_);
  return *this;
}

DatagramLink::~DatagramLink() {
  if (socket_ >= 0) (void)close(socket_);
}

core::Status DatagramLink::send(std::span<const std::uint8_t> datagram) {
  for (;;) {
    const ssize_t n = ::send(socket_, datagram.data(), datagram.size(), MSG_NOSIGNAL);
    if (n >= 0) return {};
    if (errno == EINTR) continue;
    return broken(peer_, std::string("cannot send: ") + std::strerror(errno));
  }
}

core::Result<std::size_t> DatagramLink::receive(std::span<std::uint8_t> buffer, WallDeadline deadline) {
  for (;;) {
    const ssize_t n = ::recv(socket_, buffer.data(), buffer.size(), 0);
    if (n >= 0) return static_cast<std::size_t>(n);
    if (errno == EINTR) continue;
    if (errno != EAGAIN && errno != EWOULDBLOCK)
      return broken(peer_, errno == ECONNREFUSED ? "nobody listens there" : std::strerror(errno));
    const auto left = std::chrono::ceil<std::chrono::milliseconds>(deadline - std::chrono::steady_clock::now()).count();
    if (left <= 0)
      return core::failure(ErrorCode::timeout, peer_, "no answer within the deadline", std::string(kCheckCable));
    pollfd entry{socket_, POLLIN, 0};
    (void)::poll(&entry, 1, static_cast<int>(std::clamp<decltype(left)>(left, 0, 60'000)));
  }
}

void DatagramLink::drain() {
  std::array<std::uint8_t, 1> ignored;
  while (::recv(socket_, ignored.data(), ignored.size(), 0) >= 0 || errno == EINTR || errno == ECONNREFUSED) {
  }
}

}  // namespace pickcell::robot
