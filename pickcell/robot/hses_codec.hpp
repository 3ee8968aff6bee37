#pragma once
/// Commands of the High Speed Ethernet Server and their payloads: structs to bytes and back, no sockets.
/// Source: docs/yaskawa-protocols.md 2.2-2.6. Parsers take any bytes; what is not exactly right is a failure of code
/// `link`, never a guess.

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "pickcell/core/result.hpp"
#include "pickcell/robot/controller_link.hpp"
#include "pickcell/robot/hses_frame_codec.hpp"
#include "pickcell/robot/hses_variable_codec.hpp"  // of variables, single and plural
#include "pickcell/robot/position.hpp"
#include "pickcell/robot/robot.hpp"

namespace pickcell::robot {

/// Command numbers.
enum HsesCommand : std::uint16_t {
  kHsesAlarm = 0x70,
  kHsesAlarmHistory = 0x71,
  kHsesStatus = 0x72,
  kHsesJob = 0x73,
  kHsesAxisNames = 0x74,
  kHsesPosition = 0x75,
  kHsesPositionError = 0x76,
  kHsesTorque = 0x77,
  kHsesIo = 0x78,
  kHsesRegister = 0x79,
  kHsesB = 0x7A,
  kHsesI = 0x7B,
  kHsesD = 0x7C,
  kHsesR = 0x7D,
  kHsesS16 = 0x7E,
  kHsesP = 0x7F,
  kHsesBp = 0x80,
  kHsesEx = 0x81,
  kHsesReset = 0x82,
  kHsesPower = 0x83,  ///< hold, servo, HLOCK
  kHsesCycle = 0x84,
  kHsesMessage = 0x85,
  kHsesStart = 0x86,
  kHsesSelect = 0x87,
  kHsesTime = 0x88,
  kHsesSystem = 0x89,
  kHsesMove = 0x8A,
  kHsesMovePulse = 0x8B,
  kHsesS32 = 0x8C,
};

/// Instances.
constexpr std::uint16_t kHsesRobotPulse = 1, kHsesRobotCartesian = 101;
constexpr std::uint16_t kHsesHold = 1, kHsesServo = 2, kHsesLock = 3;
constexpr std::uint16_t kHsesResetAlarm = 1, kHsesCancelError = 2;
/// Of kHsesAlarmHistory: the newest of each list; the 99 before it follow.
constexpr std::uint16_t kHsesMajorAlarms = 1, kHsesMonitorAlarms = 1001, kHsesUserAlarmsOfSystem = 2001,
                        kHsesUserAlarmsOfUser = 3001, kHsesOfflineAlarms = 4001;
constexpr std::size_t kHsesJobNameBytes = 32;
constexpr std::size_t kHsesMessageBytes = 30;

// --- requests ------------------------------------------------------------------------------------------------------

/// A reading command: attribute 0 is read by get_all, any other by get_one.
[[nodiscard]] HsesRequest hses_get(std::uint16_t command, std::uint16_t instance, std::uint8_t attribute = 0);
/// One attribute is written.
[[nodiscard]] HsesRequest hses_set_one(std::uint16_t command, std::uint16_t instance, HsesBytes payload,
                                       std::uint8_t attribute = 1);
/// The whole element is written (P, job selection).
[[nodiscard]] HsesRequest hses_set_all(std::uint16_t command, std::uint16_t instance, HsesBytes payload);
/// on: 1, off: 2. `what`: kHsesHold, kHsesServo or kHsesLock.
[[nodiscard]] HsesRequest hses_power(std::uint16_t what, bool on);
/// Job names: no `.JBI`, at most 32 bytes; longer ones throw std::invalid_argument.
[[nodiscard]] HsesRequest hses_select_job(std::string_view job, std::uint32_t line);
/// Of a task, 0-5; another throws std::invalid_argument.
[[nodiscard]] HsesRequest hses_select_master(std::string_view job, int task = 0);
[[nodiscard]] HsesRequest hses_start();
/// 1 step, 2 one cycle, 3 continuous.
[[nodiscard]] HsesRequest hses_cycle(std::uint32_t mode);
/// At most 30 bytes; more throw std::invalid_argument.
[[nodiscard]] HsesRequest hses_message(std::string_view text);
/// Files: service file_list with a pattern, file_save, file_load or file_delete with a name.
[[nodiscard]] HsesRequest hses_file(HsesService service, std::string_view name);
/// A block of a file to the controller (block from 1; the last one is marked), or with no data an acknowledgement.
[[nodiscard]] HsesRequest hses_file_block(HsesService service, std::uint32_t block, HsesBytes data = {});

// --- payloads ------------------------------------------------------------------------------------------------------

[[nodiscard]] core::Result<RobotState> parse_hses_status(HsesView payload);

struct HsesAlarmData {
  std::uint32_t code = 0, data = 0, type = 0;
  std::string time;  ///< YYYY/MM/DD hh:mm
  std::string name;
  std::string sub_code_info, sub_code_data, sub_code_reverse;  ///< newer controllers; "" otherwise
};
/// Without and with sub codes (16 + 96 + 96 bytes of text, as a public client of a YRC1000micro has it).
constexpr std::size_t kHsesAlarmBytes = 60, kHsesAlarmWithSubCodeBytes = 268;
[[nodiscard]] core::Result<HsesAlarmData> parse_hses_alarm(HsesView payload);
[[nodiscard]] HsesBytes hses_payload(const HsesAlarmData& alarm);

struct HsesJobInfo {
  std::string name;
  std::uint32_t line = 0, step = 0, speed_override = 0;
};
[[nodiscard]] core::Result<HsesJobInfo> parse_hses_job(HsesView payload);
[[nodiscard]] HsesBytes hses_payload(const HsesJobInfo& job);

/// Position data word by word: 0 pulse, 16 base, 17 robot, 18 user, 19 tool; axes in pulses, or X Y Z in 0.001 mm, Rx
/// Ry Rz Re in 0.0001 deg.
struct HsesPosition {
  std::uint32_t type = 0, form = 0, tool = 0, user = 0, extended_form = 0;
  std::array<std::int32_t, 8> axes{};
  bool operator==(const HsesPosition&) const = default;
};
constexpr std::size_t kHsesPositionBytes = 52;
/// 44 to 52 bytes; axes that are left out are 0.
[[nodiscard]] core::Result<HsesPosition> parse_hses_position(HsesView payload);
[[nodiscard]] HsesBytes hses_payload(const HsesPosition& position);
/// In the terms of this program. Positions in the tool frame, tools beyond 63 and form bits that mean other axes have
/// none: failure of code refused.
[[nodiscard]] core::Result<VariablePosition> variable_position(const HsesPosition& position);
/// Frame numbers as in RPOSC: 0 base, 1 robot, 2.. user 1... A position that is not finite or too far, a tool beyond
/// 63 or a frame beyond 65 throws std::invalid_argument.
[[nodiscard]] HsesPosition hses_position(const VariablePosition& position);

/// Form over HSES: bit 0 back, 1 elbow below, 2 no-flip, 3 R, 4 T, 5 S >= 180 (TCP swaps 0 and 2).
[[nodiscard]] std::uint32_t hses_form(const Form& form);
[[nodiscard]] Form hses_form(std::uint32_t bits);

/// Speed of a direct move as it goes over the wire.
struct HsesSpeed {
  std::uint32_t kind = 0;   ///< 0: 0.01 %, 1: V in 0.1 mm/s, 2: VR in 0.1 deg/s
  std::uint32_t value = 0;  ///< in that unit
};
enum class HsesMoveKind : std::uint16_t { joint = 1, line = 2, line_by = 3 };

/// 0x8A: 26 words. The position's type says the frame.
struct HsesMoveData {
  std::uint32_t robot = 1, station = 0;
  HsesSpeed speed;
  HsesPosition target;  ///< axes X Y Z Rx Ry Rz Re
};
[[nodiscard]] core::Result<HsesMoveData> parse_hses_move(HsesView payload);
[[nodiscard]] HsesRequest hses_move(HsesMoveKind kind, const HsesMoveData& move);

/// 0x8B: 22 words.
struct HsesPulseMoveData {
  std::uint32_t robot = 1, station = 0;
  HsesSpeed speed;
  std::array<std::int32_t, 8> pulses{};
  std::uint32_t tool = 0;
};
[[nodiscard]] core::Result<HsesPulseMoveData> parse_hses_pulse_move(HsesView payload);
[[nodiscard]] HsesRequest hses_pulse_move(HsesMoveKind kind, const HsesPulseMoveData& move);

/// 0x89: 24 + 16 + 8 bytes of text.
struct HsesSystemInfo {
  std::string software, model, parameters;
};
[[nodiscard]] core::Result<HsesSystemInfo> parse_hses_system(HsesView payload);
[[nodiscard]] HsesBytes hses_payload(const HsesSystemInfo& info);

/// 0x88: 16 + 12 bytes of text.
struct HsesManagementTime {
  std::string start, elapsed;
};
[[nodiscard]] core::Result<HsesManagementTime> parse_hses_time(HsesView payload);
[[nodiscard]] HsesBytes hses_payload(const HsesManagementTime& time);

/// 0x74: eight names of 4 bytes; 0x76, 0x77: eight numbers.
[[nodiscard]] core::Result<std::array<std::string, 8>> parse_hses_axis_names(HsesView payload);
[[nodiscard]] core::Result<std::array<std::int32_t, 8>> parse_hses_axes(HsesView payload);

/// Names between CR LF of a file list.
[[nodiscard]] std::vector<std::string> parse_hses_file_list(std::string_view text);

}  // namespace pickcell::robot
