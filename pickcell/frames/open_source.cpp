#include "pickcell/frames/open_source.hpp"

#include "pickcell/frames/file_source.hpp"
#include "pickcell/frames/video_source.hpp"
#ifdef PICKCELL_WITH_ARAVIS
#include "pickcell/frames/aravis_device.hpp"
#endif
#ifdef PICKCELL_WITH_V4L2
#include "pickcell/frames/v4l2_device.hpp"
#endif

namespace pickcell::frames {

using core::ErrorCode;
using core::failure;

namespace {

constexpr std::string_view kAravis = "aravis:", kV4l2 = "v4l2:", kFiles = "files:";

/// What follows the kind.
std::string rest(const std::string& source) { return source.substr(source.find(':') + 1); }

[[maybe_unused]] tl::unexpected<core::Error> not_built(const std::string& source, const std::string& option) {
  return failure(ErrorCode::usage, source, "this build has no support for such cameras",
                 "build with -D" + option + "=ON");
}

core::Result<Connect> connector(const std::string& source, [[maybe_unused]] const CameraSettings& settings) {
  if (source.starts_with(kAravis)) {
#ifdef PICKCELL_WITH_ARAVIS
    return Connect([name = rest(source), settings] { return connect_aravis(name, settings); });
#else
    return not_built(source, "PICKCELL_WITH_ARAVIS");
#endif
  }
#ifdef PICKCELL_WITH_V4L2
  return Connect([path = rest(source), settings] { return connect_v4l2(path, settings); });
#else
  return not_built(source, "PICKCELL_WITH_V4L2");
#endif
}

bool any_set(const CameraSettings& s) {
  return s.exposure_us || s.gain || s.fps || !s.pixel_format.empty() || s.roi_px || s.binning || !s.free_running() ||
         s.packet_bytes || s.packet_delay_us || s.socket_kib || !s.chunks.empty() || !s.features.empty();
}

template <class To, class From>
core::Result<std::unique_ptr<To>> up(core::Result<std::unique_ptr<From>> from) {
  if (!from) return core::forward(from);
  return std::unique_ptr<To>(std::move(*from));
}

core::Result<std::unique_ptr<FrameSource>> open_files(const std::string& source, const SourceOptions& options,
                                                      const core::Clock& clock) {
  if (any_set(options.settings))
    return failure(ErrorCode::usage, source, "pictures in files take no camera settings", "leave them out");
  const std::filesystem::path given = rest(source);
  if (given.empty()) return failure(ErrorCode::usage, source, "names no folder or file", "files:FOLDER");
  const FileSource::Options own{options.camera_id, options.fps, options.loop};
  if (given == "-") return up<FrameSource>(VideoSource::open("-", own, clock));
  const std::filesystem::path path = given.is_relative() ? options.base / given : given;
  std::error_code ignored;
  const bool stream = std::filesystem::exists(path, ignored) && !std::filesystem::is_directory(path, ignored) &&
                      path.extension() != ".txt";
  if (stream) return up<FrameSource>(VideoSource::open(path.string(), own, clock));
  return up<FrameSource>(FileSource::open(path, own, clock));
}

}  // namespace

bool is_camera(const std::string& source) { return source.starts_with(kAravis) || source.starts_with(kV4l2); }

core::Status check_source(const std::string& source) {
  if (source.starts_with(kFiles)) return {};
  if (!is_camera(source))
    return failure(ErrorCode::usage, source, "is no source of pictures",
                   "use \"aravis:NAME\", \"v4l2:/dev/videoN\" or \"files:PATH\"");
  auto can = connector(source, {});
  if (!can) return core::forward(can);
  return {};
}

core::Result<std::unique_ptr<FrameSource>> open_source(const std::string& source, const SourceOptions& options,
                                                       const core::Clock& clock) {
  if (auto known = check_source(source); !known) return core::forward(known);
  if (!is_camera(source)) return open_files(source, options, clock);
  auto connect = connector(source, options.settings);
  if (!connect) return core::forward(connect);
  LiveSource::Options live;
  live.camera_id = options.camera_id;
  live.policy = options.policy;
  live.lost_after = options.lost_after;
  live.software_trigger = options.settings.software_triggered();
  live.readout_us = options.settings.readout_us.value_or(0);
  return up<FrameSource>(LiveSource::open(std::move(*connect), std::move(live), clock));
}

}  // namespace pickcell::frames
