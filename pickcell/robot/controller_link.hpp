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
enum class VariableType { byte = 0, integer = 1, double_integer = 2, real = 3, position = 4, string = 7 };

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

/// A move to axis positions: the joints as they are, whatever the form.
struct PulseMove {
  bool line = false;  ///< straight, else joint
  double speed = 0;   ///< % of the greatest, on a line mm/s
  PulsePosition target;
};

enum class Cycle { step = 1, one_cycle = 2, continuous = 3 };

/// Which list of past alarms.
enum class AlarmHistory { major, monitor, user_system, user_user, off_line };

/// One thread at a time. Each call has one deadline in wall time. Errors: link, timeout, refused with the controller's
/// number and its meaning, usage for what the protocol cannot do. Reads, writes of variables and contacts may be
/// repeated by the client when an answer is lost, as far as repeating is harmless in its protocol; nothing that
/// starts, moves or switches ever is: after link or timeout it is not known whether it was done.
///
/// What a protocol does not have, its client does not override: usage.
class ControllerLink {
 public:
  virtual ~ControllerLink() = default;

  [[nodiscard]] virtual core::Status connect() = 0;
  [[nodiscard]] virtual bool connected() const = 0;
  virtual void disconnect() = 0;
  /// host:port
  [[nodiscard]] virtual std::string peer() const = 0;
  /// The protocol, as a person calls it.
  [[nodiscard]] virtual std::string protocol() const = 0;
  /// What the controller says about itself; "" when the protocol has nothing.
  [[nodiscard]] virtual core::Result<std::string> identity() = 0;

  [[nodiscard]] virtual core::Result<RobotState> read_status() = 0;
  [[nodiscard]] virtual core::Result<std::vector<Alarm>> read_alarms() = 0;
  /// The newest first, `most` (1-100) at most.
  [[nodiscard]] virtual core::Result<std::vector<Alarm>> read_past_alarms(AlarmHistory which, int most);
  /// Of the chosen tool, in a frame as in RPOSC: 0 base, 1 robot, 2.. user 1... HSES knows the base frame only.
  [[nodiscard]] virtual core::Result<CartesianPosition> read_position(int frame) = 0;
  /// S L U R B T, then whatever axes follow.
  [[nodiscard]] virtual core::Result<std::vector<std::int32_t>> read_pulses();
  [[nodiscard]] virtual core::Result<CurrentJob> read_job();

  /// B, I or D.
  [[nodiscard]] virtual core::Result<std::int32_t> read_integer(VariableType type, int number);
  [[nodiscard]] virtual core::Result<double> read_real(int number);
  [[nodiscard]] virtual core::Result<std::string> read_string(int number);
  [[nodiscard]] virtual core::Result<VariablePosition> read_position_variable(int number);
  [[nodiscard]] virtual core::Status write_integer(VariableType type, int number, std::int32_t value);
  [[nodiscard]] virtual core::Status write_real(int number, double value);
  /// At most 32 bytes (16 on older controllers); more throw std::invalid_argument.
  [[nodiscard]] virtual core::Status write_string(int number, const std::string& value);
  [[nodiscard]] virtual core::Status write_position_variable(int number, const VariablePosition& position);
  /// M registers.
  [[nodiscard]] virtual core::Result<std::uint16_t> read_register(int number);
  [[nodiscard]] virtual core::Status write_register(int number, std::uint16_t value);

  /// Contacts come in groups of eight: `first` ends in 0; bit n of a byte is contact first + n (of the next ten: +10).
  [[nodiscard]] virtual core::Result<std::vector<std::uint8_t>> read_contacts(int first, int groups) = 0;
  /// Network inputs only, see section 1.6.
  [[nodiscard]] virtual core::Status write_contacts(int first, const std::vector<std::uint8_t>& groups) = 0;

  /// off: where the protocol has a hold to take back, else usage.
  [[nodiscard]] virtual core::Status hold(bool on) = 0;
  [[nodiscard]] virtual core::Status reset_alarm() = 0;
  [[nodiscard]] virtual core::Status cancel_error() = 0;
  [[nodiscard]] virtual core::Status servo(bool on) = 0;
  [[nodiscard]] virtual core::Status set_cycle(Cycle cycle);
  /// Shows text on the pendant. At most 30 bytes; more throw std::invalid_argument.
  [[nodiscard]] virtual core::Status show_message(const std::string& text);
  /// Makes the job current without starting it.
  [[nodiscard]] virtual core::Status select_job(const std::string& job, int line);
  [[nodiscard]] virtual core::Status set_master_job(const std::string& job);
  /// Makes the job current and starts it at its first line.
  [[nodiscard]] virtual core::Status start_job(const std::string& job);
  [[nodiscard]] virtual core::Status move(const DirectMove& move) = 0;
  [[nodiscard]] virtual core::Status move_pulses(const PulseMove& move);

  [[nodiscard]] virtual core::Result<std::vector<std::string>> list_jobs();
  /// The text of a job, CR LF included.
  [[nodiscard]] virtual core::Result<std::string> read_job_text(const std::string& job);
  [[nodiscard]] virtual core::Status write_job_text(const std::string& job, const std::string& text);
  [[nodiscard]] virtual core::Status delete_job(const std::string& job);

 protected:
  /// usage: "<protocol> has no <what>".
  [[nodiscard]] core::Error lacks(const std::string& what) const;
  /// What to use instead.
  [[nodiscard]] virtual std::string instead() const = 0;
};

}  // namespace pickcell::robot
