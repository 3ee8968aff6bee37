#pragma once
/// The simulated Yaskawa controller: one state, lived through time on the cell's clock, behind its doors on real
/// sockets.

#include <atomic>
#include <functional>
#include <memory>
#include <mutex>
#include <string_view>
#include <thread>
#include <vector>

#include "pickcell/core/clock.hpp"
#include "pickcell/core/result.hpp"
#include "pickcell/sim/controller_state.hpp"
#include "pickcell/sim/fault_plan.hpp"
#include "pickcell/sim/hses_files.hpp"
#include "pickcell/sim/hses_server.hpp"
#include "pickcell/sim/motoros_door.hpp"
#include "pickcell/sim/plant.hpp"
#include "pickcell/sim/tcp80_server.hpp"

namespace pickcell::sim {

/// All methods are thread-safe and may be called at any time, also while a simulated clock stands still. The plant is
/// never called with the state's lock held.
class Controller {
 public:
  /// Takes the seat "controller" on the clock at once, so that it lives in the clock's time from the first event on,
  /// and opens the doors. `plant` may be null (inputs off, outputs to nowhere); clock and plant must outlive the
  /// controller. Errors: link (port taken). Throws std::invalid_argument for settings that cannot be (see
  /// ControllerState).
  [[nodiscard]] static core::Result<std::unique_ptr<Controller>> switch_on(const ControllerSettings& settings,
                                                                           core::Clock& clock, Plant* plant);
  ~Controller();
  Controller(const Controller&) = delete;
  Controller& operator=(const Controller&) = delete;

  [[nodiscard]] int tcp80_port() const { return tcp80_.port(); }
  /// Of robot control over UDP; files are on the next one.
  [[nodiscard]] int hses_port() const { return hses_.port(); }
  /// Of MotoROS' motion; 0 without MotoROS.
  [[nodiscard]] int motoros_port() const { return motoros_ ? motoros_->port() : 0; }
  /// Where the mounted tool is now.
  [[nodiscard]] ToolPose T_base_tool() const;
  [[nodiscard]] FlangePose T_base_flange() const;

  /// Looks at or changes the state under its lock: keys and buttons at the pendant, alarms, prepared variables.
  void with_state(const std::function<void(ControllerState&)>& action);
  [[nodiscard]] ControllerState copy_of_state() const;

  /// Faults of a scenario; replaces the plan so far. Times count from now.
  void follow(std::vector<FaultEvent> scenario);
  /// At once (mid_move: with the arm's next motion).
  void inject(const FaultEvent& event);

  /// The controller loses power: connections are reset, the port is closed, the arm stops, the job is lost; variables
  /// survive. Not from inside with_state.
  void kill();
  /// Power is back: servo off, no alarm, the same port. Errors: link.
  [[nodiscard]] core::Status revive();

 private:
  Controller(const ControllerSettings& settings, core::Clock& clock, Plant* plant);
  void live();
  void tick();
  Tcp80Answer execute(std::string_view command, std::string_view operands);
  HsesServer::Executed execute(const robot::HsesRequest& request);
  [[nodiscard]] core::Status open_doors();
  /// For a door that looks at the state itself: an action under the lock, inputs scanned, the plant told.
  void with_scanned_state(const std::function<void(ControllerState&)>& action);
  void apply(ControllerState& state, const FaultEvent& event, std::string_view command);
  /// Notes the busy answers that a scenario orders, and uses one up. Under the lock.
  [[nodiscard]] bool busy(const std::vector<FaultEvent>& events);
  /// What the state has noted for the plant, delivered without the lock.
  struct ForPlant {
    std::vector<OutputEvent> outputs;
    std::vector<ContactEvent> contacts;
    ToolPose T_base_tool;
  };
  static ForPlant take_events(ControllerState& state);
  void deliver(const ForPlant& events);
  [[nodiscard]] GeneralContacts scan_inputs() const;

  core::Clock& clock_;
  Plant* plant_;
  double tick_s_;
  int wired_inputs_;
  mutable std::mutex mutex_;
  ControllerState state_;  ///< guarded by mutex_
  FaultPlan plan_{{}};     ///< guarded by mutex_
  core::TimePoint plan_start_{};
  int busy_left_ = 0;  ///< requests over HSES that are refused; guarded by mutex_
  std::unique_ptr<core::Seat> seat_;
  std::atomic<bool> stopping_ = false;
  HsesFiles files_;  ///< guarded by mutex_
  AnswerFaults answer_faults_;
  Tcp80Server tcp80_;
  HsesServer hses_;
  std::unique_ptr<MotoRosDoor> motoros_;
  std::jthread life_;
};

}  // namespace pickcell::sim
