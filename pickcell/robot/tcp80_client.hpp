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
#include "pickcell/robot/controller_link.hpp"
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
class Tcp80Client final : public ControllerLink {
 public:
  explicit Tcp80Client(Tcp80Settings settings);

  /// Opens a session; closes an open one first.
  [[nodiscard]] core::Status connect() override;
  [[nodiscard]] bool connected() const override { return open_; }
  void disconnect() override;
  /// The controller's greeting, "" before the first.
  [[nodiscard]] const std::string& banner() const { return banner_; }
  /// host:port
  [[nodiscard]] std::string peer() const override;

  [[nodiscard]] core::Result<RobotState> read_status() override;
  [[nodiscard]] core::Result<std::vector<Alarm>> read_alarms() override;
  [[nodiscard]] core::Result<CartesianPosition> read_position(int frame) override;
  [[nodiscard]] core::Result<std::vector<std::int32_t>> read_pulses() override;
  [[nodiscard]] core::Result<CurrentJob> read_job() override;

  /// B, I or D.
  [[nodiscard]] core::Result<std::int32_t> read_integer(VariableType type, int number) override;
  [[nodiscard]] core::Result<double> read_real(int number) override;
  [[nodiscard]] core::Result<VariablePosition> read_position_variable(int number) override;
  [[nodiscard]] core::Status write_integer(VariableType type, int number, std::int32_t value) override;
  [[nodiscard]] core::Status write_real(int number, double value) override;
  [[nodiscard]] core::Status write_position_variable(int number, const VariablePosition& position) override;

  /// Contacts come in groups of eight: `first` ends in 0; bit n of a byte is contact first + n (of the next ten: +10).
  [[nodiscard]] core::Result<std::vector<std::uint8_t>> read_contacts(int first, int groups) override;
  /// Network inputs only, see section 1.6.
  [[nodiscard]] core::Status write_contacts(int first, const std::vector<std::uint8_t>& groups) override;

  [[nodiscard]] core::Status hold(bool on) override;
  [[nodiscard]] core::Status reset_alarm() override;
  [[nodiscard]] core::Status cancel_error() override;
  [[nodiscard]] core::Status servo(bool on) override;
  [[nodiscard]] core::Status start_job(const std::string& job) override;
  [[nodiscard]] core::Status move(const DirectMove& move) override;
  /// The greeting.
  [[nodiscard]] core::Result<std::string> identity() override { return banner_; }
  [[nodiscard]] core::Result<std::vector<std::string>> list_jobs() override;
  /// This protocol carries no files: usage.
  [[nodiscard]] core::Result<std::string> read_job_text(const std::string& job) override;
  [[nodiscard]] core::Status write_job_text(const std::string& job, const std::string& text) override;
  [[nodiscard]] core::Status delete_job(const std::string& job) override;

  // what other protocols do otherwise
  /// true: play, false: teach. Needs external mode switching permitted.
  [[nodiscard]] core::Status set_mode(bool play);
  /// 1 step, 2 one cycle, 3 continuous.
  [[nodiscard]] core::Status set_cycle(int mode);
  /// Locks pendant and I/O operation, emergency stop excepted.
  [[nodiscard]] core::Status lock_pendant(bool on);
  /// At most 30 bytes; more throw std::invalid_argument.
  [[nodiscard]] core::Status show_message(const std::string& text);
  /// Selects without starting; line 0..9999.
  [[nodiscard]] core::Status select_job(const std::string& job, int line);
  [[nodiscard]] core::Status set_master_job(const std::string& job);

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
