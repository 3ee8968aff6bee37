#include "pickcell/robot/datagram_link.hpp"

#include <netdb.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>
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

}  // namespace

core::Result<DatagramLink> DatagramLink::open(const std::string& host, int port) {
  const std::string peer = host + ':' + std::to_string(port);
  auto addresses = addresses_of(host, port, SOCK_DGRAM);
  if (!addresses) return core::forward(addresses);
  int problem = EHOSTUNREACH;
  for (const addrinfo* a = addresses->get(); a; a = a->ai_next) {
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
    if (!socket_ready(socket_, POLLIN, deadline))
      return core::failure(ErrorCode::timeout, peer_, "no answer within the deadline", std::string(kCheckCable));
  }
}

void DatagramLink::drain() {
  constexpr int kMost = 10'000;  // a peer that never falls silent
  std::array<std::uint8_t, 1> ignored;
  for (int i = 0; i < kMost &&
                  (::recv(socket_, ignored.data(), ignored.size(), 0) >= 0 || errno == EINTR || errno == ECONNREFUSED);
       ++i) {
  }
}

}  // namespace pickcell::robot
