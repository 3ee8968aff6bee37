#include "pickcell/sim/controller_type.hpp"

#include <array>

namespace pickcell::sim {

std::optional<ControllerType> controller_type(std::string_view name) {
  // The banner of an FS100, the user frames of DX100 and FS100 and the system contacts of an NX100 are not confirmed.
  static constexpr std::array<ControllerType, 5> kTypes{
      {{"nx100", "NX", 24, 256, 22010, 23287, 2, 4160, 5200, 8064, 8201, 8220},
       {"dx100", "DX", 24, 256, 25010, 27567, 4, 4160, 5200, 8064, 8201, 8220},
       {"fs100", "DX", 24, 256, 25010, 27567, 4, 4160, 5200, 8064, 8201, 8220},
       {"dx200", "DX", 64, 512, 27010, 29567, 4, 4256, 5512, 8512, 8701, 8720},
       {"yrc1000", "YR", 64, 512, 27010, 29567, 4, 4256, 5512, 8512, 8701, 8720}}};
  for (const ControllerType& type : kTypes)
    if (type.name == name) return type;
  return std::nullopt;
}

}  // namespace pickcell::sim
