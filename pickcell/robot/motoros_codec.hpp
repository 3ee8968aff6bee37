#pragma once
/// simple_message as Yaskawa's MotoROS 1 speaks it: frames, messages, and their bytes in either order. Pure.
/// Source: docs/yaskawa-protocols.md section 3; the layouts are those of MotoROS 1.9 (SimpleMessage.h).
///
/// A frame is `i32 length` (of what follows), `i32 type, comm type, reply type`, and a body of 32-bit fields. The byte
/// order is the controller's own: big on FS100, little on DX100, DX200, YRC1000.

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "pickcell/core/result.hpp"

namespace pickcell::robot {

enum class ByteOrder { little, big };

/// Message types; others exist and are carried as numbers.
namespace moto {
constexpr std::int32_t kPing = 1;
constexpr std::int32_t kRobotStatus = 13;
constexpr std::int32_t kTrajectoryPoint = 14;
constexpr std::int32_t kFeedback = 15;
constexpr std::int32_t kMotionControl = 2001;
constexpr std::int32_t kMotionReply = 2002;
constexpr std::int32_t kReadBit = 2003, kReadBitReply = 2004, kWriteBit = 2005, kWriteBitReply = 2006;
constexpr std::int32_t kReadGroup = 2007, kReadGroupReply = 2008, kWriteGroup = 2009, kWriteGroupReply = 2010;
constexpr std::int32_t kIoReply = 2011;
constexpr std::int32_t kReadRegister = 2012, kWriteRegister = 2013;  ///< answered under their own number
constexpr std::int32_t kTrajectoryPointEx = 2016;
constexpr std::int32_t kFeedbackEx = 2017;
constexpr std::int32_t kSelectTool = 2018;
constexpr std::int32_t kDhParameters = 2020;

/// The type of the reply to an I/O request.
constexpr std::int32_t io_reply(std::int32_t request) {
  return request == kReadRegister || request == kWriteRegister ? request : request + 1;
}

/// Comm types and reply types.
constexpr std::int32_t kTopic = 1, kRequest = 2, kReply = 3;
constexpr std::int32_t kNoReply = 0, kSuccess = 1, kFailure = 2;

/// Commands of kMotionControl.
constexpr std::int32_t kCheckReady = 200101, kQueueCount = 200102, kStop = 200111, kServoOn = 200112;
constexpr std::int32_t kServoOff = 200113, kResetAlarm = 200114, kStartTrajectoryMode = 200121;
constexpr std::int32_t kStopTrajectoryMode = 200122, kDisconnect = 200130;

/// MotoReply::result, and subcodes that both sides ask for.
enum Result : std::int32_t { ok = 0, busy = 1, no = 2, invalid = 3, alarm = 4, not_ready = 5, failed = 6 };
enum Invalid : std::int32_t {
  unspecified = 3000,
  size = 3001,
  header = 3002,
  type = 3003,
  group = 3004,
  sequence = 3005,
  command = 3006,
  data = 3010,
  start_position = 3011,
  position = 3012,
  speed = 3013,
  acceleration = 3014,
  fields_missing = 3015,
  time = 3016,
  tool = 3017,
};
enum NotReady : std::int32_t {
  because_unspecified = 5000,
  because_alarm = 5001,
  because_error = 5002,
  because_emergency_stop = 5003,
  because_not_play = 5004,
  because_not_remote = 5005,
  because_servo_off = 5006,
  because_hold = 5007,
  because_not_started = 5008,
  because_not_waiting = 5009,
};
enum IoResult : std::int32_t { io_ok = 0, bad_read_address = 1001, bad_write_address = 1002, bad_value = 1003 };

/// MotoTrajectoryPoint::valid.
constexpr std::int32_t kTimeValid = 1, kPositionValid = 2, kVelocityValid = 4, kAccelerationValid = 8;

constexpr std::size_t kJoints = 10;
constexpr std::size_t kGroups = 4;
constexpr std::size_t kDhLinks = 8;
}  // namespace moto

/// One message on the wire, its body as 32-bit words in this machine's order.
struct MotoFrame {
  std::int32_t type = 0, comm = 0, reply = 0;
  std::vector<std::uint32_t> body;
  bool operator==(const MotoFrame&) const = default;
};

/// Base to tool, radians (per second, per second squared); the rest 0.
using MotoJoints = std::array<float, moto::kJoints>;

struct MotoStatus {  ///< 13. -1 unknown, 0 no, 1 yes
  std::int32_t drives_powered = -1, e_stopped = -1, error_code = 0, in_error = -1, in_motion = -1;
  std::int32_t mode = -1;  ///< 1 manual, 2 auto
  std::int32_t motion_possible = -1;
  bool operator==(const MotoStatus&) const = default;
};
struct MotoFeedback {  ///< 15
  std::int32_t group = 0, valid = 0;
  float time_s = 0;
  MotoJoints position{}, velocity{}, acceleration{};
  bool operator==(const MotoFeedback&) const = default;
};
struct MotoTrajectoryPoint {  ///< 14
  std::int32_t group = 0, sequence = 0, valid = 0;
  float time_s = 0;
  MotoJoints position{}, velocity{}, acceleration{};
  bool operator==(const MotoTrajectoryPoint&) const = default;
};
struct MotoTrajectoryPointEx {  ///< 2016: the first `groups` of `parts` count
  std::int32_t groups = 0, sequence = 0;
  std::array<MotoFeedback, moto::kGroups> parts{};
  bool operator==(const MotoTrajectoryPointEx&) const = default;
};
struct MotoFeedbackEx {  ///< 2017: sent with two or more groups
  std::int32_t groups = 0;
  std::array<MotoFeedback, moto::kGroups> parts{};
  bool operator==(const MotoFeedbackEx&) const = default;
};
struct MotoCommand {  ///< 2001
  std::int32_t group = 0, sequence = 0, command = 0;
  MotoJoints data{};
  bool operator==(const MotoCommand&) const = default;
};
struct MotoReply {  ///< 2002
  std::int32_t group = 0, sequence = 0;
  std::int32_t command = 0;  ///< what it answers: a command, or the type of the point
  std::int32_t result = 0, subcode = 0;
  MotoJoints data{};
  bool operator==(const MotoReply&) const = default;
};
struct MotoSelectTool {  ///< 2018
  std::int32_t group = 0, tool = 0, sequence = 0;
  bool operator==(const MotoSelectTool&) const = default;
};
struct MotoDhLink {  ///< as the controller keeps them; no unit is published
  float theta = 0, d = 0, a = 0, alpha = 0;
  bool operator==(const MotoDhLink&) const = default;
};
struct MotoDhParameters {  ///< 2020: groups the controller does not have are 0
  std::array<std::array<MotoDhLink, moto::kDhLinks>, moto::kGroups> groups{};
  bool operator==(const MotoDhParameters&) const = default;
};
/// The I/O messages. Addresses: contact (27010), group = contact / 10, or register number.
struct MotoAddress {  ///< 2003, 2007, 2012
  std::uint32_t address = 0;
  bool operator==(const MotoAddress&) const = default;
};
struct MotoWrite {  ///< 2005, 2009, 2014
  std::uint32_t address = 0, value = 0;
  bool operator==(const MotoWrite&) const = default;
};
struct MotoValue {  ///< 2004, 2008, 2013
  std::uint32_t value = 0;
  std::int32_t result = 0;
  bool operator==(const MotoValue&) const = default;
};
struct MotoWritten {  ///< 2006, 2010, 2015
  std::int32_t result = 0;
  bool operator==(const MotoWritten&) const = default;
};
struct MotoIoRefusal {  ///< 2011
  std::int32_t result = 0, subcode = 0;
  bool operator==(const MotoIoRefusal&) const = default;
};

// --- bytes <-> frames

/// Bytes of the prefix and header; of the longest body.
constexpr std::size_t kMotoHeaderBytes = 16;
constexpr std::size_t kMotoLongestBody = 536;

/// The frame as one write wants it. Throws std::invalid_argument for a body longer than any message's.
[[nodiscard]] std::string moto_bytes(const MotoFrame& frame, ByteOrder order);

/// The order in which these first four bytes are a possible length; empty when in none.
[[nodiscard]] std::optional<ByteOrder> moto_byte_order(std::span<const char, 4> first_bytes);

/// Cuts a byte stream into frames, however it arrives. Holds at most one frame and what was fed last.
class MotoFrameSplitter {
 public:
  explicit MotoFrameSplitter(ByteOrder order) : order_(order) {}
  void feed(std::string_view bytes) { bytes_.append(bytes); }
  /// The next whole frame, or nothing yet. Error: a length no frame has (the stream is lost: close it).
  [[nodiscard]] core::Result<std::optional<MotoFrame>> next();
  /// Bytes of an unfinished frame.
  [[nodiscard]] std::size_t pending() const { return bytes_.size(); }

