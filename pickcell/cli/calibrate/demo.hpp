#pragma once
/// The demonstration cell calibrates itself: from pictures that its own camera takes of a board, and from corners that
/// its arm touches. Built with PICKCELL_WITH_CALIBRATION only.

#include <filesystem>
#include <string>

#include "pickcell/core/result.hpp"
#include "pickcell/sim/camera.hpp"
#include "pickcell/sim/world.hpp"

namespace pickcell::cli {

/// Writes camera.toml and plane.toml into the folder, and board.png: the reference picture for calibrate verify. The
/// truth is used only to render pictures and to say where the arm stood, with the reading noise of a real one. Errors:
/// negative, when a calibration is not usable.
[[nodiscard]] core::Status calibrate_demo(const std::filesystem::path& folder, const sim::CameraSettings& camera,
                                          const sim::WorldSettings& world, const std::string& date);

}  // namespace pickcell::cli
