#pragma once
/// A session with MotoROS 1 on a controller: state, motion and I/O, each on its own connection, each request within one
/// deadline. Source: docs/yaskawa-protocols.md section 3.

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>

#include "pickcell/core/result.hpp"
#include "pickcell/robot/byte_link.hpp"
#include "pickcell/robot/motoros_codec.hpp"
#include "pickcell/robot/trail.hpp"

namespace pickcell::robot {

struct MotoRosClientSettings {
  std::string host;
  int port = 50240;                ///< of motion; state and I/O on the next two
  std::optional<ByteOrder> order;  ///< empty: as the state port speaks
  std::chrono::milliseconds connect_timeout{2000};
  std::chrono::milliseconds reply_timeout{1000};
  std::chrono::milliseconds start_timeout{7000};  ///< the controller itself waits up to 5 s for its job
  std::chrono::milliseconds state_timeout{500};   ///< a pair comes every 25 ms
};

/// Of one moment, as far as the controller is concerned.
struct MotoRosState {
  MotoStatus status;
  MotoFeedback feedback;
};

/// One thread at a time. Errors: link, timeout, refused with the controller's result, subcode and their meaning. Every
/// error carries the last messages exchanged. After link or timeout on the motion port that connection is given up: a
/// late reply must not be taken for the next one's, and nobody knows whether the request was carried out. Nothing but a
/// stop is sent on it any more. Reads of state are repeated once on a new connection.
class MotoRosClient {
 public:
  explicit MotoRosClient(MotoRosClientSettings settings);

  /// State first, for the byte order, then motion. Closes what was open. The I/O connection is made when needed.
  [[nodiscard]] core::Status connect();
  [[nodiscard]] bool connected() const { return motion_.link && !motion_.doubtful; }
  void disconnect();
  /// host:port of motion
  [[nodiscard]] std::string peer() const;
  /// As set, or as seen at connect().
  [[nodiscard]] std::optional<ByteOrder> order() const { return order_; }

  /// The next pair that the controller sends (within 25 ms): what waited unread is older, and dropped. Needs the state
  /// port only.
  [[nodiscard]] core::Result<MotoRosState> read_state();

  /// False: not ready; why is in last_reply().
  [[nodiscard]] core::Result<bool> ready();
  [[nodiscard]] core::Status start_trajectory_mode();
  [[nodiscard]] core::Status stop_trajectory_mode();
  /// Ends all motion at once, without a ramp. Harmless to repeat, so it is: on the connection that is open or was given
  /// up (the controller takes no second one while it moves), then on a new one.
  [[nodiscard]] core::Status stop();
  [[nodiscard]] core::Status servo(bool on);
  [[nodiscard]] core::Status reset_alarm();
  [[nodiscard]] core::Status select_tool(int tool);
  /// Of all groups. Refused when the controller cannot read them out.
  [[nodiscard]] core::Result<MotoDhParameters> read_dh_parameters();
  /// Increments of motion that wait on the controller.
  [[nodiscard]] core::Result<int> queue_count();

  enum class Taken { yes, busy };
  /// Sends one point as it is: limits are the caller's (motoros_move.hpp). busy: it was not taken; send it again.
  [[nodiscard]] core::Result<Taken> send_point(const MotoTrajectoryPoint& point);
  [[nodiscard]] const MotoReply& last_reply() const { return last_reply_; }

  /// Contacts by number (27010), groups by contact / 10, M registers.
  [[nodiscard]] core::Result<bool> read_bit(std::uint32_t contact);
  [[nodiscard]] core::Status write_bit(std::uint32_t contact, bool on);
  [[nodiscard]] core::Result<std::uint8_t> read_group(std::uint32_t group);
  [[nodiscard]] core::Status write_group(std::uint32_t group, std::uint8_t value);
  [[nodiscard]] core::Result<std::uint16_t> read_register(std::uint32_t number);
  [[nodiscard]] core::Status write_register(std::uint32_t number, std::uint16_t value);

 private:
  struct Port {
    std::optional<ByteLink> link;
    std::optional<MotoFrameSplitter> splitter;
    bool doubtful = false;  ///< an answer is missing: fit for nothing but stop()
  };
  [[nodiscard]] core::Status open(Port& port, int offset);
  [[nodiscard]] core::Status open_state();
  [[nodiscard]] core::Result<MotoFrame> frame(Port& port, WallDeadline deadline);
  [[nodiscard]] bool quiet(Port& port);
  [[nodiscard]] core::Result<MotoRosState> fresh_pair();
  [[nodiscard]] core::Status stop_on_this_connection();
  /// One request, one reply of the type; closes the port when that does not come.
  [[nodiscard]] core::Result<MotoFrame> exchange(Port& port, const MotoFrame& request, std::int32_t reply_type,
                                                 std::chrono::milliseconds timeout);
  [[nodiscard]] core::Result<MotoReply> ask(const MotoFrame& request, const std::string& what,
                                            std::chrono::milliseconds timeout);
  [[nodiscard]] core::Status command(std::int32_t command, const std::string& what, std::chrono::milliseconds timeout);
  [[nodiscard]] core::Result<MotoValue> io_read(std::int32_t type, std::uint32_t address);
  [[nodiscard]] core::Status io_write(std::int32_t type, std::uint32_t address, std::uint32_t value);
  [[nodiscard]] core::Result<MotoFrame> io(const MotoFrame& request);
  void remember(char direction, const MotoFrame& frame);

  MotoRosClientSettings settings_;
  std::optional<ByteOrder> order_;
  Port motion_, state_, io_;
  MotoReply last_reply_;
  Trail trail_;
};

}  // namespace pickcell::robot
