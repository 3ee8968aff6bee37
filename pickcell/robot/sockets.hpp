#pragma once
/// What the TCP and the UDP link share: deadlines in wall time and addresses.

#include <chrono>
#include <memory>
#include <string>

#include "pickcell/core/result.hpp"

struct addrinfo;

namespace pickcell::robot {

using WallDeadline = std::chrono::steady_clock::time_point;

[[nodiscard]] inline WallDeadline from_now(std::chrono::milliseconds time) {
  return std::chrono::steady_clock::now() + time;
}

/// True when the socket is ready for the events of poll(2), or has an error to tell, before the deadline.
[[nodiscard]] bool socket_ready(int socket, short events, WallDeadline deadline);

/// timeout once the deadline has passed. For loops that read on because what came was no answer: a peer that never
/// falls silent must not keep them for ever.
[[nodiscard]] core::Status in_time(const std::string& peer, WallDeadline deadline);

struct FreeAddresses {
  void operator()(addrinfo* list) const;
};
using Addresses = std::unique_ptr<addrinfo, FreeAddresses>;

/// For SOCK_STREAM or SOCK_DGRAM; at least one. A name that DNS must resolve can take its time; an address does not.
/// Error: link, naming host:port.
[[nodiscard]] core::Result<Addresses> addresses_of(const std::string& host, int port, int socket_type);

}  // namespace pickcell::robot
