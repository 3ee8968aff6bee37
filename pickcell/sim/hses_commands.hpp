#pragma once
/// The commands of the High Speed Ethernet Server (docs/yaskawa-protocols 2.2-2.5) on a controller state: request in,
/// answer out. No sockets. The bytes are those of robot/hses_frame_codec; the state is the one behind every door.

#include <string>

#include "pickcell/robot/hses_codec.hpp"
#include "pickcell/sim/controller_state.hpp"

namespace pickcell::sim {

/// Carries out one request of the robot division. Refusals have status 0x1F and one word of added status: A000 command,
/// A001 instance, A002 attribute or service, 1011/1012/1013 data, then as over TCP 80 in the order of section 7.
[[nodiscard]] robot::HsesAnswer execute_hses(ControllerState& state, const robot::HsesRequest& request);

/// The command of TCP port 80 that does the same ("START", "LOADV", ...), for scenarios; the number ("0x89") when there
/// is none.
[[nodiscard]] std::string hses_command_name(const robot::HsesRequest& request);

/// Whether the request asks for data, or brings some.
[[nodiscard]] inline bool reads(const robot::HsesRequest& r) {
  return r.service == robot::HsesService::get_all || r.service == robot::HsesService::get_one;
}
[[nodiscard]] inline bool writes(const robot::HsesRequest& r) {
  return r.service == robot::HsesService::set_all || r.service == robot::HsesService::set_one;
}

/// A refusal: status 0x1F with this added status.
[[nodiscard]] robot::HsesAnswer hses_refusal(const robot::HsesRequest& request, std::uint16_t added_status);
/// Done, with data.
[[nodiscard]] robot::HsesAnswer hses_done(const robot::HsesRequest& request, robot::HsesBytes payload = {});
/// Done when nothing is refused (0), else the refusal.
[[nodiscard]] inline robot::HsesAnswer settle(const robot::HsesRequest& request, std::uint16_t refused) {
  return refused == 0 ? hses_done(request) : hses_refusal(request, refused);
}

}  // namespace pickcell::sim
