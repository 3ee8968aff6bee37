#pragma once
/// The MotoROS door: motion, state and I/O on three TCP ports in a row, one thread for all of them. It only reacts and
/// has no seat on the clock; state pairs go out every 25 ms of wall time, as a controller sends them.

#include <array>
#include <atomic>
#include <memory>
#include <optional>
#include <string>
#include <thread>

#include "pickcell/core/result.hpp"
#include "pickcell/robot/motoros_codec.hpp"
#include "pickcell/sim/answer_faults.hpp"
#include "pickcell/sim/motoros_motion.hpp"
#include "pickcell/sim/tcp_door.hpp"

namespace pickcell::sim {

struct MotoRosDoorSettings {
  std::string bind = "127.0.0.1";
  int port = 0;  ///< of motion; state and I/O on the next two. 0: any three free ones in a row
  robot::ByteOrder order = robot::ByteOrder::little;
};

/// What the door asks of the controller. Called in the door's thread.
class MotoRosHost {
 public:
  virtual ~MotoRosHost() = default;
  [[nodiscard]] virtual MotoRosAnswer motion(const robot::MotoFrame& message) = 0;
  [[nodiscard]] virtual robot::MotoFrame io(const robot::MotoFrame& message) = 0;
  /// The answer that motion() announced as later.
  [[nodiscard]] virtual std::optional<robot::MotoFrame> waited() = 0;
  [[nodiscard]] virtual bool holds_motion() = 0;
  virtual void motion_host_left() = 0;
  /// Feedback and status.
  [[nodiscard]] virtual std::array<robot::MotoFrame, 2> state() = 0;
  /// Hosts on the ports for motion, state and I/O, whenever it changes.
  virtual void connected(const std::array<int, 3>& hosts) = 0;
};

class MotoRosServer {
 public:
  /// Nothing is open before open(). Host and faults must outlive the server.
  MotoRosServer(MotoRosDoorSettings settings, MotoRosHost& host, AnswerFaults& faults);
  ~MotoRosServer();
  MotoRosServer(const MotoRosServer&) = delete;
  MotoRosServer& operator=(const MotoRosServer&) = delete;

  /// Listens on all three; after close() again on the same ports. Errors: link (a port is taken), usage (bad address).
  [[nodiscard]] core::Status open();
  /// Resets all connections and stops listening.
  void close();
  /// Of motion, known after open().
  [[nodiscard]] int port() const { return port_; }

 private:
  class Loop;

  MotoRosDoorSettings settings_;
  MotoRosHost& host_;
  AnswerFaults& faults_;
  std::atomic<int> port_ = 0;
  std::array<int, 3> listeners_{-1, -1, -1};
  std::unique_ptr<Wake> wake_;
  std::jthread thread_;
};

}  // namespace pickcell::sim
