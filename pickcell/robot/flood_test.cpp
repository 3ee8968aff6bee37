// A peer that never falls silent and never answers: each link gives up. Without in_time() that is left to chance: to
// the first moment in which the peer's thread does not keep up, which may be soon. So the rule itself is tested too.

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <atomic>
#include <thread>

#include "pickcell/robot/hses_client.hpp"
#include "pickcell/robot/motoros_client.hpp"
#include "pickcell/robot/sockets.hpp"
#include "pickcell/robot/tcp80_client.hpp"

namespace pickcell::robot {
namespace {

using core::ErrorCode;
using std::chrono::milliseconds;

/// Sends the same bytes again and again, more at once than the other side reads at once, so that there is always more:
/// on TCP to whoever connects, on UDP to whoever has sent something.
class Flood {
 public:
  Flood(int type, const std::string& bytes) : type_(type) {
    socket_ = socket(AF_INET, type, 0);
    sockaddr_in at{};
    at.sin_family = AF_INET;
    at.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t size = sizeof at;
    EXPECT_EQ(bind(socket_, reinterpret_cast<sockaddr*>(&at), size), 0);
    getsockname(socket_, reinterpret_cast<sockaddr*>(&at), &size);
    port_ = ntohs(at.sin_port);
    EXPECT_TRUE(type_ != SOCK_STREAM || listen(socket_, 4) == 0);
    thread_ = std::thread([this, bytes] { run(bytes); });
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
  void run(const std::string& bytes) {
    while (!ended_) {
      sockaddr_in to{};
      socklen_t size = sizeof to;
      char heard = 0;
      const int out = type_ == SOCK_STREAM ? accept(socket_, nullptr, nullptr) : socket_;
      if (out < 0) return;
      if (type_ == SOCK_DGRAM && recvfrom(out, &heard, 1, 0, reinterpret_cast<sockaddr*>(&to), &size) < 0) return;
      while (!ended_ && send(out, bytes, to)) {
      }
      if (type_ == SOCK_STREAM) close(out);
    }
  }
  bool send(int out, const std::string& bytes, const sockaddr_in& to) const {
    const auto* where = type_ == SOCK_DGRAM ? reinterpret_cast<const sockaddr*>(&to) : nullptr;
    return sendto(out, bytes.data(), bytes.size(), MSG_NOSIGNAL, where, where ? sizeof to : 0) > 0;
  }

  int type_, socket_ = -1, port_ = 0;
  std::atomic<bool> ended_ = false;
  std::thread thread_;
};

TEST(Flood, TimeIsUpAtTheDeadlineWhateverCame) {
  EXPECT_TRUE(in_time("10.0.0.2:80", from_now(std::chrono::hours(1))));
  const auto late = in_time("10.0.0.2:80", WallDeadline{});
  ASSERT_FALSE(late);
  EXPECT_EQ(late.error().code, ErrorCode::timeout);
  EXPECT_EQ(late.error().what, "10.0.0.2:80");
}

TEST(Flood, OfZeroBytesEndsTheWaitForALine) {
  const Flood flood(SOCK_STREAM, std::string(60'000, '\0'));
  Tcp80Settings settings{.host = "127.0.0.1", .port = flood.port()};
  settings.line_timeout = milliseconds(200);
  Tcp80Client client(settings);
  const auto connected = client.connect();
  ASSERT_FALSE(connected);
  EXPECT_EQ(connected.error().code, ErrorCode::timeout) << connected.error().line();
}

TEST(Flood, OfStrangeDatagramsEndsTheWaitForAnAnswer) {
  const Flood flood(SOCK_DGRAM, "no frame");
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
  std::string pings;
  while (pings.size() < 60'000) pings += ping;
  const Flood flood(SOCK_STREAM, pings);
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
