#pragma once
/// MotoROS on the one controller: its application and its ports, put together.

#include <functional>
#include <string_view>

#include "pickcell/sim/motoros_motion.hpp"
#include "pickcell/sim/motoros_server.hpp"

namespace pickcell::sim {

class MotoRosDoor final : private MotoRosHost {
 public:
  /// Runs an action on the state under its lock.
  using WithState = std::function<void(const std::function<void(ControllerState&)>&)>;
  /// Tells the fault plan of a command, under the state's lock.
  using Commanded = std::function<void(ControllerState&, std::string_view)>;

  /// `faults` must outlive the door.
  MotoRosDoor(MotoRosDoorSettings settings, MotoRosSettings motion, WithState with_state, Commanded commanded,
              AnswerFaults& faults);

  [[nodiscard]] core::Status open() { return server_.open(); }
  void close() { server_.close(); }
  [[nodiscard]] int port() const { return server_.port(); }

  /// With the state's lock held, after the state's own tick.
  void tick(ControllerState& state, double dt_s) { motion_.tick(state, dt_s); }

 private:
  [[nodiscard]] MotoRosAnswer motion(const robot::MotoFrame& message) override;
  [[nodiscard]] robot::MotoFrame io(const robot::MotoFrame& message) override;
  [[nodiscard]] std::optional<robot::MotoFrame> waited() override;
  [[nodiscard]] bool holds_motion() override;
  void motion_host_left() override;
  [[nodiscard]] std::array<robot::MotoFrame, 2> state() override;
  void connected(const std::array<int, 3>& hosts) override;

  WithState with_state_;
  Commanded commanded_;
  MotoRosMotion motion_;  ///< guarded by the state's lock
  MotoRosServer server_;
};

}  // namespace pickcell::sim
