#pragma once
/// Hosts on loopback sockets for tests: send bytes, receive exactly what comes.

#include <arpa/inet.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <string>
#include <string_view>

namespace pickcell::sim {

class LoopbackHost {
 public:
  explicit LoopbackHost(int port) : fd_(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
    sockaddr_in a{};
    a.sin_family = AF_INET;
    a.sin_port = htons(static_cast<std::uint16_t>(port));
    a.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    connected_ = ::connect(fd_, reinterpret_cast<const sockaddr*>(&a), sizeof a) == 0;
    const int yes = 1;
    (void)::setsockopt(fd_, IPPROTO_TCP, TCP_NODELAY, &yes, sizeof yes);
  }
  ~LoopbackHost() { (void)::close(fd_); }
  LoopbackHost(const LoopbackHost&) = delete;
  LoopbackHost& operator=(const LoopbackHost&) = delete;

  [[nodiscard]] bool connected() const { return connected_; }
  void send(std::string_view bytes) const { (void)!::send(fd_, bytes.data(), bytes.size(), MSG_NOSIGNAL); }

  /// As many bytes as asked for; fewer when the connection ends or nothing comes for the time.
  std::string receive(std::size_t n, int timeout_ms = 5000) {
    while (received_.size() < n && fill(timeout_ms)) {
    }
    const std::string bytes = received_.substr(0, n);
    received_.erase(0, bytes.size());
    return bytes;
  }
  /// Up to and including the ending.
  std::string until(std::string_view ending, int timeout_ms = 5000) {
    std::size_t at = std::string::npos;
    while ((at = received_.find(ending)) == std::string::npos && fill(timeout_ms)) {
    }
    return receive(at == std::string::npos ? received_.size() : at + ending.size());
  }
  /// Nothing more comes (within the time), and the connection stays.
  bool silent(int for_ms = 50) { return received_.empty() && !fill(for_ms) && !ended_; }
  /// The other side has closed or reset, and nothing was left.
  bool ended(int timeout_ms = 5000) {
    while (!ended_ && fill(timeout_ms)) {
    }
    return ended_ && received_.empty();
  }
  [[nodiscard]] bool was_reset() const { return reset_; }

  /// One request on a kept connection: `OK: CMD` line checked by the caller through the returned text.
  std::string command(const std::string& name, const std::string& operands = {}) {
    const std::string body = operands.empty() ? std::string() : operands + "\r";
    send("HOSTCTRL_REQUEST " + name + " " + std::to_string(body.size()) + "\r\n");
    const std::string ok = until("\r\n");
    send(body);
    return ok == "OK: " + name + "\r\n" ? until("\r") : ok;
  }

 private:
  bool fill(int timeout_ms) {
    pollfd p{fd_, POLLIN, 0};
    if (ended_ || ::poll(&p, 1, timeout_ms) <= 0) return false;
    std::array<char, 4096> buffer{};
    const ssize_t n = ::recv(fd_, buffer.data(), buffer.size(), 0);
    if (n <= 0) {
      ended_ = true;
      reset_ = n < 0;
      return false;
    }
    received_.append(buffer.data(), static_cast<std::size_t>(n));
    return true;
  }

  int fd_;
  bool connected_ = false, ended_ = false, reset_ = false;
  std::string received_;
};

/// The same for datagrams.
class UdpHost {
 public:
  explicit UdpHost(int port) : fd_(::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0)) {
    sockaddr_in a{};
    a.sin_family = AF_INET;
    a.sin_port = htons(static_cast<std::uint16_t>(port));
    a.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    (void)::connect(fd_, reinterpret_cast<const sockaddr*>(&a), sizeof a);
  }
  ~UdpHost() { (void)::close(fd_); }
  UdpHost(const UdpHost&) = delete;
  UdpHost& operator=(const UdpHost&) = delete;
  void send(const std::string& datagram) const { (void)!::send(fd_, datagram.data(), datagram.size(), 0); }
  /// The next datagram; empty when none comes for the time.
  [[nodiscard]] std::string receive(int timeout_ms = 5000) const {
    pollfd p{fd_, POLLIN, 0};
    std::string buffer(2048, '\0');
    const ssize_t n = ::poll(&p, 1, timeout_ms) > 0 ? ::recv(fd_, buffer.data(), buffer.size(), 0) : 0;
    buffer.resize(static_cast<std::size_t>(std::max<ssize_t>(n, 0)));
    return buffer;
  }
  [[nodiscard]] std::string exchange(const std::string& datagram) const {
    send(datagram);
    return receive();
  }

 private:
  int fd_;
};

}  // namespace pickcell::sim
