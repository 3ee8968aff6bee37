#include "pickcell/frames/v4l2_device.hpp"

#include <linux/videodev2.h>
#include <poll.h>
#include <sys/mman.h>

#include <algorithm>
#include <cerrno>
#include <filesystem>
#include <span>

#include "pickcell/frames/pixel_format.hpp"
#include "pickcell/frames/v4l2_handle.hpp"

namespace pickcell::frames {

using core::ErrorCode;
using core::failure;
using std::chrono::milliseconds;

namespace {

constexpr std::uint32_t kBuffers = 6;

/// The driver's buffers, mapped.
class Buffers {
 public:
  Buffers() = default;
  Buffers(Buffers&&) = default;
  Buffers& operator=(Buffers&&) = delete;
  ~Buffers() {
    for (const auto& b : mapped_) (void)::munmap(b.data(), b.size());
  }
  [[nodiscard]] core::Status map(const v4l2::Handle& handle) {
    v4l2_requestbuffers request{};
    request.count = kBuffers;
    request.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
    request.memory = V4L2_MEMORY_MMAP;
    if (!handle.ask(VIDIOC_REQBUFS, &request)) return tl::unexpected(handle.error("asking for buffers"));
    for (std::uint32_t i = 0; i < request.count; ++i) {
      v4l2_buffer b{};
      b.type = request.type;
      b.memory = request.memory;
      b.index = i;
      if (!handle.ask(VIDIOC_QUERYBUF, &b)) return tl::unexpected(handle.error("asking for a buffer"));
      void* at = ::mmap(nullptr, b.length, PROT_READ | PROT_WRITE, MAP_SHARED, handle.fd(), b.m.offset);
      if (at == MAP_FAILED) return tl::unexpected(handle.error("mapping a buffer"));
      mapped_.emplace_back(static_cast<std::byte*>(at), b.length);
      if (auto queued = queue(handle, i); !queued) return queued;
    }
    if (mapped_.empty()) return failure(ErrorCode::device, "v4l2:" + handle.path(), "gives no buffers");
    return {};
  }
  [[nodiscard]] static core::Status queue(const v4l2::Handle& handle, std::uint32_t index) {
    v4l2_buffer b{};
    b.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
    b.memory = V4L2_MEMORY_MMAP;
    b.index = index;
    if (!handle.ask(VIDIOC_QBUF, &b)) return tl::unexpected(handle.error("giving back a buffer"));
    return {};
  }
  [[nodiscard]] std::span<const std::byte> at(std::uint32_t index) const {
    return index < mapped_.size() ? mapped_[index] : std::span<std::byte>();
  }

 private:
  std::vector<std::span<std::byte>> mapped_;
};

class V4l2Device final : public CameraDevice {
 public:
  V4l2Device(v4l2::Handle handle, Buffers buffers, v4l2::Layout layout, DeviceInfo info)
      : handle_(std::move(handle)), buffers_(std::move(buffers)), layout_(layout), info_(std::move(info)) {}
  ~V4l2Device() override {
    int type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
    (void)handle_.ask(VIDIOC_STREAMOFF, &type);
  }
  V4l2Device(const V4l2Device&) = delete;
  V4l2Device& operator=(const V4l2Device&) = delete;

  [[nodiscard]] const DeviceInfo& info() const override { return info_; }
  [[nodiscard]] core::Result<std::optional<Arrival>> next(milliseconds timeout) override;
  [[nodiscard]] core::Status trigger() override {
    return failure(ErrorCode::usage, info_.id, "cannot be triggered by software", "let it run free");
  }
  [[nodiscard]] core::Status check() override {
    v4l2_capability data{};
    if (!handle_.ask(VIDIOC_QUERYCAP, &data)) return tl::unexpected(handle_.error("asking whether it is there"));
    return {};
  }

