#pragma once
/// How long a picture takes from the camera to the matcher.

#include "pickcell/cli/experiment/experiment.hpp"
#include "pickcell/core/json.hpp"

namespace pickcell::cli {

/// From the end of exposure, by the camera's own stamp, until the cell's vision sets the matcher to work, pyramid
/// built: over real GigE Vision on loopback, 1280x1024 Mono8, software trigger; options.n frames (300). Camera and cell
/// share one clock, so that nothing is estimated. Writes latency_camera.csv; gives
/// {"frames","median_ms","p99_ms","worst_ms", "in_hand_median_ms" (until the cell has the picture),"lost"}. Errors:
/// usage where the build has no GigE Vision, device where the port is taken.
[[nodiscard]] core::Result<core::Json> measure_camera_latency(const ExperimentOptions& options);

}  // namespace pickcell::cli
