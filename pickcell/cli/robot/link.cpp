#include "pickcell/cli/robot/link.hpp"

#include <array>
#include <charconv>
#include <string_view>

#include "pickcell/robot/hses_client.hpp"
#include "pickcell/robot/motoros_link.hpp"
#include "pickcell/robot/tcp80_client.hpp"

namespace pickcell::cli {

namespace {

struct Scheme {
  std::string_view prefix;
  RobotProtocol protocol;
  int port;
  int ports;  ///< in a row
};
constexpr std::array<Scheme, 3> kSchemes{{{"tcp80://", RobotProtocol::tcp80, 80, 1},
                                          {"hses://", RobotProtocol::hses, 10040, 2},
                                          {"motoros://", RobotProtocol::motoros, 50240, 3}}};

}  // namespace

core::Result<RobotAddress> parse_robot_link(const std::string& link, const std::string& where) {
  const auto bad = [&](std::string why) {
    return core::failure(core::ErrorCode::usage, where, "\"" + link + "\" " + std::move(why),
                         "use tcp80://HOST[:PORT], hses://HOST[:PORT] or motoros://HOST[:PORT][/MODEL]");
  };
  for (const Scheme& scheme : kSchemes) {
    if (!link.starts_with(scheme.prefix)) continue;
    std::string rest = link.substr(scheme.prefix.size());
    std::string model;
    if (const std::size_t slash = rest.find('/'); scheme.protocol == RobotProtocol::motoros && slash != rest.npos) {
      model = rest.substr(slash + 1);
      rest.resize(slash);
      if (!robot::arm_geometry(model)) return bad("names no arm after the /: gp7, gp8 or motomini");
    }
    const std::size_t colon = rest.rfind(':');
    RobotAddress out{scheme.protocol, rest.substr(0, colon), scheme.port, model};
    if (colon != std::string::npos) {
      const char* end = rest.data() + rest.size();
      const auto [used, problem] = std::from_chars(rest.data() + colon + 1, end, out.port);
      if (problem != std::errc() || used != end || out.port < 1 || out.port > 65536 - scheme.ports)
        return bad("has a port that is no port");
    }
    if (out.host.empty()) return bad("names no host");
    return out;
  }
  return bad("is no link to a robot");
}

core::Result<std::unique_ptr<robot::ControllerLink>> open_controller_link(const RobotAddress& address,
                                                                          const std::string& where) {
  switch (address.protocol) {
    case RobotProtocol::tcp80: {
      robot::Tcp80Settings settings;
      settings.host = address.host;
      settings.port = address.port;
      return std::make_unique<robot::Tcp80Client>(std::move(settings));
    }
    case RobotProtocol::hses: {
      robot::HsesSettings settings;
      settings.host = address.host;
      settings.port = address.port;
      return std::make_unique<robot::HsesClient>(std::move(settings));
    }
    case RobotProtocol::motoros: {
      robot::MotoRosLinkSettings settings;
      settings.client.host = address.host;
      settings.client.port = address.port;
      settings.model = address.model;
      return std::make_unique<robot::MotoRosLink>(std::move(settings));
    }
  }
  return core::failure(core::ErrorCode::usage, where, "no such protocol", "use tcp80://, hses:// or motoros://");
}

}  // namespace pickcell::cli
