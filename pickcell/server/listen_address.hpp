#pragma once
/// Where the HMI listens, and under which names it may be called.

#include <cstdint>
#include <string>
#include <string_view>

#include "pickcell/core/result.hpp"

namespace pickcell::server {

struct ListenAddress {
  std::string host;  ///< "127.0.0.1", "::1"; localhost becomes 127.0.0.1
  std::uint16_t port = 0;
};

/// "ADDR:PORT" or "[::1]:PORT"; port 0 asks for any free one. Only loopback addresses are accepted: other listeners
/// need a password, which this version does not have.
[[nodiscard]] core::Result<ListenAddress> parse_listen_address(std::string_view text);

/// Whether a Host header names this machine itself. A page of another site whose name was bent to 127.0.0.1 (DNS
/// rebinding) carries its own name here.
[[nodiscard]] bool names_loopback(std::string_view host_header);

}  // namespace pickcell::server
