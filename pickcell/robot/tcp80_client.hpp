#pragma once
/// A session with a Yaskawa Ethernet Server: one command at a time, each within one deadline.
/// Source: docs/yaskawa-protocols.md section 1.

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "pickcell/core/result.hpp"
#include "pickcell/robot/byte_link.hpp"
#include "pickcell/robot/controller_link.hpp"
#include "pickcell/robot/tcp80_codec.hpp"
#include "pickcell/robot/trail.hpp"

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
  [[nodiscard]] std::string peer() const override;
  [[nodiscard]] std::string protocol() const override { return "TCP port 80"; }
  /// The greeting.
  [[nodiscard]] core::Result<std::string> identity() override { return banner_; }

  [[nodiscard]] core::Result<RobotState> read_status() override;
  [[nodiscard]] core::Result<std::vector<Alarm>> read_alarms() override;
  [[nodiscard]] core::Result<CartesianPosition> read_position(int frame) override;
  [[nodiscard]] core::Result<std::vector<std::int32_t>> read_pulses() override;
  [[nodiscard]] core::Result<CurrentJob> read_job() override;

  [[nodiscard]] core::Result<std::int32_t> read_integer(VariableType type, int number) override;
  [[nodiscard]] core::Result<double> read_real(int number) override;
  [[nodiscard]] core::Result<std::string> read_string(int number) override;
  [[nodiscard]] core::Result<VariablePosition> read_position_variable(int number) override;
  [[nodiscard]] core::Status write_integer(VariableType type, int number, std::int32_t value) override;
  [[nodiscard]] core::Status write_real(int number, double value) override;
  [[nodiscard]] core::Status write_string(int number, const std::string& value) override;
  [[nodiscard]] core::Status write_position_variable(int number, const VariablePosition& position) override;
  [[nodiscard]] core::Result<std::vector<std::uint8_t>> read_contacts(int first, int groups) override;
  [[nodiscard]] core::Status write_contacts(int first, const std::vector<std::uint8_t>& groups) override;

  [[nodiscard]] core::Status hold(bool on) override;
  [[nodiscard]] core::Status reset_alarm() override;
  [[nodiscard]] core::Status cancel_error() override;
  [[nodiscard]] core::Status servo(bool on) override;
  [[nodiscard]] core::Status set_cycle(Cycle cycle) override;
  [[nodiscard]] core::Status show_message(const std::string& text) override;
  [[nodiscard]] core::Status select_job(const std::string& job, int line) override;
  [[nodiscard]] core::Status set_master_job(const std::string& job) override;
  [[nodiscard]] core::Status start_job(const std::string& job) override;
  [[nodiscard]] core::Status move(const DirectMove& move) override;
  /// Joint moves only: usage for a line.
  [[nodiscard]] core::Status move_pulses(const PulseMove& move) override;
  [[nodiscard]] core::Result<std::vector<std::string>> list_jobs() override;
  [[nodiscard]] core::Status delete_job(const std::string& job) override;

  // what other protocols do not have
  /// true: play, false: teach. Needs external mode switching permitted.
  [[nodiscard]] core::Status set_mode(bool play);
  /// Locks pendant and I/O operation, emergency stop excepted.
  [[nodiscard]] core::Status lock_pendant(bool on);
  /// RUFRAME: the data line as it comes; how its fields are laid out nobody has published. User frame 1-64.
  [[nodiscard]] core::Result<std::string> read_user_frame(int number);

 protected:
  [[nodiscard]] std::string instead() const override {
    return "use an hses:// link; files also come from a card or by FTP";
  }

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
  core::Error refusal(const std::string& command, const std::string& answer) const;

  Tcp80Settings settings_;
  std::optional<ByteLink> link_;
  Tcp80LineSplitter splitter_;
  std::string banner_;
  bool open_ = false;  ///< a session is open, or one command at a time is what the controller grants
  bool keep_alive_ = false;
  Trail trail_;
};

}  // namespace pickcell::robot
