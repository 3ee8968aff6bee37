#pragma once
/// The controller's job for one cell: its tool, window and speeds.

#include <string>

#include "pickcell/cell/cell_config.hpp"
#include "pickcell/core/result.hpp"

namespace pickcell::cli {

/// VISPICK for this cell. The speeds are the job's own, so `limits.speed_pct` has its effect here and nowhere else.
/// Errors: usage, for limits that no job can have.
[[nodiscard]] core::Result<std::string> job_for(const cell::CellConfig& config);

/// Leaves the job as STATE_DIR/VISPICK.JBI, for a person to load on a real controller.
[[nodiscard]] core::Status write_job(const cell::CellConfig& config);

}  // namespace pickcell::cli
