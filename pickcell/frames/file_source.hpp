#pragma once
/// "files:DIR": pictures of a folder instead of a camera, in the order of their names, or of a list (.txt), in its
/// order.

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "pickcell/core/clock.hpp"
#include "pickcell/core/result.hpp"
#include "pickcell/frames/frame_source.hpp"

namespace pickcell::frames {

class FileSource final : public FrameSource {
 public:
  struct Options {
    std::string camera_id;  ///< empty: "files:DIR"
    double fps = 0;         ///< pictures per second of the cell's clock; 0: as fast as asked
    bool loop = false;      ///< begin again after the last; otherwise the end is an error of kind negative
  };

  /// A folder: lists the .png .jpg .jpeg .bmp .pgm .ppm files of the folder and reads the first. A
  /// file: one path a line, relative ones start at the list; blank lines and lines that begin with # are passed over.
  /// Errors: unreadable (no folder,
  /// no picture in it, first picture damaged).
  [[nodiscard]] static core::Result<std::unique_ptr<FileSource>> open(const std::filesystem::path& folder,
                                                                      Options options, const core::Clock& clock);

  [[nodiscard]] SourceInfo info() const override { return info_; }
  /// A damaged picture or one of another size than the first is an error of kind device that names the file; the next
  /// call goes on with the next picture. With fps the call sleeps on the seat until the picture is due; timeout when
  /// that is later than the timeout allows.
  [[nodiscard]] core::Result<Frame> grab(core::Seat& seat, core::Duration timeout) override;

 private:
  FileSource(std::vector<std::filesystem::path> files, SourceInfo info, Options options, const core::Clock& clock);

  std::vector<std::filesystem::path> files_;
  SourceInfo info_;
  Options options_;
  const core::Clock& clock_;
  std::size_t next_ = 0;
  std::uint64_t sequence_ = 0;
  core::TimePoint due_{};
};

}  // namespace pickcell::frames
