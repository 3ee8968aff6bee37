#include "pickcell/frames/video_source.hpp"

#include <fcntl.h>
#include <poll.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <utility>

namespace pickcell::frames {

using core::ErrorCode;
using core::failure;
using std::chrono::milliseconds;
using std::chrono::steady_clock;

namespace {

constexpr std::chrono::seconds kFirstPicture{10};

}  // namespace

VideoSource::VideoSource(int fd, const std::string& path, FileSource::Options options, const core::Clock& clock)
    : fd_(fd), path_(path), options_(std::move(options)), clock_(clock), stream_(path), due_(clock.now()) {}

VideoSource::~VideoSource() {
  if (fd_ > STDERR_FILENO) (void)::close(fd_);
}

core::Result<std::unique_ptr<VideoSource>> VideoSource::open(const std::string& path, FileSource::Options options,
                                                             const core::Clock& clock) {
  const int fd = path == "-" ? STDIN_FILENO : ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
  if (fd < 0)
    return failure(ErrorCode::unreadable, path, std::strerror(errno), "name a folder, a list, a video or a pipe");
  std::unique_ptr<VideoSource> out(new VideoSource(fd, path, std::move(options), clock));
  struct stat status{};
  if (out->options_.loop && (::fstat(fd, &status) != 0 || !S_ISREG(status.st_mode)))
    return failure(ErrorCode::usage, path, "is no file that can begin again", "leave loop out");
  auto first = out->read_picture(steady_clock::now() + kFirstPicture);
  if (!first) {
    core::Error error = first.error();
    if (error.code == ErrorCode::negative) {
      error.why = "no picture in it";
      error.remedy = "give Y4M (8 bit), JPEG or PGM/PPM pictures in a row";
    }
    error.code = ErrorCode::unreadable;
    return tl::unexpected(std::move(error));
  }
  out->info_ = {out->options_.camera_id.empty() ? "files:" + path : out->options_.camera_id, first->width(),
                first->height(), false};
  out->first_ = std::move(*first);
  return out;
}

bool VideoSource::wind_back() {
  if (!options_.loop || sequence_ == 0 || ::lseek(fd_, 0, SEEK_SET) != 0) return false;
  stream_ = PictureStream(path_);
  at_end_ = false;
  return true;
}

core::Result<image::Image> VideoSource::read_picture(steady_clock::time_point until) {
  std::array<std::byte, 1 << 16> chunk{};
  for (;;) {
    auto picture = stream_.next();
    if (!picture) {
      core::Error error = picture.error();
      error.code = ErrorCode::device;
      return tl::unexpected(std::move(error));
    }
    if (*picture) return std::move(**picture);
    if (at_end_ && !wind_back())
      return failure(ErrorCode::negative, path_, "all " + std::to_string(sequence_) + " pictures are used");
    const auto left = std::chrono::ceil<milliseconds>(until - steady_clock::now()).count();
    pollfd p{fd_, POLLIN, 0};
    if (::poll(&p, 1, static_cast<int>(std::max<decltype(left)>(left, 0))) <= 0)
      return failure(ErrorCode::timeout, path_, "no picture came within the time");
    const ssize_t n = ::read(fd_, chunk.data(), chunk.size());
    if (n > 0) {
      stream_.feed(std::span(chunk).first(static_cast<std::size_t>(n)));
    } else if (n == 0) {
      at_end_ = true;
      stream_.end();
    } else if (errno != EINTR && errno != EAGAIN) {
      return failure(ErrorCode::device, path_, std::strerror(errno));
    }
  }
}

core::Result<Frame> VideoSource::grab(core::Seat& seat, core::Duration timeout) {
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
  core::Result<image::Image> picture =
      first_ ? core::Result<image::Image>(std::move(*first_)) : read_picture(steady_clock::now() + timeout);
  first_.reset();
  if (!picture) return core::forward(picture);
  ++sequence_;
  if (picture->width() != info_.width_px || picture->height() != info_.height_px)
    return failure(ErrorCode::device, path_,
                   "picture " + std::to_string(sequence_) + " is " + std::to_string(picture->width()) + "x" +
                       std::to_string(picture->height()) + ", the first one " + std::to_string(info_.width_px) + "x" +
                       std::to_string(info_.height_px),
                   "keep pictures of one camera in one stream");
  Frame frame;
  frame.picture = std::make_shared<const image::Image>(std::move(*picture));
  frame.sequence = sequence_;
  frame.exposed = seat.now();
  frame.exposed_unix_us = clock_.unix_us();
  frame.camera_id = info_.camera_id;
  return frame;
}

}  // namespace pickcell::frames
