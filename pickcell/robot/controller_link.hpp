#pragma once
/// A Yaskawa controller as a protocol's client shows it: state, variables, contacts, jobs. What stands above it (picks,
/// `pickcell robot`) is the same for every protocol that can do this: Tcp80Client and HsesClient implement it.

#include <cstdint>
#include <string>
#include <vector>

#include "pickcell/core/result.hpp"
#include "pickcell/robot/position.hpp"
#include "pickcell/robot/robot.hpp"

namespace pickcell::robot {

/// Variables by their type number of TCP port 80 (docs/yaskawa-protocols 1.6).
enum class VariableType { byte = 0, integer = 1, double_integer = 2, real = 3, position = 4 };

struct CurrentJob {
  std::string name;  ///< "" when none is set
  int line = 0;
  int step = 0;
};

/// A move ordered by the PC itself, for commissioning only.
struct DirectMove {
  enum class Kind {
    joint,    ///< speed in % of the greatest
    line,     ///< straight
    line_by,  ///< straight; the target is a difference in its frame's directions
  };
  Kind kind = Kind::joint;
  double speed = 0;
  bool turning = false;  ///< of a straight line: speed is that of the turn in deg/s, otherwise of the way in mm/s
  CartesianPosition target;
};

/// One thread at a time. Each call has one deadline in wall time. Errors: link, timeout, refused with the controller's
/// number and its meaning, usage for what the protocol cannot do. Reads, writes of variables and contacts may be
/// repeated by the client when an answer is lost, as far as repeating is harmless in its protocol; nothing that
/// starts, moves or switches ever is: after link or timeout it is not known whether it was done.
class ControllerLink {
 public:
  virtual ~ControllerLink() = default;

  [[nodiscard]] virtual core::Status connect() = 0;
  [[nodiscard]] virtual bool connected() const = 0;
  virtual void disconnect() = 0;
  /// host:port
  [[nodiscard]] virtual std::string peer() const = 0;
  /// What the controller says about itself; "" when the protocol has nothing.
  [[nodiscard]] virtual core::Result<std::string> identity() = 0;

  [[nodiscard]] virtual core::Result<RobotState> read_status() = 0;
  [[nodiscard]] virtual core::Result<std::vector<Alarm>> read_alarms() = 0;
  /// Of the chosen tool, in a frame as in RPOSC: 0 base, 1 robot, 2.. user 1... HSES knows the base frame only.
  [[nodiscard]] virtual core::Result<CartesianPosition> read_position(int frame) = 0;
  /// S L U R B T, then whatever axes follow.
  [[nodiscard]] virtual core::Result<std::vector<std::int32_t>> read_pulses() = 0;
  [[nodiscard]] virtual core::Result<CurrentJob> read_job() = 0;

  /// B, I or D.
  [[nodiscard]] virtual core::Result<std::int32_t> read_integer(VariableType type, int number) = 0;
  [[nodiscard]] virtual core::Result<double> read_real(int number) = 0;
  [[nodiscard]] virtual core::Result<VariablePosition> read_position_variable(int number) = 0;
  [[nodiscard]] virtual core::Status write_integer(VariableType type, int number, std::int32_t value) = 0;
  [[nodiscard]] virtual core::Status write_real(int number, double value) = 0;
  [[nodiscard]] virtual core::Status write_position_variable(int number, const VariablePosition& position) = 0;

  /// Contacts come in groups of eight: `first` ends in 0; bit n of a byte is contact first + n (of the next ten: +10).
  [[nodiscard]] virtual core::Result<std::vector<std::uint8_t>> read_contacts(int first, int groups) = 0;
  /// Network inputs only, see section 1.6.
  [[nodiscard]] virtual core::Status write_contacts(int first, const std::vector<std::uint8_t>& groups) = 0;

  [[nodiscard]] virtual core::Status hold(bool on) = 0;
  [[nodiscard]] virtual core::Status reset_alarm() = 0;
  [[nodiscard]] virtual core::Status cancel_error() = 0;
  [[nodiscard]] virtual core::Status servo(bool on) = 0;
  /// Makes the job current and starts it at its first line.
  [[nodiscard]] virtual core::Status start_job(const std::string& job) = 0;
  [[nodiscard]] virtual core::Status move(const DirectMove& move) = 0;

  [[nodiscard]] virtual core::Result<std::vector<std::string>> list_jobs() = 0;
  /// The text of a job, CR LF included. TCP 80 cannot.
  [[nodiscard]] virtual core::Result<std::string> read_job_text(const std::string& job) = 0;
  [[nodiscard]] virtual core::Status write_job_text(const std::string& job, const std::string& text) = 0;
  [[nodiscard]] virtual core::Status delete_job(const std::string& job) = 0;
};

}  // namespace pickcell::robot
