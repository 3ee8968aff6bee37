#pragma once
/// A TCP connection with a deadline on everything, in wall time. The transport under the clients.

#include <cstddef>
#include <span>
#include <string>
#include <string_view>

#include "pickcell/core/result.hpp"
#include "pickcell/robot/sockets.hpp"

namespace pickcell::robot {

/// One thread at a time. Errors name the peer as host:port: link (refused, lost, closed), timeout. After an error the
/// link is of no more use, except after a timeout of read().
class ByteLink {
 public:
  /// Connects with TCP_NODELAY. A name that DNS must resolve can take longer than the deadline; an address cannot.
  [[nodiscard]] static core::Result<ByteLink> connect(const std::string& host, int port, WallDeadline deadline);

  ByteLink(ByteLink&& other) noexcept;
  ByteLink& operator=(ByteLink&& other) noexcept;
  ~ByteLink();

  /// Sends everything.
  [[nodiscard]] core::Status write(std::string_view bytes, WallDeadline deadline);
  /// Waits for at least one byte; returns what is there, at most buffer.size(). A closed connection is an error.
  [[nodiscard]] core::Result<std::size_t> read(std::span<char> buffer, WallDeadline deadline);
  /// host:port
  [[nodiscard]] const std::string& peer() const { return peer_; }

 private:
  ByteLink(int socket, std::string peer) : socket_(socket), peer_(std::move(peer)) {}
  int socket_ = -1;
  std::string peer_;
};

}  // namespace pickcell::robot
