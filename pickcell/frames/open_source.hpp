#pragma once
/// SOURCE as people write it, in CELL.toml and on the command line: "aravis:NAME", "v4l2:/dev/videoN", "files:PATH".

#include <chrono>
#include <filesystem>
#include <memory>
#include <string>

#include "pickcell/core/clock.hpp"
#include "pickcell/core/result.hpp"
#include "pickcell/frames/camera_settings.hpp"
#include "pickcell/frames/live_source.hpp"

namespace pickcell::frames {

struct SourceOptions {
  std::string camera_id;       ///< empty: what the source says
  double fps = 0;              ///< of "files:": pictures per second; 0: as fast as asked. Of cameras: settings.fps
  bool loop = false;           ///< of "files:"
  std::filesystem::path base;  ///< where relative paths start
  CameraSettings settings;     ///< of cameras
  LiveSource::Policy policy = LiveSource::Policy::newest;
  std::chrono::milliseconds lost_after{600};  ///< of cameras: without a sign of life
};

/// Can this build open such a source? Nothing is opened. Errors: usage.
[[nodiscard]] core::Status check_source(const std::string& source);

/// Is it a camera, rather than files?
[[nodiscard]] bool is_camera(const std::string& source);

/// The clock must outlive the source. Errors: usage (no such kind, not in this build, settings for files), and those of
/// the kind.
[[nodiscard]] core::Result<std::unique_ptr<FrameSource>> open_source(const std::string& source,
                                                                     const SourceOptions& options,
                                                                     const core::Clock& clock);

}  // namespace pickcell::frames
