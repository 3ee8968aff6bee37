#pragma once
/// The I/O messages of MotoROS on the controller's contacts and M registers (docs/yaskawa-protocols 3.1).

#include "pickcell/robot/motoros_codec.hpp"
#include "pickcell/sim/controller_state.hpp"

namespace pickcell::sim {

/// Readable: every contact there is (last digit 0 to 7) and M 0-999. Writable: general outputs, network inputs, M
/// 0-559. A message of another type is answered with IOCTRL_REPLY. Never closes the connection.
[[nodiscard]] robot::MotoFrame execute_motoros_io(ControllerState& state, const robot::MotoFrame& message);
/// True for the types of this port; the motion port takes those of bits and groups too.
[[nodiscard]] bool is_motoros_io(const robot::MotoFrame& message);

}  // namespace pickcell::sim
