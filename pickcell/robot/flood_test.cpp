// A peer that never falls silent and never answers: each link gives up at its deadline.

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <atomic>
#include <thread>

#include "pickcell/robot/hses_client.hpp"
#include "pickcell/robot/motoros_client.hpp"
#include "pickcell/robot/tcp80_client.hpp"

namespace pickcell::robot {
namespace {

using core::ErrorCode;
using std::chrono::milliseconds;

/// Sends the same bytes again and again, on TCP to whoever connects, on UDP to whoever has sent something.
class Flood {
 public:
  Flood(int type, std::string greeting, std::string bytes) : type_(type) {
    socket_ = socket(AF_INET, type, 0);
    sockaddr_in at{};
    at.sin_family = AF_INET;
    at.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t size = sizeof at;
    EXPECT_EQ(bind(socket_, reinterpret_cast<sockaddr*>(&at), size), 0);
    getsockname(socket_, reinterpret_cast<sockaddr*>(&at), &size);
    port_ = ntohs(at.sin_port);
    EXPECT_TRUE(type_ != SOCK_STREAM || listen(socket_, 4) == 0);
    thread_ = std::thread([this, greeting, bytes] { run(greeting, bytes); });
  }
  ~Flood() {
    ended_ = true;
    shutdown(socket_, SHUT_RDWR);
    thread_.join();
    close(socket_);
  }
  Flood(const Flood&) = delete;
  Flood& operator=(const Flood&) = delete;
  [[nodiscard]] int port() const { return port_; }

 private:
  void run(const std::string& greeting, const std::string& bytes) {
    while (!ended_) {
      sockaddr_in to{};
      socklen_t size = sizeof to;
      char heard = 0;
      const int out = type_ == SOCK_STREAM ? accept(socket_, nullptr, nullptr) : socket_;
      if (out < 0) return;
      if (type_ == SOCK_DGRAM && recvfrom(out, &heard, 1, 0, reinterpret_cast<sockaddr*>(&to), &size) < 0) return;
      bool open = send(out, greeting, to);
      while (open && !ended_) open = send(out, bytes, to);
      if (type_ == SOCK_STREAM) close(out);
    }
  }
  bool send(int out, const std::string& bytes, const sockaddr_in& to) const {
    if (bytes.empty()) return true;
    const auto* where = type_ == SOCK_DGRAM ? reinterpret_cast<const sockaddr*>(&to) : nullptr;
    return sendto(out, bytes.data(), bytes.size(), MSG_NOSIGNAL, where, where ? sizeof to : 0) > 0;
  }

  int type_, socket_ = -1, port_ = 0;
  std::atomic<bool> ended_ = false;
  std::thread thread_;
};

TEST(Flood, OfZeroBytesEndsTheWaitForALine) {
  const Flood flood(SOCK_STREAM, "", std::string(400, '\0'));
  Tcp80Settings settings{.host = "127.0.0.1", .port = flood.port()};
  settings.line_timeout = milliseconds(200);
  Tcp80Client client(settings);
  const auto connected = client.connect();
  ASSERT_FALSE(connected);
  EXPECT_EQ(connected.error().code, ErrorCode::timeout) << connected.error().line();
}

TEST(Flood, OfStrangeDatagramsEndsTheWaitForAnAnswer) {
  const Flood flood(SOCK_DGRAM, "", "no frame");
  HsesSettings settings{.host = "127.0.0.1", .port = flood.port()};
  settings.timeout = milliseconds(100);
  settings.tries = 2;
  HsesClient client(settings);
  const auto connected = client.connect();
  ASSERT_FALSE(connected);
  EXPECT_EQ(connected.error().code, ErrorCode::timeout) << connected.error().line();
}

TEST(Flood, OfOtherMessagesEndsTheWaitForAState) {
  // Little endian: 12 bytes follow, type 1 (ping), topic, reply 0: well formed, and no state.
  const std::string ping("\x0C\0\0\0\x01\0\0\0\x01\0\0\0\0\0\0\0", 16);
  const Flood flood(SOCK_STREAM, "", ping);
  MotoRosClientSettings settings;
  settings.host = "127.0.0.1";
  settings.port = flood.port() - 1;  // states come on the next one
  settings.order = ByteOrder::little;
  settings.state_timeout = milliseconds(200);
  MotoRosClient client(settings);
  const auto state = client.read_state();
  ASSERT_FALSE(state);
  EXPECT_EQ(state.error().code, ErrorCode::timeout) << state.error().line();
}

}  // namespace
}  // namespace pickcell::robot
