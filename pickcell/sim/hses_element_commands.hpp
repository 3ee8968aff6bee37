#pragma once
/// Reading and writing of variables, registers and contacts over the High Speed Ethernet Server, one or many.

#include "pickcell/robot/hses_codec.hpp"
#include "pickcell/sim/controller_state.hpp"

namespace pickcell::sim {

/// One variable, register or group of contacts. Real controllers take attribute 1 with get_one/set_one and attribute 0
/// with get_all/set_all; the words of a position can be had one by one.
[[nodiscard]] robot::HsesAnswer hses_element_command(ControllerState& state, const robot::HsesRequest& request);
/// Many in a row, all or nothing; commands that are none of these are refused as unknown.
[[nodiscard]] robot::HsesAnswer hses_plural_command(ControllerState& state, const robot::HsesRequest& request);

}  // namespace pickcell::sim
