#pragma once
/// Names of ArUco dictionaries as OpenCV numbers them.

#include <optional>
#include <string_view>

namespace pickcell::poses {

/// "6X6_250" -> 10; nothing for a name that is none.
[[nodiscard]] std::optional<int> aruco_dictionary(std::string_view name);

}  // namespace pickcell::poses
