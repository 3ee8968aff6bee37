#pragma once
/// The modes of `pickcell calibrate`: each declares its options on an app of its own and gives what does the work.

#include "pickcell/cli/subcommand.hpp"

namespace pickcell::cli {

[[nodiscard]] Runner add_calibrate_camera(CLI::App& app);
[[nodiscard]] Runner add_calibrate_plane(CLI::App& app);
[[nodiscard]] Runner add_calibrate_handeye(CLI::App& app);
[[nodiscard]] Runner add_calibrate_verify(CLI::App& app);

}  // namespace pickcell::cli
