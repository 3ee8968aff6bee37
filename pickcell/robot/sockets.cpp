#include "pickcell/robot/sockets.hpp"

#include <netdb.h>
#include <poll.h>
#include <sys/socket.h>

#include <algorithm>
#include <cerrno>

namespace pickcell::robot {

bool socket_ready(int socket, short events, WallDeadline deadline) {
  for (;;) {
    const auto left = std::chrono::ceil<std::chrono::milliseconds>(deadline - std::chrono::steady_clock::now()).count();
    pollfd entry{socket, events, 0};
    const int n = ::poll(&entry, 1, static_cast<int>(std::clamp<decltype(left)>(left, 0, 60'000)));
    if (n > 0 || (n < 0 && errno != EINTR)) return true;  // an error shows up in the call that follows
    if (left <= 0) return false;
  }
}

core::Status in_time(const std::string& peer, WallDeadline deadline) {
  if (std::chrono::steady_clock::now() < deadline) return {};
  return core::failure(core::ErrorCode::timeout, peer, "no answer within the deadline, but other bytes without end",
                       "check that the address is the controller's");
}

void FreeAddresses::operator()(addrinfo* list) const { freeaddrinfo(list); }

core::Result<Addresses> addresses_of(const std::string& host, int port, int socket_type) {
  addrinfo hints{};
  hints.ai_socktype = socket_type;
  addrinfo* found = nullptr;
  if (const int problem = getaddrinfo(host.c_str(), std::to_string(port).c_str(), &hints, &found); problem != 0)
    return core::failure(core::ErrorCode::link, host + ':' + std::to_string(port), gai_strerror(problem),
                         "check the controller's address");
  return Addresses(found);
}

}  // namespace pickcell::robot
