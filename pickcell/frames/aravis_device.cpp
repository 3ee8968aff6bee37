#include "pickcell/frames/aravis_device.hpp"

#include <arv.h>

#include <algorithm>
#include <cstring>

#include "pickcell/frames/aravis_locate.hpp"
#include "pickcell/frames/aravis_setup.hpp"
#include "pickcell/frames/gvcp_probe.hpp"
#include "pickcell/frames/pixel_format.hpp"

namespace pickcell::frames {

using core::ErrorCode;
using core::failure;
using std::chrono::milliseconds;

namespace {

constexpr milliseconds kAnswer{140};
constexpr int kBuffers = 10;

/// Host time of a wall-clock stamp that is not old.
std::chrono::steady_clock::time_point steady_of(guint64 system_ns) {
  const auto now = std::chrono::steady_clock::now();
  const std::int64_t age_ns = g_get_real_time() * 1000 - static_cast<std::int64_t>(system_ns);
  // The wall clock may be set in between: then the moment of reading is the better guess.
  if (system_ns == 0 || age_ns < 0 || age_ns > 1'000'000'000) return now;
  return now - std::chrono::nanoseconds(age_ns);
}

class AravisDevice final : public CameraDevice {
 public:
  AravisDevice(aravis::Held<ArvCamera> camera, aravis::Held<ArvStream> stream, DeviceInfo info,
               const CameraSettings& settings, std::optional<std::uint32_t> gige_address)
      : camera_(std::move(camera)), stream_(std::move(stream)), info_(std::move(info)) {
    if (gige_address) probe_.emplace(*gige_address);
    if (!settings.chunks.empty()) parser_.reset(arv_camera_create_chunk_parser(camera_.get()));
  }
  ~AravisDevice() override {
    give_back();
    if (is_ours()) {
      aravis::Problem ignored;
      arv_camera_stop_acquisition(camera_.get(), ignored.out());
    }
    parser_.reset();
    stream_.reset();
    camera_.reset();
  }
  AravisDevice(const AravisDevice&) = delete;
  AravisDevice& operator=(const AravisDevice&) = delete;

  [[nodiscard]] const DeviceInfo& info() const override { return info_; }
  [[nodiscard]] core::Result<std::optional<Arrival>> next(milliseconds timeout) override;
  [[nodiscard]] core::Status trigger() override;
  [[nodiscard]] core::Status check() override;
  [[nodiscard]] std::uint64_t resends() const override {
    return arv_camera_is_gv_device(camera_.get())
               ? arv_stream_get_info_uint64_by_name(stream_.get(), "n_resend_requests")
               : 0;
  }

 private:
  void give_back() {
    if (buffer_ == nullptr) return;
    // A frame whose first packet is lost would still carry the number of the one before in the same buffer.
    arv_buffer_set_frame_id(buffer_, 0);
    arv_stream_push_buffer(stream_.get(), buffer_);
    buffer_ = nullptr;
  }
  [[nodiscard]] bool is_ours() const {
    ArvDevice* device = arv_camera_get_device(camera_.get());
    return !gone_ && (!ARV_IS_GV_DEVICE(device) || arv_gv_device_is_controller(ARV_GV_DEVICE(device)));
  }
  void read_chunks(Arrival& arrival) const;

  aravis::Held<ArvCamera> camera_;
  aravis::Held<ArvStream> stream_;
  aravis::Held<ArvChunkParser> parser_;
  DeviceInfo info_;
  std::optional<GvcpProbe> probe_;
  ArvBuffer* buffer_ = nullptr;
  bool gone_ = false;
};

Wholeness wholeness_of(ArvBuffer* buffer, Arrival& arrival) {
  if (arv_buffer_get_status(buffer) != ARV_BUFFER_STATUS_SUCCESS) return Wholeness::incomplete;
  const ArvBufferPayloadType type = arv_buffer_get_payload_type(buffer);
  if (type != ARV_BUFFER_PAYLOAD_TYPE_IMAGE && type != ARV_BUFFER_PAYLOAD_TYPE_EXTENDED_CHUNK_DATA)
    return Wholeness::torn;
  int w = 0, h = 0, pad_x = 0, pad_y = 0;
  arv_buffer_get_image_region(buffer, &arrival.offset_x_px, &arrival.offset_y_px, &w, &h);
  arv_buffer_get_image_padding(buffer, &pad_x, &pad_y);
  std::size_t size = 0;
  const void* data = arv_buffer_get_image_data(buffer, &size);
  RawPicture& raw = arrival.picture;
  raw.format = arv_buffer_get_image_pixel_format(buffer);
  raw.width_px = w;
  raw.height_px = h;
  raw.bytes = {static_cast<const std::byte*>(data), size};
  if (pad_x > 0 && w > 0)
    if (const PixelFormat* format = pixel_format(raw.format))
      raw.stride_bytes = static_cast<std::size_t>((w * format->bits_per_pixel + 7) / 8 + pad_x);
  const std::size_t need = bytes_needed(raw);
  return need == 0 || size < need ? Wholeness::torn : Wholeness::whole;
}

core::Result<std::optional<Arrival>> AravisDevice::next(milliseconds timeout) {
  give_back();
  buffer_ = arv_stream_timeout_pop_buffer(stream_.get(), static_cast<guint64>(timeout.count()) * 1000);
  if (buffer_ == nullptr) return std::optional<Arrival>();
  Arrival arrival;
  arrival.id = arv_buffer_get_frame_id(buffer_);
  arrival.wholeness = wholeness_of(buffer_, arrival);
  arrival.numbered = arrival.wholeness != Wholeness::incomplete || arrival.id != 0;
  if (arrival.wholeness == Wholeness::whole) {
    arrival.device_ns = static_cast<std::int64_t>(arv_buffer_get_timestamp(buffer_));
    arrival.began = steady_of(arv_buffer_get_system_timestamp(buffer_));
    if (arrival.picture.width_px != info_.width_px || arrival.picture.height_px != info_.height_px)
      arrival.wholeness = Wholeness::torn;
    if (parser_ && arv_buffer_has_chunks(buffer_)) read_chunks(arrival);
  }
  return std::optional<Arrival>(arrival);
}

void AravisDevice::read_chunks(Arrival& arrival) const {
  const auto real = [&](const char* chunk) -> std::optional<double> {
    aravis::Problem problem;
    const double v = arv_chunk_parser_get_float_value(parser_.get(), buffer_, chunk, problem.out());
    return problem ? std::nullopt : std::optional(v);
  };
  aravis::Problem problem;
  const gint64 encoder = arv_chunk_parser_get_integer_value(parser_.get(), buffer_, "ChunkEncoderValue", problem.out());
  if (!problem) arrival.encoder = encoder;
  arrival.exposure_us = real("ChunkExposureTime");
  arrival.gain = real("ChunkGain");
}

core::Status AravisDevice::trigger() {
  aravis::Problem problem;
  arv_camera_software_trigger(camera_.get(), problem.out());
  if (problem)
    return failure(ErrorCode::device, info_.id, "does not take the trigger: " + problem.text(),
                   "check the camera and its cable");
  return {};
}

core::Status AravisDevice::check() {
  if (!is_ours()) {
    gone_ = true;
    return failure(ErrorCode::device, info_.id, "the camera is lost",
                   "check its power and cable; it reconnects itself");
  }
  if (!probe_) return {};  // USB tells by itself
  const auto control = probe_->read(gvcp::kControlRegister, kAnswer);
  if (!control)
    return failure(ErrorCode::timeout, info_.id, "the camera does not answer any more at " + info_.address,
                   "check its power and cable; it reconnects itself");
  if (control->status == 0 && (control->value & gvcp::kHeldBits) == 0) {
    gone_ = true;  // it answers, but knows nothing of us
    return failure(ErrorCode::device, info_.id, "the camera started anew", "nothing to do: it reconnects itself");
  }
  return {};
}

}  // namespace

core::Result<std::unique_ptr<CameraDevice>> connect_aravis(const std::string& name, const CameraSettings& settings) {
  auto located = locate_aravis(name);
  if (!located) return core::forward(located);
  auto camera = aravis::open(*located);
  if (!camera) return core::forward(camera);
  if (auto set = aravis::apply(camera->get(), located->shown, settings); !set) return core::forward(set);
  std::optional<int> socket;
  auto stream = aravis::make_stream(camera->get(), located->shown, settings, kBuffers, &socket);
  if (!stream) return core::forward(stream);
  DeviceInfo info = aravis::describe(camera->get(), *located, settings, socket);
  if (pixel_format(info.settings.pixel_format) == nullptr)
    return failure(ErrorCode::device, located->shown,
                   "sends " + info.settings.pixel_format + ", which is not understood",
                   "set pixel_format to one of: " + known_formats());
  aravis::Problem problem;
  arv_camera_start_acquisition(camera->get(), problem.out());
  if (problem)
    return failure(ErrorCode::device, located->shown, "does not start: " + problem.text(), "check the camera");
  return std::unique_ptr<CameraDevice>(std::make_unique<AravisDevice>(
      std::move(*camera), std::move(*stream), std::move(info), settings, located->gige_address));
}

core::Result<std::vector<std::pair<std::string, std::string>>> aravis_features(const std::string& name) {
  auto located = locate_aravis(name);
  if (!located) return core::forward(located);
  auto camera = aravis::open(*located);
  if (!camera) return core::forward(camera);
  return aravis::features(camera->get());
}

}  // namespace pickcell::frames