 private:
  ByteOrder order_;
  std::string bytes_;
};

// --- frames <-> messages. Errors (link): another type, or a body of another length.

[[nodiscard]] MotoFrame moto_frame(const MotoStatus& m);
[[nodiscard]] MotoFrame moto_frame(const MotoFeedback& m);
[[nodiscard]] MotoFrame moto_frame(const MotoFeedbackEx& m);
[[nodiscard]] MotoFrame moto_frame(const MotoTrajectoryPoint& m);
[[nodiscard]] MotoFrame moto_frame(const MotoTrajectoryPointEx& m);
[[nodiscard]] MotoFrame moto_frame(const MotoCommand& m);
[[nodiscard]] MotoFrame moto_frame(const MotoReply& m);
[[nodiscard]] MotoFrame moto_frame(const MotoSelectTool& m);
[[nodiscard]] MotoFrame moto_frame(const MotoDhParameters& m);
[[nodiscard]] MotoFrame moto_frame(const MotoIoRefusal& m);
/// The type says which request or reply it is.
[[nodiscard]] MotoFrame moto_frame(std::int32_t type, const MotoAddress& m);
[[nodiscard]] MotoFrame moto_frame(std::int32_t type, const MotoWrite& m);
[[nodiscard]] MotoFrame moto_frame(std::int32_t type, const MotoValue& m);
[[nodiscard]] MotoFrame moto_frame(std::int32_t type, const MotoWritten& m);

[[nodiscard]] core::Result<MotoStatus> parse_moto_status(const MotoFrame& frame);
[[nodiscard]] core::Result<MotoFeedback> parse_moto_feedback(const MotoFrame& frame);
/// As with points: parts beyond `groups` may be missing.
[[nodiscard]] core::Result<MotoFeedbackEx> parse_moto_feedback_ex(const MotoFrame& frame);
[[nodiscard]] core::Result<MotoTrajectoryPoint> parse_moto_point(const MotoFrame& frame);
/// A host may leave out the parts beyond `groups`. Error also for more than four groups.
[[nodiscard]] core::Result<MotoTrajectoryPointEx> parse_moto_point_ex(const MotoFrame& frame);
[[nodiscard]] core::Result<MotoCommand> parse_moto_command(const MotoFrame& frame);
[[nodiscard]] core::Result<MotoReply> parse_moto_reply(const MotoFrame& frame);
[[nodiscard]] core::Result<MotoSelectTool> parse_moto_select_tool(const MotoFrame& frame);
[[nodiscard]] core::Result<MotoDhParameters> parse_moto_dh_parameters(const MotoFrame& frame);
[[nodiscard]] core::Result<MotoAddress> parse_moto_address(const MotoFrame& frame, std::int32_t type);
[[nodiscard]] core::Result<MotoWrite> parse_moto_write(const MotoFrame& frame, std::int32_t type);
[[nodiscard]] core::Result<MotoValue> parse_moto_value(const MotoFrame& frame, std::int32_t type);
[[nodiscard]] core::Result<MotoWritten> parse_moto_written(const MotoFrame& frame, std::int32_t type);
[[nodiscard]] core::Result<MotoIoRefusal> parse_moto_io_refusal(const MotoFrame& frame);

}  // namespace pickcell::robot