 private:
  v4l2::Handle handle_;
  Buffers buffers_;
  v4l2::Layout layout_;
  DeviceInfo info_;
  std::optional<std::uint32_t> out_;  ///< the buffer that the last arrival points to
};

core::Result<std::optional<Arrival>> V4l2Device::next(milliseconds timeout) {
  if (out_)
    if (auto queued = Buffers::queue(handle_, *out_); !queued) return core::forward(queued);
  out_.reset();
  pollfd p{handle_.fd(), POLLIN, 0};
  if (::poll(&p, 1, static_cast<int>(timeout.count())) <= 0) return std::optional<Arrival>();
  v4l2_buffer data{};
  data.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  data.memory = V4L2_MEMORY_MMAP;
  if (!handle_.ask(VIDIOC_DQBUF, &data)) {
    if (errno == EAGAIN) return std::optional<Arrival>();
    return tl::unexpected(handle_.error("waiting for a frame"));
  }
  const auto filled = v4l2::parse_filled(std::as_bytes(std::span(&data, 1)));
  if (!filled) return std::optional<Arrival>();
  out_ = filled->index;
  Arrival arrival;
  arrival.id = filled->sequence;
  arrival.began = std::chrono::steady_clock::now();
  arrival.device_ns = filled->time_ns;
  // On Linux steady_clock is CLOCK_MONOTONIC: the driver's stamp is our time already.
  if (filled->monotonic && filled->time_ns != 0)
    arrival.began = std::chrono::steady_clock::time_point(std::chrono::nanoseconds(filled->time_ns));
  RawPicture& raw = arrival.picture;
  raw.format = v4l2::pfnc_of(layout_.fourcc).value_or(0);
  raw.width_px = layout_.width_px;
  raw.height_px = layout_.height_px;
  raw.stride_bytes = raw.format == kJpeg ? 0 : layout_.stride_bytes;
  const auto all = buffers_.at(filled->index);
  raw.bytes = all.first(std::min(filled->bytes, all.size()));
  if (filled->damaged)
    arrival.wholeness = Wholeness::incomplete;
  else if (raw.bytes.empty() || (raw.format != kJpeg && raw.bytes.size() < bytes_needed(raw)))
    arrival.wholeness = Wholeness::torn;
  return std::optional<Arrival>(arrival);
}

DeviceInfo describe(const v4l2::Handle& handle, const v4l2::Layout& layout) {
  DeviceInfo info;
  const auto capability = handle.capability().value_or(v4l2::Capability{});
  info.id = capability.card + "-" + capability.bus;
  std::replace(info.id.begin(), info.id.end(), ' ', '_');
  info.protocol = "V4L2";
  info.address = handle.path();
  info.width_px = layout.width_px;
  info.height_px = layout.height_px;
  info.settings.pixel_format = v4l2::fourcc_name(layout.fourcc);
  info.settings.exposure_us = v4l2::exposure_us(handle);
  info.settings.gain = v4l2::gain(handle);
  std::string formats;
  for (const auto& f : handle.formats()) formats += (formats.empty() ? "" : ",") + v4l2::fourcc_name(f.fourcc);
  info.facts = {{"driver", capability.driver}, {"model", capability.card}, {"pixel_formats", formats}};
  return info;
}

}  // namespace

std::vector<ListedCamera> find_v4l2_cameras() {
  std::vector<ListedCamera> out;
  std::error_code ignored;
  for (const auto& entry : std::filesystem::directory_iterator("/dev", ignored)) {
    const std::string path = entry.path().string();
    if (!path.starts_with("/dev/video")) continue;
    const auto handle = v4l2::Handle::open(path);
    if (!handle) continue;
    const auto c = handle->capability().value_or(v4l2::Capability{});
    out.push_back({"v4l2:" + path, "V4L2", c.driver, c.card, "", c.bus, "", false});
  }
  std::sort(out.begin(), out.end(), [](const auto& a, const auto& b) { return a.source < b.source; });
  return out;
}

core::Result<std::unique_ptr<CameraDevice>> connect_v4l2(const std::string& path, const CameraSettings& settings) {
  auto handle = v4l2::Handle::open(path);
  if (!handle) return core::forward(handle);
  auto layout = handle->apply(settings);
  if (!layout) return core::forward(layout);
  Buffers buffers;
  if (auto mapped = buffers.map(*handle); !mapped) return core::forward(mapped);
  DeviceInfo info = describe(*handle, *layout);
  int type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  if (!handle->ask(VIDIOC_STREAMON, &type)) return tl::unexpected(handle->error("starting"));
  return std::unique_ptr<CameraDevice>(
      std::make_unique<V4l2Device>(std::move(*handle), std::move(buffers), *layout, std::move(info)));
}

core::Result<std::vector<std::pair<std::string, std::string>>> v4l2_controls(const std::string& path) {
  auto handle = v4l2::Handle::open(path);
  if (!handle) return core::forward(handle);
  std::vector<std::pair<std::string, std::string>> out;
  for (const v4l2::Control& c : handle->controls()) {
    const auto v = handle->value(c);
    out.emplace_back(c.key, (v ? std::to_string(*v) : std::string("(button)")) + " (" + std::to_string(c.least) + ".." +
                                std::to_string(c.most) + ", " + c.name + ")");
  }
  return out;
}

}  // namespace pickcell::frames
