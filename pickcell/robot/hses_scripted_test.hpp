#pragma once
/// A controller that follows a script of datagrams on a real socket.

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <functional>
#include <mutex>
#include <thread>
#include <utility>
#include <vector>

#include "pickcell/robot/hses_client.hpp"

namespace pickcell::robot {

inline HsesAnswer answer_to(const HsesRequest& r, HsesBytes payload = {}) {
  HsesAnswer a;
  a.division = r.division;
  a.id = r.id;
  a.service = r.service;
  a.payload = std::move(payload);
  return a;
}

inline HsesAnswer refusal_of(const HsesRequest& r, std::uint16_t added) {
  HsesAnswer a = answer_to(r);
  a.status = 0x1F;
  a.added_status = added;
  return a;
}

inline const HsesBytes kIdle = {194, 0, 0, 0, 0, 0, 0, 0};

/// What comes back for a request: datagrams, in order.
using Reply = std::function<std::vector<HsesBytes>(const HsesRequest&)>;

inline Reply says(HsesBytes payload) {
  return [payload](const HsesRequest& r) { return std::vector<HsesBytes>{hses_bytes(answer_to(r, payload))}; };
}
inline Reply refuses(std::uint16_t added) {
  return [added](const HsesRequest& r) { return std::vector<HsesBytes>{hses_bytes(refusal_of(r, added))}; };
}
inline const Reply kSilence = [](const HsesRequest&) { return std::vector<HsesBytes>{}; };

/// Each request gets the next reply of the script; after its end nothing.
class ScriptedController {
 public:
  explicit ScriptedController(std::vector<Reply> script) : script_(std::move(script)) {
    socket_ = socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t size = sizeof address;
    EXPECT_EQ(bind(socket_, reinterpret_cast<sockaddr*>(&address), size), 0);
    getsockname(socket_, reinterpret_cast<sockaddr*>(&address), &size);
    port_ = ntohs(address.sin_port);
    thread_ = std::thread([this] { serve(); });
  }
  ~ScriptedController() {
    shutdown(socket_, SHUT_RDWR);
    thread_.join();
    close(socket_);
  }
  [[nodiscard]] HsesSettings settings(int timeout_ms = 20000) const {
    HsesSettings s;
    s.host = "127.0.0.1";
    s.port = port_;
    s.timeout = std::chrono::milliseconds(timeout_ms);
    return s;
  }
  std::vector<HsesRequest> received() {
    const std::lock_guard lock(mutex_);
    return received_;
  }
  /// The last request as it came.
  HsesBytes last_datagram() {
    const std::lock_guard lock(mutex_);
    return last_datagram_;
  }

 private:
  void serve() {
    std::array<std::uint8_t, 1024> buffer{};
    for (;;) {
      sockaddr_in from{};
      socklen_t size = sizeof from;
      const ssize_t n = recvfrom(socket_, buffer.data(), buffer.size(), 0, reinterpret_cast<sockaddr*>(&from), &size);
      if (n <= 0) return;
      const auto request = parse_hses_request(HsesView(buffer).first(static_cast<std::size_t>(n)));
      ASSERT_TRUE(request);
      std::size_t turn = 0;
      {
        const std::lock_guard lock(mutex_);
        received_.push_back(*request);
        last_datagram_.assign(buffer.begin(), buffer.begin() + n);
        turn = received_.size() - 1;
      }
      if (turn >= script_.size()) continue;
      for (const HsesBytes& reply : script_[turn](*request))
        sendto(socket_, reply.data(), reply.size(), 0, reinterpret_cast<sockaddr*>(&from), size);
    }
  }

  std::vector<Reply> script_;
  int socket_ = -1, port_ = 0;
  std::thread thread_;
  std::mutex mutex_;
  std::vector<HsesRequest> received_;
  HsesBytes last_datagram_;
};

}  // namespace pickcell::robot
