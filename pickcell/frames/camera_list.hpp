#pragma once
/// Every camera that this build can find.

#include <string>
#include <utility>
#include <vector>

#include "pickcell/core/result.hpp"

namespace pickcell::frames {

struct ListedCamera {
  std::string source;  ///< what to give as SOURCE
  std::string protocol, vendor, model, serial, address;
  std::string user_name;  ///< as somebody named it; may be empty
  bool held = false;      ///< another program has it
};

/// Takes about half a second where there are networks to ask.
[[nodiscard]] std::vector<ListedCamera> list_cameras();

/// Name and value of everything that can be set at a camera by name. Errors: as opening it; usage for sources that are
/// none.
[[nodiscard]] core::Result<std::vector<std::pair<std::string, std::string>>> camera_features(const std::string& source);

}  // namespace pickcell::frames
