#pragma once
/// A session with a Yaskawa Ethernet Server: one command at a time, each within one deadline.
/// Source: docs/yaskawa-protocols.md section 1.

#include <chrono>
#include <cstdint>
#include <deque>
#include <optional>
#include <string>
#include <vector>

#include "pickcell/core/result.hpp"
#include "pickcell/robot/byte_link.hpp"
#include "pickcell/robot/tcp80_codec.hpp"

namespace pickcell::robot {

struct Tcp80Settings {
  std::string host;
  int port = 80;
  std::chrono::milliseconds connect_timeout{2000};
  std::chrono::milliseconds line_timeout{1000};    ///< greeting, and the OK line of a command
  std::chrono::milliseconds result_timeout{5000};  ///< from the OK line to the result
};

/// One thread at a time. Errors: link, timeout (the session is closed: a late answer must not be taken for the next
/// one's), refused with the controller's number and its meaning. Every error carries the last lines exchanged.
///
/// Reads are repeated once on a new session when the session breaks: controllers close idle ones. Nothing that writes,
/// starts or moves is ever repeated: whether it was done is for the caller to find out.
class Tcp80Client {
 public:
  explicit Tcp80Client(Tcp80Settings settings);

  /// Opens a session; closes an open one first.
  [[nodiscard]] core::Status connect();
  [[nodiscard]] bool connected() const { return open_; }
  void disconnect();
  /// The controller's greeting, "" before the first.
  [[nodiscard]] const std::string& banner() const { return banner_; }
  /// host:port
  [[nodiscard]] std::string peer() const;

  [[nodiscard]] core::Result<RobotState> read_status();
  [[nodiscard]] core::Result<std::vector<Alarm>> read_alarms();
  [[nodiscard]] core::Result<CartesianPosition> read_position(int frame);
  [[nodiscard]] core::Result<std::vector<std::int32_t>> read_pulses();
  [[nodiscard]] core::Result<CurrentJob> read_job();

  /// B, I or D.
  [[nodiscard]] core::Result<std::int32_t> read_integer(VariableType type, int number);
  [[nodiscard]] core::Result<double> read_real(int number);
  [[nodiscard]] core::Result<VariablePosition> read_position_variable(int number);
  [[nodiscard]] core::Status write_integer(VariableType type, int number, std::int32_t value);
  [[nodiscard]] core::Status write_real(int number, double value);
  [[nodiscard]] core::Status write_position_variable(int number, const VariablePosition& position);

  /// Contacts come in groups of eight: `first` ends in 0; bit n of a byte is contact first + n (of the next ten: +10).
  [[nodiscard]] core::Result<std::vector<std::uint8_t>> read_contacts(int first, int groups);
  /// Network inputs only, see section 1.6.
  [[nodiscard]] core::Status write_contacts(int first, const std::vector<std::uint8_t>& groups);

  [[nodiscard]] core::Status hold(bool on);
  [[nodiscard]] core::Status reset_alarm();
  [[nodiscard]] core::Status cancel_error();
  [[nodiscard]] core::Status servo(bool on);
  /// Makes the job current and starts it at its first line.
  [[nodiscard]] core::Status start_job(const std::string& job);

 private:
  enum class Kind { read, control };
  /// The data line of a read, or "0000".
  [[nodiscard]] core::Result<std::string> run(const std::string& command, const std::string& operands, Kind kind);
  /// A read whose answer the parser understands.
  template <class Parse>
  auto read(const std::string& command, const std::string& operands, Parse parse)
      -> decltype(parse(std::string_view{}));
  [[nodiscard]] core::Result<std::string> run_once(const Tcp80Request& request, Kind kind);
  [[nodiscard]] core::Status open_session();
  [[nodiscard]] core::Status send(const std::string& bytes, WallDeadline deadline);
  [[nodiscard]] core::Result<std::string> line(WallDeadline deadline);
  [[nodiscard]] core::Status control(const std::string& command, const std::string& operands);
  void remember(char direction, std::string_view text);
  core::Error with_trail(core::Error error) const;
  core::Error refusal(const std::string& command, const std::string& answer) const;

  Tcp80Settings settings_;
  std::optional<ByteLink> link_;
  Tcp80LineSplitter splitter_;
  std::string banner_;
  bool open_ = false;  ///< a session is open, or one command at a time is what the controller grants
  bool keep_alive_ = false;
  std::deque<std::string> trail_;
};

}  // namespace pickcell::robot
