#include "pickcell/sim/controller_type.hpp"

#include <array>

namespace pickcell::sim {

std::optional<ControllerType> controller_type(std::string_view name) {
  // The banner of an FS100 and the user frames of DX100 and FS100 are not confirmed.
  static constexpr std::array<ControllerType, 5> kTypes{{{"nx100", "NX", 24, 256, 22010, 23287, 2},
                                                         {"dx100", "DX", 24, 256, 25010, 27567, 4},
                                                         {"fs100", "DX", 24, 256, 25010, 27567, 4},
                                                         {"dx200", "DX", 64, 512, 27010, 29567, 4},
                                                         {"yrc1000", "YR", 64, 512, 27010, 29567, 4}}};
  for (const ControllerType& type : kTypes)
    if (type.name == name) return type;
  return std::nullopt;
}

}  // namespace pickcell::sim
