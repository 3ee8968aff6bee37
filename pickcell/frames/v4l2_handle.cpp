#include "pickcell/frames/v4l2_handle.hpp"

#include <fcntl.h>
#include <linux/videodev2.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstring>
#include <utility>

#include "pickcell/core/config.hpp"

namespace pickcell::frames::v4l2 {

using core::ErrorCode;
using core::failure;

namespace {

constexpr int kMostFormats = 64, kMostControls = 256;
constexpr double kExposureUnit_us = 100;

template <class T>
std::span<const std::byte> bytes_of(const T& data) {
  return std::as_bytes(std::span(&data, 1));
}

const Control* find(const std::vector<Control>& all, std::uint32_t id) {
  for (const Control& c : all)
    if (c.id == id && c.usable) return &c;
  return nullptr;
}

}  // namespace

Handle::Handle(int fd, std::string path) : fd_(fd), path_(std::move(path)) {}
Handle::Handle(Handle&& other) noexcept : fd_(std::exchange(other.fd_, -1)), path_(std::move(other.path_)) {}
Handle::~Handle() {
  if (fd_ >= 0) (void)::close(fd_);
}

bool Handle::ask(unsigned long request, void* data) const {
  for (;;) {
    if (::ioctl(fd_, request, data) == 0) return true;
    if (errno != EINTR) return false;
  }
}

core::Error Handle::error(const std::string& doing) const {
  const int why = errno;
  const std::string what = "v4l2:" + path_;
  switch (why) {
    case EBUSY:
      return {
          ErrorCode::device, what, "another program holds the camera", "close it there (`fuser " + path_ + "`)", {}};
    case ENOENT:
    case ENODEV:
    case ENXIO:
      return {ErrorCode::device,
              what,
              "no camera there",
              "check its cable; `pickcell camera list` shows what there is",
              {}};
    case EACCES:
    case EPERM:
      return {ErrorCode::device, what, "no right to open it", "join the group video", {}};
    default:
      return {ErrorCode::device, what, doing + ": " + std::strerror(why), "", {}};
  }
}

core::Result<Handle> Handle::open(const std::string& path) {
  Handle handle(::open(path.c_str(), O_RDWR | O_NONBLOCK | O_CLOEXEC), path);
  if (handle.fd_ < 0) return tl::unexpected(handle.error("open"));
  const auto capability = handle.capability();
  if (!capability || !capability->captures || !capability->streams)
    return failure(ErrorCode::device, "v4l2:" + path, "is no camera",
                   "cameras often have several nodes; `pickcell camera list` shows the right one");
  return handle;
}

std::optional<Capability> Handle::capability() const {
  v4l2_capability data{};
  if (!ask(VIDIOC_QUERYCAP, &data)) return std::nullopt;
  return parse_capability(bytes_of(data));
}

std::vector<FormatName> Handle::formats() const {
  std::vector<FormatName> out;
  for (std::uint32_t i = 0; i < kMostFormats; ++i) {
    v4l2_fmtdesc data{};
    data.index = i;
    data.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
    if (!ask(VIDIOC_ENUM_FMT, &data)) break;
    if (auto format = parse_format_name(bytes_of(data))) out.push_back(std::move(*format));
  }
  return out;
}

std::vector<Control> Handle::controls() const {
  std::vector<Control> out;
  std::uint32_t id = V4L2_CTRL_FLAG_NEXT_CTRL;
  for (int i = 0; i < kMostControls; ++i) {
    v4l2_queryctrl data{};
    data.id = id;
    if (!ask(VIDIOC_QUERYCTRL, &data)) break;
    auto control = parse_control(bytes_of(data));
    if (!control) break;
    id = control->id | V4L2_CTRL_FLAG_NEXT_CTRL;
    if (control->is_number || control->is_boolean || control->is_menu || control->is_button)
      out.push_back(std::move(*control));
  }
  return out;
}

std::optional<std::int64_t> Handle::value(const Control& control) const {
  v4l2_control data{};
  data.id = control.id;
  if (control.is_button || !ask(VIDIOC_G_CTRL, &data)) return std::nullopt;
  return data.value;
}

core::Status Handle::set(const Control& control, std::int64_t value) const {
  if (!control.is_button && (value < control.least || value > control.most))
    return failure(ErrorCode::usage, control.key + "=" + std::to_string(value),
                   path_ + " takes " + std::to_string(control.least) + " to " + std::to_string(control.most));
  v4l2_control data{};
  data.id = control.id;
  data.value = static_cast<__s32>(value);
  if (!ask(VIDIOC_S_CTRL, &data)) return tl::unexpected(error("setting " + control.key));
  return {};
}

core::Status Handle::set_named(const std::vector<Control>& all, const std::string& key,
                               const std::string& value) const {
  std::vector<std::string> keys;
  for (const Control& c : all) {
    keys.push_back(c.key);
    if (c.key != key) continue;
    std::int64_t number = 0;
    const auto [end, problem] = std::from_chars(value.data(), value.data() + value.size(), number);
    if (problem != std::errc() || end != value.data() + value.size())
      return failure(ErrorCode::usage, key + "=" + value, "is no whole number");
    return set(c, number);
  }
  const std::string near = core::nearest(key, keys);
  return failure(ErrorCode::usage, key, "is neither a setting nor a control of " + path_,
                 near.empty() ? "`pickcell camera info SOURCE --features` lists them" : "did you mean '" + near + "'?");
}

core::Status Handle::set_controls(const CameraSettings& s) const {
  const std::vector<Control> all = controls();
  if (s.exposure_us) {
    const Control* exposure = find(all, V4L2_CID_EXPOSURE_ABSOLUTE);
    if (exposure == nullptr)
      return failure(ErrorCode::usage, "exposure_us", path_ + " has no control for it", "leave it out");
    // Automatic exposure would take it back at once.
    if (const Control* automatic = find(all, V4L2_CID_EXPOSURE_AUTO))
      if (auto done = set(*automatic, V4L2_EXPOSURE_MANUAL); !done) return done;
    if (auto done = set(*exposure, std::llround(*s.exposure_us / kExposureUnit_us)); !done) return done;
  }
  if (s.gain) {
    const Control* control = find(all, V4L2_CID_GAIN);
    if (control == nullptr) return failure(ErrorCode::usage, "gain", path_ + " has no control for it", "leave it out");
    if (auto done = set(*control, std::llround(*s.gain)); !done) return done;
  }
  for (const auto& [key, value] : s.features)
    if (auto done = set_named(all, key, value); !done) return done;
  return {};
}

core::Result<std::uint32_t> Handle::choose_format(const std::string& wanted) const {
  std::string list;
  std::optional<std::uint32_t> best;
  for (const FormatName& f : formats()) {
    const std::string name = fourcc_name(f.fourcc);
    list += (list.empty() ? "" : ", ") + name;
    if (!pfnc_of(f.fourcc)) continue;
    if (wanted.empty() ? !best || preference(f.fourcc) < preference(*best) : name == wanted) best = f.fourcc;
  }
  if (best) return *best;
  return failure(ErrorCode::usage, "v4l2:" + path_,
                 wanted.empty() ? "none of its formats is understood: " + list : "does not give " + wanted,
                 wanted.empty() ? "" : "it has " + list);
}

core::Result<Layout> Handle::set_layout(const CameraSettings& s) const {
  auto fourcc = choose_format(s.pixel_format);
  if (!fourcc) return core::forward(fourcc);
  v4l2_format data{};
  data.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  if (!ask(VIDIOC_G_FMT, &data)) return tl::unexpected(error("asking for the format"));
  data.fmt.pix.pixelformat = *fourcc;
  data.fmt.pix.field = V4L2_FIELD_ANY;
  data.fmt.pix.bytesperline = 0;
  if (s.roi_px) {
    if ((*s.roi_px)[0] != 0 || (*s.roi_px)[1] != 0)
      return failure(ErrorCode::usage, "roi_px", path_ + " has no movable region", "give 0,0,w,h");
    data.fmt.pix.width = static_cast<std::uint32_t>((*s.roi_px)[2]);
    data.fmt.pix.height = static_cast<std::uint32_t>((*s.roi_px)[3]);
  }
  if (!ask(VIDIOC_S_FMT, &data)) return tl::unexpected(error("setting the format"));
  const auto layout = parse_layout(bytes_of(data));
  if (!layout || layout->fourcc != *fourcc)
    return failure(ErrorCode::device, "v4l2:" + path_, "agreed to a format and took another");
  if (s.roi_px && (layout->width_px != (*s.roi_px)[2] || layout->height_px != (*s.roi_px)[3]))
    return failure(ErrorCode::usage, "roi_px", path_ + " has no such size",
                   "the nearest is 0,0," + std::to_string(layout->width_px) + "," + std::to_string(layout->height_px));
  return *layout;
}

core::Status Handle::set_rate(double fps) const {
  v4l2_streamparm data{};
  data.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  data.parm.capture.timeperframe = {1000, static_cast<std::uint32_t>(std::lround(fps * 1000))};
  if (!ask(VIDIOC_S_PARM, &data)) return tl::unexpected(error("setting fps"));
  return {};
}

core::Result<Layout> Handle::apply(const CameraSettings& s) const {
  if (!s.free_running())
    return failure(ErrorCode::usage, "trigger=" + s.trigger, "V4L2 cameras run free", "leave it out");
  if (s.binning || s.packet_bytes || s.packet_delay_us || s.socket_kib || !s.chunks.empty())
    return failure(ErrorCode::usage, "v4l2:" + path_, "binning, packets, sockets and chunks are of other cameras",
                   "leave them out");
  auto layout = set_layout(s);
  if (!layout) return layout;
  if (s.fps)
    if (auto done = set_rate(*s.fps); !done) return core::forward(done);
  if (auto done = set_controls(s); !done) return core::forward(done);
  return layout;
}

std::optional<double> exposure_us(const Handle& handle) {
  const auto all = handle.controls();
  const Control* c = find(all, V4L2_CID_EXPOSURE_ABSOLUTE);
  const auto v = c == nullptr ? std::nullopt : handle.value(*c);
  return v ? std::optional(static_cast<double>(*v) * kExposureUnit_us) : std::nullopt;
}

std::optional<double> gain(const Handle& handle) {
  const auto all = handle.controls();
  const Control* c = find(all, V4L2_CID_GAIN);
  const auto v = c == nullptr ? std::nullopt : handle.value(*c);
  return v ? std::optional(static_cast<double>(*v)) : std::nullopt;
}

}  // namespace pickcell::frames::v4l2
