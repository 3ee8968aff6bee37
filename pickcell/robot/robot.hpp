#pragma once
/// The arm as the cell sees it, whatever protocol carries it. Picks go through a taught job on the controller
/// (docs/yaskawa-protocols 4.1): the PC never owns the path.

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "pickcell/core/clock.hpp"
#include "pickcell/core/result.hpp"
#include "pickcell/core/transform.hpp"
#include "pickcell/picks/pick.hpp"

namespace pickcell::robot {

/// RSTATS / HSES 0x72 in words, plus the job's flags.
struct RobotState {
  bool running = false, teach = false, play = false, remote = false;
  bool hold_pendant = false, hold_external = false, hold_command = false;
  bool alarm = false, error = false, servo = false;
  bool step = false, one_cycle = false, continuous = false, speed_limited = false;
  bool clear_of_camera = false;  ///< B012
  [[nodiscard]] bool held() const { return hold_pendant || hold_external || hold_command; }
};

struct Alarm {
  int code = 0;
  int data = 0;
  std::string text;
  std::string time{};  ///< YYYY/MM/DD hh:mm by the controller's clock; "" where the protocol does not tell
};

/// What became of a submitted pick. unknown: nobody can say whether the part was moved; never retried by itself.
enum class OutcomeKind { done, refused, not_started, unknown };

struct Outcome {
  OutcomeKind kind = OutcomeKind::unknown;
  std::int32_t sequence = 0;
  int reason = 0;  ///< B011 when refused: 1 window, 2 nothing gripped, 3 lost on the way, 4 gripper not empty, 8 stale
  std::string text;
};

/// All calls: one deadline per request in wall time; one thread at a time; errors: link, timeout, refused (with the
/// controller's number and its meaning), safety. A failed call never causes motion. Calls that must wait until the
/// controller's job has reached its waiting loop take the caller's seat and sleep on it between their polls.
class Robot {
 public:
  virtual ~Robot() = default;
  /// Connects or reconnects, reads back the controller's variables and raises the fence. While the job runs it waits
  /// for the acknowledgement and settles what the journal left open; when the job stands, start() does that. Refused
  /// (and still connected) while a person must look first, see confirm().
  [[nodiscard]] virtual core::Status connect(core::Seat& seat) = 0;
  [[nodiscard]] virtual bool connected() const = 0;
  [[nodiscard]] virtual core::Result<RobotState> state() = 0;
  [[nodiscard]] virtual core::Result<std::vector<Alarm>> alarms() = 0;
  /// Of the tool that picks are made with; refused while another one is selected at the controller.
  [[nodiscard]] virtual core::Result<core::Transform<core::Base, core::Tool>> pose() = 0;
  /// Servo on, job started, fence acknowledged, open picks settled. Refused in words when the controller is not in
  /// remote play, in alarm or held, or when a person must look first.
  [[nodiscard]] virtual core::Status start(core::Seat& seat) = 0;
  /// A person has looked at the arm and its gripper (which opens) and says: go on. Accepts what connect() and start()
  /// refuse for that reason: an outcome nobody knows (recorded as unknown), something in the gripper, a missing
  /// journal. Nothing happens when nothing waits for it.
  [[nodiscard]] virtual core::Status confirm(core::Seat& seat) = 0;
  /// What was settled since the last call: picks whose outcome connect(), start() or confirm() found out, oldest first.
  [[nodiscard]] virtual std::vector<Outcome> take_settled() = 0;
  /// Checks the pick against the safety limits, journals the intent, hands it over. Returns its sequence number.
  [[nodiscard]] virtual core::Result<std::int32_t> submit(const picks::Pick& pick) = 0;
  /// The outcome of the submitted pick, or nothing while it runs.
  [[nodiscard]] virtual core::Result<std::optional<Outcome>> outcome() = 0;
  /// on: makes a new connection where there is none (connect() is still due afterwards).
  [[nodiscard]] virtual core::Status hold(bool on) = 0;
  /// Clears alarm and error; never moves.
  [[nodiscard]] virtual core::Status reset() = 0;
  /// Network input (writable contact) and input reading, for feeders: contact numbers as on the controller (27010, 10).
  [[nodiscard]] virtual core::Status write_contact(int contact, bool on) = 0;
  [[nodiscard]] virtual core::Result<bool> read_contact(int contact) = 0;
  virtual void disconnect() = 0;
};

}  // namespace pickcell::robot
