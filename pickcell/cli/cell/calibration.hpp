#pragma once
/// The calibration that a cell file names, loaded: lens with plane or with hand-eye; and the check of the camera's
/// place before the first pick.

#include <optional>

#include "pickcell/cell/cell.hpp"
#include "pickcell/cell/cell_config.hpp"
#include "pickcell/cell/vision.hpp"
#include "pickcell/core/result.hpp"

namespace pickcell::cli {

/// Errors: unreadable: a file that cannot be read, a hand-eye calibration without a work plane.
[[nodiscard]] core::Result<cell::Vision::Settings> load_calibration(const cell::CalibrationConfig& config);

/// T_flange_tool of `flange_tool_mm_deg`.
[[nodiscard]] core::Transform<core::Flange, core::Tool> flange_tool(const cell::CalibrationConfig& config);

/// The check that [calibration] verify_at_start asks for; empty when it asks for none. Errors: usage: the calibration
/// has no reference board, this build cannot detect boards.
[[nodiscard]] core::Result<cell::CameraCheck> camera_check(const cell::CalibrationConfig& config,
                                                           const cell::Vision::Settings& calibration);

}  // namespace pickcell::cli
