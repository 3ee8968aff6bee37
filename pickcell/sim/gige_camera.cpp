#include "pickcell/sim/gige_camera.hpp"

#include <arv.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <span>

#include "pickcell/frames/gvcp_probe.hpp"

namespace pickcell::sim {

using core::ErrorCode;
using core::failure;
using std::chrono::milliseconds;

namespace {

/// How often the fake camera looks whether a trigger came.
constexpr double kTriggerLooks_hz = 250;
constexpr milliseconds kAnswer{200};
constexpr int kAsks = 5;

/// One row in the wire's format. Of a grey scene every colour sees the same.
void put_row(std::span<const std::uint8_t> grey, ArvPixelFormat format, std::uint8_t* to) {
  switch (format) {
    case ARV_PIXEL_FORMAT_MONO_16:
      for (const std::uint8_t v : grey) *to++ = v, *to++ = v;
      break;
    case ARV_PIXEL_FORMAT_RGB_8_PACKED:
      for (const std::uint8_t v : grey) to = std::fill_n(to, 3, v);
      break;
    default:
      std::copy(grey.begin(), grey.end(), to);
  }
}

/// The region of the buffer; what lies beyond the sensor is black.
void fill(ArvBuffer* buffer, const image::Image& picture, ArvPixelFormat format) {
  int x0 = 0, y0 = 0, w = 0, h = 0;
  arv_buffer_get_image_region(buffer, &x0, &y0, &w, &h);
  // How much was allocated Aravis does not tell; it calls only when a frame of this region and format fits.
  auto* bytes = static_cast<std::uint8_t*>(const_cast<void*>(arv_buffer_get_data(buffer, nullptr)));
  const std::size_t step = ARV_PIXEL_FORMAT_BIT_PER_PIXEL(format) / 8;
  if (x0 < 0 || y0 < 0 || w < 1 || h < 1) return;
  std::memset(bytes, 0, step * static_cast<std::size_t>(w) * static_cast<std::size_t>(h));
  const int seen = std::clamp(picture.width() - x0, 0, w);
  for (int y = 0; y < h && y0 + y < picture.height() && seen > 0; ++y)
    put_row({picture.row(y0 + y) + x0, static_cast<std::size_t>(seen)}, format,
            bytes + static_cast<std::size_t>(y) * static_cast<std::size_t>(w) * step);
}

std::optional<frames::gvcp::Identity> who_is_at(std::uint32_t address, int asks) {
  frames::GvcpProbe probe(address);
  for (int i = 0; i < asks; ++i)
    if (auto identity = probe.identify(kAnswer)) return identity;
  return std::nullopt;
}

}  // namespace

struct GigeCamera::Served {
  Settings settings;
  SimulatedCamera& camera;
  const core::Clock& clock;
  ArvGvFakeCamera* fake = nullptr;
  std::shared_ptr<const image::Image> picture{};  ///< the last one; of the fake camera's thread

  ~Served() {
    if (fake != nullptr) g_object_unref(fake);
  }

  /// In the fake camera's thread, for each frame.
  static void expose(ArvBuffer* buffer, void* self, guint32 exposure_us, guint32 gain_db, ArvPixelFormat format) {
    auto& served = *static_cast<Served*>(self);
    const core::TimePoint end = served.clock.now();
    const core::TimePoint begin = end - core::duration_s(exposure_us * 1e-6);
    if (!served.settings.still || served.picture == nullptr)
      served.picture = served.camera.expose_at(begin, exposure_us, gain_db).picture;
    fill(buffer, *served.picture, format);
    arv_buffer_set_timestamp(buffer, static_cast<guint64>(end.time_since_epoch().count()));
  }

  void set_up() {
    ArvFakeCamera* f = arv_gv_fake_camera_get_fake_camera(fake);
    const CameraSettings& c = camera.settings();
    const auto w = static_cast<guint32>(c.intrinsics.width_px), h = static_cast<guint32>(c.intrinsics.height_px);
    arv_fake_camera_write_register(f, ARV_FAKE_CAMERA_REGISTER_SENSOR_WIDTH, w);
    arv_fake_camera_write_register(f, ARV_FAKE_CAMERA_REGISTER_SENSOR_HEIGHT, h);
    arv_fake_camera_write_register(f, ARV_FAKE_CAMERA_REGISTER_WIDTH, w);
    arv_fake_camera_write_register(f, ARV_FAKE_CAMERA_REGISTER_HEIGHT, h);
    arv_fake_camera_write_register(f, ARV_FAKE_CAMERA_REGISTER_EXPOSURE_TIME_US,
                                   static_cast<guint32>(std::lround(c.exposure_us)));
    arv_fake_camera_write_register(f, ARV_FAKE_CAMERA_REGISTER_GAIN_RAW, 0);
    arv_fake_camera_write_register(f, ARV_FAKE_CAMERA_REGISTER_ACQUISITION_FRAME_PERIOD_US,
                                   static_cast<guint32>(std::lround(1e6 / settings.fps)));
    arv_fake_camera_set_trigger_frequency(f, kTriggerLooks_hz);
    arv_fake_camera_set_fill_pattern(f, &Served::expose, this);
  }
};

GigeCamera::GigeCamera(std::unique_ptr<Served> served) : served_(std::move(served)) {}
GigeCamera::~GigeCamera() = default;

std::string GigeCamera::source() const { return "aravis:" + served_->settings.bind; }

core::Result<std::unique_ptr<GigeCamera>> GigeCamera::switch_on(Settings settings, SimulatedCamera& camera,
                                                                const core::Clock& clock) {
  const std::string what = "GigE Vision camera at " + settings.bind;
  const auto address = frames::resolve(settings.bind);
  if (!address || *address == 0)
    return failure(ErrorCode::device, what, "is no address of this machine", "give the address of one interface");
  if (const auto other = who_is_at(*address, 1))
    return failure(ErrorCode::device, what, "the camera " + other->serial + " answers there already",
                   "end that program; the protocol has one port (UDP 3956) only");
  auto served = std::make_unique<Served>(Served{std::move(settings), camera, clock});
  served->fake = arv_gv_fake_camera_new(served->settings.bind.c_str(), served->settings.serial.c_str());
  if (served->fake == nullptr || !arv_gv_fake_camera_is_running(served->fake))
    return failure(ErrorCode::device, what, "no network interface has this address",
                   "give the address of one interface");
  served->set_up();
  // Aravis does not say whether it got the port.
  const auto self = who_is_at(*address, kAsks);
  if (!self || self->serial != served->settings.serial)
    return failure(ErrorCode::device, what, "UDP port 3956 is taken", "end the program that has it");
  return std::unique_ptr<GigeCamera>(new GigeCamera(std::move(served)));
}

}  // namespace pickcell::sim
