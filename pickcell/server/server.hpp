#pragma once
/// The HMI's server: the page, its commands over HTTP and its live data over a WebSocket (docs/hmi.md section 5).

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "pickcell/cell/cell_port.hpp"
#include "pickcell/core/result.hpp"
#include "pickcell/server/client_queue.hpp"

namespace pickcell::server {

struct ServerSettings {
  std::string listen = "127.0.0.1:8080";          ///< loopback only; port 0: any free one
  std::optional<std::filesystem::path> web_root;  ///< serve these files instead of the embedded ones
  std::vector<std::string> host_names;  ///< names beside localhost and 127.0.0.1 under which pages may call it
  std::size_t max_clients = 16;         ///< pages
  std::size_t max_video_clients = 4;
  std::size_t max_connections = 64;  ///< sockets, pages included
  double max_messages_per_s = 50;    ///< from one page
  QueueLimits queue;
  WallDuration heartbeat = std::chrono::seconds(1);
  WallDuration publish_interval = std::chrono::milliseconds(50);  ///< changes of state are gathered for so long
};

/// Runs in one thread of its own, which asks the cell and never makes it wait: the cell's threads only ring a bell.
class Server {
 public:
  /// cell must outlive the server.
  Server(ServerSettings settings, cell::CellPort& cell);
  ~Server();  ///< stops
  Server(const Server&) = delete;
  Server& operator=(const Server&) = delete;

  /// Errors: usage for an address that is malformed or not loopback, unreadable for a bad web root,
  /// device when the port is taken. Once per object.
  [[nodiscard]] core::Status start();
  /// Closes every connection; returns when nothing of it runs any more. May be called twice.
  void stop();
  /// The port that is really listened on; 0 before start().
  [[nodiscard]] std::uint16_t port() const;
  /// "http://127.0.0.1:8080/"
  [[nodiscard]] std::string url() const;

  struct Statistics {
    std::size_t clients = 0;
    std::uint64_t frames_sent = 0, clients_cut = 0;
    std::uint64_t frames_replaced = 0;  ///< of pages that have left
  };
  /// Of all clients since start. Any thread.
  [[nodiscard]] Statistics statistics() const;

 private:
  class Impl;
  std::shared_ptr<Impl> impl_;
};

}  // namespace pickcell::server
