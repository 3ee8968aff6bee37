#pragma once
/// Yaskawa Ethernet Server (host control, TCP port 80): bytes to structs and back, no sockets.
/// Source: docs/yaskawa-protocols.md section 1. Parsers take any text; what is not exactly right is a failure of code
/// `link`, never a guess. Units on the wire: mm with 3 decimals, degrees with 4.

#include <array>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "pickcell/core/result.hpp"
#include "pickcell/robot/controller_link.hpp"
#include "pickcell/robot/position.hpp"
#include "pickcell/robot/robot.hpp"

namespace pickcell::robot {

/// Cuts the byte stream into lines, never by the borders of received segments. A line ends with CR, LF or CRLF (status
/// lines should come with CRLF, data with CR alone, some servers send CR or LF throughout); the LF of a CRLF may come
/// any time later. NULs are dropped. One thread at a time.
class Tcp80LineSplitter {
 public:
  static constexpr std::size_t kMaxLineBytes = 16384;

  /// Takes bytes. Fails (link) when a line grows beyond kMaxLineBytes: whoever speaks there is no controller.
  [[nodiscard]] core::Status feed(std::string_view bytes);
  /// The oldest complete line, without its end.
  [[nodiscard]] std::optional<std::string> next();
  /// Bytes of an unfinished line.
  [[nodiscard]] std::string_view partial() const { return partial_; }

 private:
  std::string partial_;
  std::deque<std::string> lines_;
  bool after_cr_ = false;
};

/// What a line says by its first characters (section 1.2).
enum class Tcp80LineKind {
  ok,        ///< `OK: ...`: greeting, or command understood
  refused,   ///< `NG: ...`
  accepted,  ///< `0000`: a control command was accepted (not: finished)
  error,     ///< `ERROR: ...(NNNN).`
  data,
};
[[nodiscard]] Tcp80LineKind tcp80_line_kind(std::string_view line);

/// A line of the other side for a person: bytes that are no printable ASCII as `?`, cut after 120.
[[nodiscard]] std::string tcp80_shown(std::string_view line);

/// The four digits in the brackets at the end of an ERROR or NG line, read as hexadecimal (2060 -> 0x2060).
[[nodiscard]] std::optional<std::uint16_t> tcp80_fault_code(std::string_view line);

/// The greeting of a session without limit of commands.
[[nodiscard]] std::string tcp80_connect();
/// True when the answer to the greeting grants more than one command.
[[nodiscard]] bool tcp80_keeps_alive(std::string_view banner);

/// One command: the header line, and the operands to send after its OK (empty when there are none).
struct Tcp80Request {
  std::string command;
  std::string header;    ///< HOSTCTRL_REQUEST <CMD> <size> CRLF; the size counts the operands' CR
  std::string operands;  ///< with its CR
};
[[nodiscard]] Tcp80Request tcp80_request(std::string_view command, std::string_view operands = {});

/// Operands. Numbers are the caller's; positions must be finite, tools within 0-63 and frames within 0-65 where they
/// are written or moved to, speeds above 0 (else std::invalid_argument).
[[nodiscard]] std::string tcp80_read_variable(VariableType type, int number);
[[nodiscard]] std::string tcp80_write_integer(VariableType type, int number, std::int32_t value);
[[nodiscard]] std::string tcp80_write_real(int number, double value);
/// At most 32 bytes, without line ends; others throw std::invalid_argument.
[[nodiscard]] std::string tcp80_write_string(int number, std::string_view value);
[[nodiscard]] std::string tcp80_write_position(int number, const VariablePosition& position);
/// A direct move as command and operands (section 1.5): MOVJ speed %, MOVL and IMOV speed in mm/s; no external axes.
struct Tcp80Move {
  std::string command, operands;
};
[[nodiscard]] Tcp80Move tcp80_move(const DirectMove& move);
/// PMOVJ: speed %, twelve pulse values, tool. A line (PMOVL) has no layout that anybody has published: throws
/// std::invalid_argument.
[[nodiscard]] Tcp80Move tcp80_move(const PulseMove& move);
/// The fields of a position as they stand in LOADV and SAVEV.
[[nodiscard]] std::string tcp80_position_fields(const VariablePosition& position);

/// Form over TCP: bit 0 no-flip, 1 elbow below, 2 back, 3 R, 4 T, 5 S >= 180 (HSES swaps 0 and 2).
[[nodiscard]] int tcp80_form(const Form& form);
[[nodiscard]] Form tcp80_form(int bits);

/// Comma-separated fields, blanks around them cut off.
[[nodiscard]] std::vector<std::string_view> tcp80_fields(std::string_view line);

[[nodiscard]] core::Result<RobotState> parse_rstats(std::string_view line);
/// `frame`: the one asked for; the answer does not repeat it.
[[nodiscard]] core::Result<CartesianPosition> parse_rposc(std::string_view line, int frame);
/// Pulses of S L U R B T (and E), then external axes: 12 or 13 values.
[[nodiscard]] core::Result<std::vector<std::int32_t>> parse_rposj(std::string_view line);
/// Error first, then alarms; entries with code 0 are left out, so a healthy controller gives none.
[[nodiscard]] core::Result<std::vector<Alarm>> parse_ralarm(std::string_view line);

[[nodiscard]] core::Result<CurrentJob> parse_rjseq(std::string_view line);

/// Job names of RJDIR; the separator is not certain, so commas and blanks count.
[[nodiscard]] std::vector<std::string> parse_rjdir(std::string_view line);

/// B 0..255, I and D in their ranges.
[[nodiscard]] core::Result<std::int32_t> parse_integer_variable(std::string_view line, VariableType type);
[[nodiscard]] core::Result<double> parse_real_variable(std::string_view line);
/// P `number`; a leading `4,number` is tolerated (section 1.6 is not sure about it).
[[nodiscard]] core::Result<VariablePosition> parse_position_variable(std::string_view line, int number);
/// IOREAD: exactly `groups` values of 0..255.
[[nodiscard]] core::Result<std::vector<std::uint8_t>> parse_ioread(std::string_view line, std::size_t groups);

}  // namespace pickcell::robot
