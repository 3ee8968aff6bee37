#pragma once
/// What differs between the generations of Yaskawa controllers (docs/yaskawa-protocols 1.1, 1.3, 1.6, 2.5).

#include <optional>
#include <string_view>

namespace pickcell::sim {

struct ControllerType {
  std::string_view name;    ///< as on the command line: nx100 ... yrc1000
  std::string_view banner;  ///< NX, DX, YR
  int user_frames;
  int general_groups;       ///< of eight: IN#(1)..IN#(8 n), OT# the same
  int network_input_first;  ///< the contacts a host may write
  int network_input_last;
  int angle_decimals;  ///< in RPOSC and SAVEV
  // last groups of system inputs and outputs and of control status, first and last of pseudo inputs
  int system_input_last, system_output_last, control_last, pseudo_first, pseudo_last;
};

/// Names: nx100, dx100, fs100, dx200, yrc1000.
[[nodiscard]] std::optional<ControllerType> controller_type(std::string_view name);

}  // namespace pickcell::sim
