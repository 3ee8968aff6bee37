#include "pickcell/frames/file_source.hpp"

#include <algorithm>
#include <cctype>
#include <sstream>
#include <system_error>
#include <utility>

#include "pickcell/core/file.hpp"
#include "pickcell/image/codec.hpp"

namespace pickcell::frames {

using core::ErrorCode;
using core::failure;
namespace fs = std::filesystem;

namespace {

bool is_picture(const fs::path& path) {
  std::string ext = path.extension().string();
  std::transform(ext.begin(), ext.end(), ext.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return ext == ".png" || ext == ".jpg" || ext == ".jpeg" || ext == ".bmp" || ext == ".pgm" || ext == ".ppm";
}

core::Result<std::vector<fs::path>> pictures_in(const fs::path& folder) {
  std::error_code problem;
  std::vector<fs::path> files;
  for (fs::directory_iterator it(folder, problem), end; !problem && it != end; it.increment(problem))
    if (it->is_regular_file() && is_picture(it->path())) files.push_back(it->path());
  if (problem) return failure(ErrorCode::unreadable, folder.string(), problem.message(), "name a folder with pictures");
  if (files.empty())
    return failure(ErrorCode::unreadable, folder.string(), "no picture in this folder",
                   "put PNG, JPEG, BMP, PGM or PPM files there");
  std::sort(files.begin(), files.end());
  return files;
}

core::Result<std::vector<fs::path>> pictures_listed_in(const fs::path& list) {
  auto text = core::read_text_file(list);
  if (!text) return core::forward(text);
  std::vector<fs::path> files;
  std::istringstream lines(*text);
  for (std::string line; std::getline(lines, line);) {
    while (!line.empty() && std::isspace(static_cast<unsigned char>(line.back())) != 0) line.pop_back();
    if (line.empty() || line[0] == '#') continue;
    const fs::path path = line;
    files.push_back(path.is_relative() ? list.parent_path() / path : path);
  }
  if (files.empty()) return failure(ErrorCode::unreadable, list.string(), "names no picture", "write one path a line");
  return files;
}

}  // namespace

FileSource::FileSource(std::vector<fs::path> files, SourceInfo info, Options options, const core::Clock& clock)
    : files_(std::move(files)),
      info_(std::move(info)),
      options_(std::move(options)),
      clock_(clock),
      due_(clock.now()) {}

core::Result<std::unique_ptr<FileSource>> FileSource::open(const fs::path& folder, Options options,
                                                           const core::Clock& clock) {
  auto files = fs::is_regular_file(folder) ? pictures_listed_in(folder) : pictures_in(folder);
  if (!files) return core::forward(files);
  const auto first = image::load_grey(files->front());
  if (!first) return tl::unexpected(first.error());
  SourceInfo info{options.camera_id.empty() ? "files:" + folder.string() : options.camera_id, first->width(),
                  first->height(), false};
  return std::unique_ptr<FileSource>(new FileSource(std::move(*files), std::move(info), std::move(options), clock));
}

core::Result<Frame> FileSource::grab(core::Seat& seat, core::Duration timeout) {
  if (next_ == files_.size()) {
    if (!options_.loop)
      return failure(ErrorCode::negative, info_.camera_id,
                     "all " + std::to_string(files_.size()) + " pictures are used");
    next_ = 0;
  }
  if (options_.fps > 0) {
    if (due_ > seat.now() + timeout) {
      seat.sleep_for(timeout);
      return failure(ErrorCode::timeout, info_.camera_id, "the next picture is not due yet");
    }
    seat.sleep_until(due_);
    // Waking a little late must not add up; what a slow reader missed is not made up for.
    const core::Duration period = core::duration_s(1 / options_.fps);
    due_ = std::max(due_ + period, seat.now());
  }
  const fs::path& file = files_[next_++];
  ++sequence_;
  auto picture = image::load_grey(file);
  if (!picture) {
    core::Error error = picture.error();
    error.code = ErrorCode::device;
    return tl::unexpected(std::move(error));
  }
  if (picture->width() != info_.width_px || picture->height() != info_.height_px)
    return failure(ErrorCode::device, file.string(),
                   "is " + std::to_string(picture->width()) + "x" + std::to_string(picture->height()) +
                       ", the first picture " + std::to_string(info_.width_px) + "x" + std::to_string(info_.height_px),
                   "keep pictures of one camera in one folder");
  Frame frame;
  frame.picture = std::make_shared<const image::Image>(std::move(*picture));
  frame.sequence = sequence_;
  frame.exposed = seat.now();
  frame.exposed_unix_us = clock_.unix_us();
  frame.camera_id = info_.camera_id;
  return frame;
}

}  // namespace pickcell::frames
