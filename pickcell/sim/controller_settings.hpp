#pragma once
/// What a simulated controller is when it is switched on.

#include <optional>
#include <string>
#include <vector>

#include "pickcell/robot/motoros_codec.hpp"
#include "pickcell/sim/arm.hpp"
#include "pickcell/sim/controller_type.hpp"
#include "pickcell/sim/motion.hpp"

namespace pickcell::sim {

/// Starts in play, command remote, one cycle, servo off, no alarm, the arm at `start_deg`.
struct ControllerSettings {
  ArmModel model = ArmModel::gp7;
  std::string type = "yrc1000";  ///< see controller_type()
  std::string banner;            ///< NX, DX, YR; empty: the type's own
  std::string bind = "127.0.0.1";
  int tcp80_port = 0;               ///< 0: any free port
  int hses_port = 0;                ///< UDP, of robot control; files on the next one; 0: any two free ones
  std::optional<int> motoros_port;  ///< of motion; 0: any free three. Empty: no MotoROS
  std::optional<robot::ByteOrder> motoros_order;  ///< empty: the type's own (fs100 big, the others little)
  double segment_pause_s = 0;     ///< wall time between the OK line and the result; real clients want 0.02
  std::vector<std::string> jobs;  ///< texts of jobs to load (see shipped_jobs())
  double tool_length_m = 0.150;   ///< the mounted tool, as tool 1: along the flange's Z
  Joints start_deg = (Joints() << 0, 0, 0, 0, -90, 0).finished();
  double tick_s = 0.010;  ///< interpolation and I/O scan
  int wired_inputs = 16;  ///< IN#(1)..IN#(n) are read from the plant
  MotionLimits limits;
};

}  // namespace pickcell::sim
