#pragma once
/// What the simulated controller's I/O is wired to: gripper, grip sensor, feeder. The world implements it; the
/// controller knows contacts only.

#include "pickcell/core/clock.hpp"
#include "pickcell/core/transform.hpp"

namespace pickcell::sim {

/// Wiring of the simulated cell (contact numbers of a YRC1000; OT#(1) = 10010, IN#(1) = 10, network input #27010).
constexpr int kGripperOutput = 1;           ///< OT#(1): on = closed
constexpr int kGripSensorInput = 1;         ///< IN#(1): on = something in the gripper
constexpr int kFeedMovingInput = 2;         ///< IN#(2): on = belt moving (contact 11)
constexpr int kFeedAdvanceContact = 27010;  ///< network input, written by the PC: rising edge = one belt pitch

/// Thread-safe. T_base_tool: where the tool centre point is at that moment.
class Plant {
 public:
  virtual ~Plant() = default;
  /// A general output OT#(n) changed.
  virtual void output_changed(int n, bool on, const core::Transform<core::Base, core::Tool>& T_base_tool,
                              core::TimePoint t) = 0;
  /// State of a general input IN#(n).
  [[nodiscard]] virtual bool input(int n, core::TimePoint t) = 0;
  /// A network-input contact was written by the PC.
  virtual void contact_written(int contact, bool on, core::TimePoint t) = 0;
};

}  // namespace pickcell::sim
