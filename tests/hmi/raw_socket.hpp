#pragma once
/// A plain client for the server's tests: blocking sockets with a deadline, HTTP by hand, WebSocket frames by RFC 6455.

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <cstdint>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>

namespace pickcell::testing {

class RawSocket {
 public:
  explicit RawSocket(std::uint16_t port, int receive_buffer_bytes = 0) : fd_(::socket(AF_INET, SOCK_STREAM, 0)) {
    timeval deadline{20, 0};
    ::setsockopt(fd_, SOL_SOCKET, SO_RCVTIMEO, &deadline, sizeof deadline);
    if (receive_buffer_bytes > 0)
      ::setsockopt(fd_, SOL_SOCKET, SO_RCVBUF, &receive_buffer_bytes, sizeof receive_buffer_bytes);
    sockaddr_in to{};
    to.sin_family = AF_INET;
    to.sin_port = htons(port);
    to.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    if (::connect(fd_, reinterpret_cast<sockaddr*>(&to), sizeof to) != 0) throw std::runtime_error("connect failed");
  }
  RawSocket(const RawSocket&) = delete;
  RawSocket& operator=(const RawSocket&) = delete;
  ~RawSocket() { ::close(fd_); }

  void send(std::string_view bytes) {
    while (!bytes.empty()) {
      const ssize_t n = ::send(fd_, bytes.data(), bytes.size(), MSG_NOSIGNAL);
      if (n <= 0) return;  // the server has hung up: what it said before is still to be read
      bytes.remove_prefix(static_cast<std::size_t>(n));
    }
  }
  /// Exactly n bytes, or nothing when the connection ends or the deadline passes.
  std::optional<std::string> read(std::size_t n) {
    while (pending_.size() < n)
      if (!receive()) return std::nullopt;
    std::string out = pending_.substr(0, n);
    pending_.erase(0, n);
    return out;
  }
  std::optional<std::string> read_until(std::string_view mark) {
    for (;;) {
      if (const auto at = pending_.find(mark); at != std::string::npos) return read(at + mark.size());
      if (!receive()) return std::nullopt;
    }
  }
  std::string read_to_end() {
    while (receive()) {
    }
    return std::exchange(pending_, {});
  }

 private:
  bool receive() {
    std::array<char, 65536> buffer;
    const ssize_t n = ::recv(fd_, buffer.data(), buffer.size(), 0);
    if (n > 0) pending_.append(buffer.data(), static_cast<std::size_t>(n));
    return n > 0;
  }
  int fd_;
  std::string pending_;
};

struct HttpAnswer {
  int status = 0;
  std::string head, body;
  [[nodiscard]] std::string header(const std::string& name) const {
    const auto at = head.find("\r\n" + name + ": ");
    if (at == std::string::npos) return {};
    const auto begin = at + name.size() + 4;
    return head.substr(begin, head.find("\r\n", begin) - begin);
  }
};

/// One request on a connection of its own. more: further header lines, each ended by CRLF.
inline HttpAnswer ask(std::uint16_t port, const std::string& method, const std::string& target,
                      const std::string& more = {}, const std::string& body = {}) {
  RawSocket socket(port);
  std::string request = method + " " + target + " HTTP/1.1\r\n";
  if (more.find("Host:") == std::string::npos) request += "Host: 127.0.0.1:" + std::to_string(port) + "\r\n";
  request += more + "Connection: close\r\n";
  if (!body.empty()) request += "Content-Length: " + std::to_string(body.size()) + "\r\n";
  socket.send(request + "\r\n" + body);
  const std::string all = socket.read_to_end();
  const auto split = all.find("\r\n\r\n");
  if (all.size() < 12 || split == std::string::npos) return {};
  return {std::stoi(all.substr(9, 3)), all.substr(0, split + 2), all.substr(split + 4)};
}

inline HttpAnswer post(std::uint16_t port, const std::string& target, const std::string& key,
                       const std::string& more = {}) {
  return ask(port, "POST", target, "Content-Type: application/json\r\nIdempotency-Key: " + key + "\r\n" + more, "{}");
}

/// A page without a browser.
class RawPage {
 public:
  struct Message {
    bool text = false;
    bool close = false;
    std::string data;
  };
  explicit RawPage(std::uint16_t port, const std::string& more = {}, int receive_buffer_bytes = 0,
                   const std::string& protocol = "cell.v1")
      : socket_(port, receive_buffer_bytes) {
    const std::string host = "127.0.0.1:" + std::to_string(port);
    socket_.send("GET /ws HTTP/1.1\r\nHost: " + host + "\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n" +
                 "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\nSec-WebSocket-Version: 13\r\n" +
                 "Sec-WebSocket-Protocol: " + protocol + "\r\n" + more + "\r\n");
    handshake_ = socket_.read_until("\r\n\r\n").value_or("");
  }
  [[nodiscard]] int status() const { return handshake_.size() < 12 ? 0 : std::stoi(handshake_.substr(9, 3)); }
  [[nodiscard]] const std::string& handshake() const { return handshake_; }

  /// Masked with zeros, which RFC 6455 allows.
  void send(std::string_view text, char opcode = 1) {
    std::string frame{static_cast<char>(0x80 | opcode)};
    if (text.size() < 126) {
      frame += static_cast<char>(0x80 | text.size());
    } else if (text.size() < 65536) {
      frame += static_cast<char>(0x80 | 126);
      frame += static_cast<char>(text.size() >> 8);
      frame += static_cast<char>(text.size() & 0xFF);
    } else {
      frame += static_cast<char>(0x80 | 127);
      for (int shift = 56; shift >= 0; shift -= 8) frame += static_cast<char>((text.size() >> shift) & 0xFF);
    }
    socket_.send(frame + std::string(4, '\0') + std::string(text));
  }

  /// The next whole message; nothing when the connection ended. Pings are passed over.
  std::optional<Message> next() {
    for (;;) {
      const auto head = socket_.read(2);
      if (!head) return std::nullopt;
      const int opcode = (*head)[0] & 0x0F;
      std::uint64_t length = static_cast<unsigned char>((*head)[1]) & 0x7Fu;
      const int more = length == 126 ? 2 : length == 127 ? 8 : 0;
      if (more > 0) {
        const auto bytes = socket_.read(static_cast<std::size_t>(more));
        if (!bytes) return std::nullopt;
        length = 0;
        for (const char c : *bytes) length = length << 8 | static_cast<unsigned char>(c);
      }
      const auto data = socket_.read(length);
      if (!data) return std::nullopt;
      if (opcode == 1 || opcode == 2 || opcode == 8) return Message{opcode == 1, opcode == 8, *data};
    }
  }

 private:
  RawSocket socket_;
  std::string handshake_;
};

}  // namespace pickcell::testing
