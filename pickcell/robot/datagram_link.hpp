#pragma once
/// A UDP socket tied to one peer, with a deadline on everything, in wall time. The transport under HsesClient.

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

#include "pickcell/core/result.hpp"
#include "pickcell/robot/sockets.hpp"

namespace pickcell::robot {

/// One thread at a time. Errors name the peer as host:port: link (nobody listens there, network down), timeout.
class DatagramLink {
 public:
  /// Nothing is sent yet. A name that DNS must resolve can take its time; an address does not.
  [[nodiscard]] static core::Result<DatagramLink> open(const std::string& host, int port);

  DatagramLink(DatagramLink&& other) noexcept;
  DatagramLink& operator=(DatagramLink&& other) noexcept;
  ~DatagramLink();

  [[nodiscard]] core::Status send(std::span<const std::uint8_t> datagram);
  /// The next datagram of the peer; what does not fit the buffer is cut off. Returns its size.
  [[nodiscard]] core::Result<std::size_t> receive(std::span<std::uint8_t> buffer, WallDeadline deadline);
  /// Throws away what has arrived.
  void drain();
  /// host:port
  [[nodiscard]] const std::string& peer() const { return peer_; }

 private:
  DatagramLink(int socket, std::string peer) : socket_(socket), peer_(std::move(peer)) {}
  int socket_ = -1;
  std::string peer_;
};

}  // namespace pickcell::robot
