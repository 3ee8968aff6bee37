#pragma once
/// The one state of the simulated controller behind all its doors: arm, variables, contacts, jobs, modes, alarms
/// (docs/yaskawa-protocols section 7, point 1). Not synchronised: whoever shares it holds a lock (controller.hpp).

#include <array>
#include <bitset>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "pickcell/sim/controller_settings.hpp"
#include "pickcell/sim/job_program.hpp"
#include "pickcell/sim/motion.hpp"
#include "pickcell/sim/position.hpp"

namespace pickcell::sim {

struct AlarmEntry {
  int code = 0;
  int data = 0;
  std::string text;
  std::int64_t unix_us = 0;  ///< when it was raised
};

/// A BP or EX variable: there are no such axes here, it is only kept.
struct AxisPosition {
  std::uint32_t type = 0;
  std::array<std::int32_t, 8> axes{};
};

/// Alarm numbers of the simulation. Recalled, not confirmed by a source that was read.
constexpr int kAlarmPulseLimit = 4416;
constexpr int kAlarmExcessiveSpeed = 4414;
constexpr int kAlarmOutOfReach = 4511;
constexpr int kAlarmVariableRange = 4500;
constexpr int kAlarmUndefinedPosition = 4446;
constexpr int kAlarmNoSuchJob = 4452;
/// Alarms below this are major: RESET does not clear them.
constexpr int kFirstMinorAlarm = 4000;

enum class CycleMode { step = 1, one_cycle = 2, continuous = 3 };

/// The master task's place in its job. It stays where it is when the job is stopped, so that START can carry on.
struct Task {
  struct Place {
    std::shared_ptr<const JobProgram> job;
    std::size_t line = 0;
  };
  Place at;
  std::vector<Place> callers;
  bool running = false;
  bool begun = false;  ///< the line at `at` was begun (a move, timer or wait in progress)
  double left_s = 0;   ///< of that timer or wait
  int step = 0;        ///< motion instructions passed in the current job
};

using GeneralContacts = std::bitset<4097>;

/// A general output that changed, for the plant.
struct OutputEvent {
  int n = 0;
  bool on = false;
};

/// A network input that a host wrote, for the plant.
struct ContactEvent {
  int contact = 0;
  bool on = false;
};

struct ControllerState {
  /// Throws std::invalid_argument for an unknown controller type or a damaged job text.
  explicit ControllerState(const ControllerSettings& settings);

  // arm
  const Arm* arm;
  ControllerType type;
  MotionLimits limits;
  Joints q;  ///< where the arm is, rad
  std::array<ToolData, 64> tools;
  std::vector<std::optional<Eigen::Isometry3d>> user_frames;  ///< index 0 = user 1; T_base_user where taught
  ToolData mounted_tool;  ///< what really sits on the flange, whatever tool number is chosen
  int tool = 1;           ///< tool number of the last move

  // variables
  std::array<std::uint8_t, 100> B{};
  std::array<std::int16_t, 100> I{};
  std::array<std::int32_t, 100> D{};
  std::array<float, 100> R{};
  std::array<std::string, 100> S;  ///< at most 32 bytes each; 16 over TCP 80 and in jobs
  std::array<std::optional<Position>, 128> P;
  std::array<AxisPosition, 128> BP{}, EX{};
  std::array<std::uint16_t, 1000> M{};

  // contacts
  GeneralContacts inputs, outputs;             ///< index n: IN#(n), OT#(n); 0 unused
  std::map<int, std::uint8_t> network_inputs;  ///< by group (contact / 10), as written by hosts
  std::vector<OutputEvent> output_events;
  std::vector<ContactEvent> contact_events;

  // jobs
  std::map<std::string, std::shared_ptr<const JobProgram>, std::less<>> jobs;
  std::string master_job;
  Task task;
  std::optional<Move> move;  ///< of the task, or a direct one
  bool direct_move = false;
  bool stopping = false;  ///< a hold, alarm or the like has begun to stop what runs: it does not go on without START

  // modes
  bool play = true, remote = true, servo = false, emergency_stop = false;
  bool hold_pendant = false, hold_external = false, hold_command = false;
  bool pendant_locked = false;
  CycleMode cycle = CycleMode::one_cycle;
  std::vector<AlarmEntry> alarms;         ///< newest first
  std::vector<AlarmEntry> alarm_history;  ///< newest first, also after they are reset
  bool error = false;
  std::string pendant_message;
  std::int64_t unix_us = 0;  ///< the controller's date, set by whoever lets it live
  std::int64_t switched_on_unix_us = 0;

  /// The job is the task's own or one of its callers.
  [[nodiscard]] bool in_use(std::string_view job) const;
  [[nodiscard]] bool held() const { return hold_pendant || hold_external || hold_command; }
  /// A job or a direct move runs, or is still slowing down.
  [[nodiscard]] bool running() const { return task.running || direct_move; }
  /// Something keeps motion from going on.
  [[nodiscard]] bool motion_blocked() const { return held() || !alarms.empty() || !servo || !play; }
  /// RSTATS and HSES 0x72.
  [[nodiscard]] std::array<int, 2> status_bits() const;

  [[nodiscard]] FlangePose T_base_flange() const { return forward(*arm, q); }
  /// Of the mounted tool.
  [[nodiscard]] ToolPose T_base_tool() const { return T_base_flange() * mounted_tool; }
  /// T_base_frame for the frame numbers of RPOSC and P data; empty when there is no such frame or it is not taught.
  [[nodiscard]] std::optional<Eigen::Isometry3d> frame(int number) const;
  [[nodiscard]] bool frame_exists(int number) const;

  /// Takes a job in; its P variables are loaded. An existing one of that name is replaced; the task, when it stands in
  /// the old one, is then at its first line.
  void load_job(JobProgram job);

  // what people and machines do to a controller
  void raise_alarm(AlarmEntry alarm);
  void press_emergency_stop();
  void release_emergency_stop() { emergency_stop = false; }
  /// The key: teach takes the controller out of remote and cuts the servo.
  void turn_key_to_teach();
  void turn_key_to_remote();
  /// Clears every alarm, major ones too.
  void reset_at_pendant();
  /// The arm stops where it is; job, alarms, holds and outputs are lost, variables and the modes chosen by keys stay.
  void lose_power();
};

}  // namespace pickcell::sim
