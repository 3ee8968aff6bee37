#include "pickcell/robot/byte_link.hpp"

#include <fcntl.h>
#include <netdb.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <utility>

namespace pickcell::robot {

using core::ErrorCode;

namespace {

constexpr std::string_view kCheckCable = "check address, cable and that the controller's network function is on";

auto broken(const std::string& peer, std::string why) {
  return core::failure(ErrorCode::link, peer, std::move(why), std::string(kCheckCable));
}

auto too_late(const std::string& peer, std::string why) {
  return core::failure(ErrorCode::timeout, peer, std::move(why), std::string(kCheckCable));
}

/// 0 when connected, else an errno value; ETIMEDOUT at the deadline.
int finish_connect(int socket, const addrinfo& address, WallDeadline deadline) {
  if (::connect(socket, address.ai_addr, address.ai_addrlen) == 0) return 0;
  if (errno != EINPROGRESS) return errno;
  if (!socket_ready(socket, POLLOUT, deadline)) return ETIMEDOUT;
  int problem = 0;
  socklen_t size = sizeof problem;
  getsockopt(socket, SOL_SOCKET, SO_ERROR, &problem, &size);
  return problem;
}

}  // namespace

core::Result<ByteLink> ByteLink::connect(const std::string& host, int port, WallDeadline deadline) {
  const std::string peer = host + ':' + std::to_string(port);
  auto addresses = addresses_of(host, port, SOCK_STREAM);
  if (!addresses) return core::forward(addresses);
  int problem = EHOSTUNREACH;
  for (const addrinfo* a = addresses->get(); a; a = a->ai_next) {
    const int socket = ::socket(a->ai_family, a->ai_socktype | SOCK_NONBLOCK | SOCK_CLOEXEC, a->ai_protocol);
    if (socket < 0) {
      problem = errno;
      continue;
    }
    ByteLink link(socket, peer);
    problem = finish_connect(socket, *a, deadline);
    if (problem != 0) continue;
    const int on = 1;
    setsockopt(socket, IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
    return link;
  }
  if (problem == ETIMEDOUT) return too_late(peer, "no answer to the connection request");
  return broken(peer, std::string("cannot connect: ") + std::strerror(problem));
}

ByteLink::ByteLink(ByteLink&& other) noexcept
    : socket_(std::exchange(other.socket_, -1)), peer_(std::move(other.peer_)) {}

ByteLink& ByteLink::operator=(ByteLink&& other) noexcept {
  std::swap(socket_, other.socket_);
  std::swap(peer_, other.peer_);
  return *this;
}

ByteLink::~ByteLink() {
  if (socket_ >= 0) close(socket_);
}

core::Status ByteLink::write(std::string_view bytes, WallDeadline deadline) {
  while (!bytes.empty()) {
    const ssize_t n = send(socket_, bytes.data(), bytes.size(), MSG_NOSIGNAL);
    if (n > 0) {
      bytes.remove_prefix(static_cast<std::size_t>(n));
    } else if (errno == EAGAIN || errno == EWOULDBLOCK) {
      if (!socket_ready(socket_, POLLOUT, deadline)) return too_late(peer_, "the controller takes no more data");
    } else if (errno != EINTR) {
      return broken(peer_, std::string("connection lost while sending: ") + std::strerror(errno));
    }
  }
  return {};
}

core::Result<std::size_t> ByteLink::read(std::span<char> buffer, WallDeadline deadline) {
  for (;;) {
    const ssize_t n = recv(socket_, buffer.data(), buffer.size(), 0);
    if (n > 0) return static_cast<std::size_t>(n);
    if (n == 0) return broken(peer_, "the controller closed the connection");
    if (errno == EAGAIN || errno == EWOULDBLOCK) {
      if (!socket_ready(socket_, POLLIN, deadline)) return too_late(peer_, "no answer within the deadline");
    } else if (errno != EINTR) {
      return broken(peer_, std::string("connection lost: ") + std::strerror(errno));
    }
  }
}

}  // namespace pickcell::robot
