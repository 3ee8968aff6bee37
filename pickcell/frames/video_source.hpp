#pragma once
/// "files:VIDEO": a video file, a named pipe or the standard input instead of a camera.

#include <chrono>
#include <memory>
#include <string>

#include "pickcell/core/clock.hpp"
#include "pickcell/core/result.hpp"
#include "pickcell/frames/file_source.hpp"
#include "pickcell/frames/frame_source.hpp"
#include "pickcell/frames/picture_stream.hpp"

namespace pickcell::frames {

class VideoSource final : public FrameSource {
 public:
  /// path: "-" is the standard input. Waits for the first picture, up to ten seconds. loop: of files; a pipe cannot be
  /// wound back (usage). Errors: unreadable (not there, no pictures).
  [[nodiscard]] static core::Result<std::unique_ptr<VideoSource>> open(const std::string& path,
                                                                       FileSource::Options options,
                                                                       const core::Clock& clock);
  ~VideoSource() override;

  [[nodiscard]] SourceInfo info() const override { return info_; }
  /// With fps the call sleeps on the seat until the picture is due. From a pipe pictures come when they come: waits at
  /// most timeout in wall time. The end of the stream is negative; a damaged stream is of kind device, and its end.
  [[nodiscard]] core::Result<Frame> grab(core::Seat& seat, core::Duration timeout) override;

 private:
  VideoSource(int fd, const std::string& path, FileSource::Options options, const core::Clock& clock);
  [[nodiscard]] core::Result<image::Image> read_picture(std::chrono::steady_clock::time_point until);
  [[nodiscard]] bool wind_back();

  int fd_;
  std::string path_;
  FileSource::Options options_;
  const core::Clock& clock_;
  PictureStream stream_;
  SourceInfo info_;
  std::optional<image::Image> first_;
  bool at_end_ = false;
  std::uint64_t sequence_ = 0;
  core::TimePoint due_{};
};

}  // namespace pickcell::frames
