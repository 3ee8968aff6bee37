#include "pickcell/sim/tcp_door.hpp"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <sys/eventfd.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <system_error>
#include <utility>

namespace pickcell::sim {

WallClock::duration wall(double s) {
  return std::chrono::duration_cast<WallClock::duration>(std::chrono::duration<double>(s));
}

core::Result<int> listen_on(const std::string& bind, int port, const std::string& remedy) {
  sockaddr_in a{};
  a.sin_family = AF_INET;
  a.sin_port = htons(static_cast<std::uint16_t>(port));
  if (::inet_pton(AF_INET, bind.c_str(), &a.sin_addr) != 1)
    return core::failure(core::ErrorCode::usage, bind, "not an IPv4 address", "give one of this machine's, or 0.0.0.0");
  const int fd = ::socket(AF_INET, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
  const int yes = 1;
  if (fd >= 0 && ::setsockopt(fd, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes) == 0 &&
      ::bind(fd, reinterpret_cast<const sockaddr*>(&a), sizeof a) == 0 && ::listen(fd, 8) == 0)
    return fd;
  const std::string why = std::strerror(errno);
  if (fd >= 0) (void)::close(fd);
  return core::failure(core::ErrorCode::link, "TCP port " + std::to_string(port) + " on " + bind, why, remedy);
}

int bound_port(int fd) {
  sockaddr_in a{};
  socklen_t size = sizeof a;
  return ::getsockname(fd, reinterpret_cast<sockaddr*>(&a), &size) == 0 ? ntohs(a.sin_port) : 0;
}

int accept_host(int listener) {
  const int fd = ::accept4(listener, nullptr, nullptr, SOCK_NONBLOCK | SOCK_CLOEXEC);
  const int yes = 1;
  if (fd >= 0) (void)::setsockopt(fd, IPPROTO_TCP, TCP_NODELAY, &yes, sizeof yes);
  return fd;
}

void reset(int fd) {
  const linger at_once{1, 0};
  (void)::setsockopt(fd, SOL_SOCKET, SO_LINGER, &at_once, sizeof at_once);
  (void)::close(fd);
}

Wake::Wake() : fd_(::eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK)) {
  if (fd_ < 0) throw std::system_error(errno, std::generic_category(), "eventfd");
}

Wake::~Wake() { (void)::close(fd_); }

void Wake::ring() const {
  const std::uint64_t one = 1;
  (void)!::write(fd_, &one, sizeof one);
}

void Poll::wait() {
  int timeout_ms = -1;
  if (until_) {
    const auto left = std::chrono::ceil<std::chrono::milliseconds>(*until_ - WallClock::now()).count();
    timeout_ms = static_cast<int>(std::clamp<long long>(left, 0, 60'000));
  }
  (void)::poll(fds_.data(), fds_.size(), timeout_ms);
}

Out spoilt(const std::optional<SpoiltAnswers>& fault, Out answer) {
  if (!fault) return answer;
  switch (fault->kind) {
    case AnswerFault::drop:
      answer.bytes.clear();
      break;
    case AnswerFault::twice:
      answer.bytes += std::string(answer.bytes);
      break;
    case AnswerFault::late:
      answer.due += wall(fault->delay_s);
      break;
    case AnswerFault::half_line:
      answer.bytes.resize(answer.bytes.size() / 2);
      break;
    case AnswerFault::truncate:
      answer.bytes.resize(answer.bytes.size() / 2);
      answer.then = Out::Then::close;
      break;
    case AnswerFault::reset_after_ok:
      answer.bytes.clear();
      answer.then = Out::Then::reset;
      break;
  }
  return answer;
}

std::size_t Outbox::bytes() const {
  std::size_t sum = 0;
  for (const Out& out : waiting_) sum += out.bytes.size();
  return sum;
}

bool Outbox::due(Poll& poll, WallClock::time_point now) const {
  if (waiting_.empty()) return false;
  if (waiting_.front().due <= now) return true;
  poll.wake_at(waiting_.front().due);
  return false;
}

Outbox::Sent Outbox::send(int fd) {
  while (!waiting_.empty() && waiting_.front().due <= WallClock::now()) {
    Out& out = waiting_.front();
    while (!out.bytes.empty()) {
      const ssize_t n = ::send(fd, out.bytes.data(), out.bytes.size(), MSG_NOSIGNAL);
      if (n < 0) return errno == EAGAIN || errno == EINTR ? Sent::waits : Sent::broken;
      out.bytes.erase(0, static_cast<std::size_t>(n));
    }
    const Out::Then then = out.then;
    waiting_.pop_front();
    if (then == Out::Then::close) return Sent::ends;
    if (then == Out::Then::reset) return Sent::resets;
  }
  return waiting_.empty() ? Sent::all : Sent::waits;
}

}  // namespace pickcell::sim
