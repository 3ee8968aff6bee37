#include "pickcell/cli/commissioning_link.hpp"

#include <string_view>
#include <utility>

#include "pickcell/cli/robot_link.hpp"
#include "pickcell/robot/motoros_link.hpp"

namespace pickcell::cli {

core::Result<std::unique_ptr<robot::ControllerLink>> open_commissioning_link(const std::string& link,
                                                                             const std::string& where) {
  constexpr std::string_view kScheme = "motoros://";
  std::string address_part = link, model;
  if (link.starts_with(kScheme)) {
    const std::size_t slash = link.find('/', kScheme.size());
    if (slash != std::string::npos) model = link.substr(slash + 1);
    address_part = link.substr(0, slash);
  }
  auto address = parse_robot_link(address_part, where);
  if (!address) return core::forward(address);
  if (address->protocol != RobotProtocol::motoros) return open_controller_link(*address, where);
  if (!model.empty() && !robot::arm_geometry(model))
    return core::failure(core::ErrorCode::usage, where, "no arm '" + model + "'", "one of gp7, gp8, motomini");
  robot::MotoRosLinkSettings settings;
  settings.client.host = address->host;
  settings.client.port = address->port;
  settings.model = model;
  return std::make_unique<robot::MotoRosLink>(std::move(settings));
}

}  // namespace pickcell::cli
