#include "pickcell/frames/aravis_setup.hpp"

#include <arv.h>
#include <netinet/in.h>
#include <sys/socket.h>

#include <algorithm>
#include <charconv>
#include <cstdio>
#include <filesystem>

#include "pickcell/frames/gvcp_probe.hpp"

namespace pickcell::frames::aravis {

using core::ErrorCode;
using core::failure;

namespace {

constexpr int kLoopbackPacket = 8192;          ///< nothing is gained by small packets that no wire carries
constexpr unsigned kRetention_us = 100'000;    ///< a frame that stands still so long is given up
constexpr std::size_t kLeastSocket = 1 << 20;  ///< bytes

std::string number(double v) {
  char out[32];
  std::snprintf(out, sizeof out, "%.10g", v);
  return out;
}

bool on_loopback(const Located& located) { return located.gige_address && *located.gige_address >> 24 == 127; }

/// The value in words: of which type it is, the camera's own node decides.
core::Status set_feature(ArvCamera* camera, const std::string& shown, const std::string& key,
                         const std::string& value) {
  ArvDevice* device = arv_camera_get_device(camera);
  ArvGcNode* node = arv_device_get_feature(device, key.c_str());
  if (node == nullptr)
    return failure(ErrorCode::usage, key, "is neither a setting nor a feature of " + shown, remedy_for_unknown(key));
  Problem problem;
  if (ARV_IS_GC_COMMAND(node))
    arv_device_execute_command(device, key.c_str(), problem.out());
  else
    arv_device_set_features_from_string(device, (key + "=" + value).c_str(), problem.out());
  if (problem) return failure(ErrorCode::device, key + "=" + value, shown + " refuses it: " + problem.text());
  return {};
}

/// One setter of Aravis and the limits to name when it fails.
template <class Set, class Bounds>
core::Status set_number(const std::string& shown, const std::string& key, double value, Set set, Bounds bounds) {
  double lo = 0, hi = 0;
  Problem no_bounds;
  bounds(&lo, &hi, no_bounds.out());
  // Aravis clamps silently: what was asked for would not be what is.
  if (!no_bounds && lo < hi && (value < lo || value > hi))
    return failure(ErrorCode::usage, key + "=" + number(value), shown + " takes " + number(lo) + " to " + number(hi));
  Problem problem;
  set(value, problem.out());
  if (problem) return failure(ErrorCode::device, key + "=" + number(value), shown + " refuses it: " + problem.text());
  return {};
}

core::Status apply_format(ArvCamera* camera, const std::string& shown, const CameraSettings& s) {
  Problem problem;
  if (s.binning) {
    arv_camera_set_binning(camera, *s.binning, *s.binning, problem.out());
    if (problem) return failure(ErrorCode::device, "binning", shown + " refuses it: " + problem.text());
  }
  if (!s.pixel_format.empty()) {
    arv_camera_set_pixel_format_from_string(camera, s.pixel_format.c_str(), problem.out());
    if (problem)
      return failure(ErrorCode::usage, "pixel_format=" + s.pixel_format, shown + " refuses it: " + problem.text(),
                     "`pickcell camera info` lists the camera's formats");
  }
  if (s.roi_px) {
    const auto [x, y, w, h] = *s.roi_px;
    int sensor_w = 0, sensor_h = 0;
    arv_camera_get_sensor_size(camera, &sensor_w, &sensor_h, problem.out());
    if (!problem && (x + w > sensor_w || y + h > sensor_h))
      return failure(ErrorCode::usage, "roi_px",
                     "does not lie on the sensor of " + std::to_string(sensor_w) + "x" + std::to_string(sensor_h));
    arv_camera_set_region(camera, x, y, w, h, problem.out());
    if (problem) return failure(ErrorCode::device, "roi_px", shown + " refuses it: " + problem.text());
  }
  return {};
}

core::Status apply_exposure(ArvCamera* camera, const std::string& shown, const CameraSettings& s) {
  if (s.exposure_us)
    if (auto set = set_number(
            shown, "exposure_us", *s.exposure_us,
            [&](double v, GError** e) { arv_camera_set_exposure_time(camera, v, e); },
            [&](double* lo, double* hi, GError** e) { arv_camera_get_exposure_time_bounds(camera, lo, hi, e); });
        !set)
      return set;
  if (s.gain)
    if (auto set = set_number(
            shown, "gain", *s.gain, [&](double v, GError** e) { arv_camera_set_gain(camera, v, e); },
            [&](double* lo, double* hi, GError** e) { arv_camera_get_gain_bounds(camera, lo, hi, e); });
        !set)
      return set;
  if (s.fps)
    return set_number(
        shown, "fps", *s.fps, [&](double v, GError** e) { arv_camera_set_frame_rate(camera, v, e); },
        [&](double* lo, double* hi, GError** e) { arv_camera_get_frame_rate_bounds(camera, lo, hi, e); });
  return {};
}

core::Status apply_trigger(ArvCamera* camera, const std::string& shown, const CameraSettings& s) {
  Problem problem;
  if (s.free_running())
    arv_camera_clear_triggers(camera, problem.out());
  else
    arv_camera_set_trigger(camera, s.software_triggered() ? "Software" : s.trigger.c_str(), problem.out());
  // A camera without triggers runs free anyhow.
  if (problem && !s.free_running())
    return failure(ErrorCode::device, "trigger=" + s.trigger, shown + " refuses it: " + problem.text());
  return {};
}

core::Status apply_chunks(ArvCamera* camera, const std::string& shown, const CameraSettings& s) {
  if (s.chunks.empty()) return {};
  Problem problem;
  if (!arv_camera_are_chunks_available(camera, problem.out()) || problem)
    return failure(ErrorCode::usage, "chunks=" + s.chunks, shown + " has no chunk data", "leave the setting out");
  arv_camera_set_chunks(camera, s.chunks.c_str(), problem.out());
  if (problem) return failure(ErrorCode::device, "chunks=" + s.chunks, shown + " refuses it: " + problem.text());
  return {};
}

core::Status choose_packets(ArvCamera* camera, const std::string& shown, const CameraSettings& s) {
  if (!arv_camera_is_gv_device(camera)) return {};
  arv_camera_gv_set_stream_options(
      camera, s.packet_socket ? ARV_GV_STREAM_OPTION_NONE : ARV_GV_STREAM_OPTION_PACKET_SOCKET_DISABLED);
  arv_camera_gv_set_packet_size_adjustment(camera, ARV_GV_PACKET_SIZE_ADJUSTMENT_NEVER);
  Problem problem;
  if (s.packet_bytes) {
    arv_camera_gv_set_packet_size(camera, *s.packet_bytes, problem.out());
  } else if (arv_device_get_feature(arv_camera_get_device(camera), "GevSCPSFireTestPacket") != nullptr) {
    (void)arv_camera_gv_auto_packet_size(camera, problem.out());
  } else {
    GInetSocketAddress* peer =
        G_INET_SOCKET_ADDRESS(arv_gv_device_get_device_address(ARV_GV_DEVICE(arv_camera_get_device(camera))));
    if (g_inet_address_get_is_loopback(g_inet_socket_address_get_address(peer)))
      arv_camera_gv_set_packet_size(camera, kLoopbackPacket, problem.out());
  }
  if (problem) return failure(ErrorCode::device, "packet_bytes", shown + " refuses it: " + problem.text());
  if (s.packet_delay_us) {
    arv_camera_gv_set_packet_delay(camera, gint64{1000} * *s.packet_delay_us, problem.out());
    if (problem) return failure(ErrorCode::device, "packet_delay_us", shown + " refuses it: " + problem.text());
  }
  return {};
}

/// Bytes; what the kernel makes of it is half of what it reports.
int socket_bytes(const CameraSettings& s, std::size_t payload) {
  if (s.socket_kib) return *s.socket_kib * 1024;
  return static_cast<int>(std::min<std::size_t>(std::max(kLeastSocket, 4 * payload), std::size_t{1} << 28));
}

bool is_bound_to(int fd, std::uint16_t port) {
  sockaddr_in own{};
  socklen_t length = sizeof own;
  int type = 0;
  socklen_t type_length = sizeof type;
  return ::getsockopt(fd, SOL_SOCKET, SO_TYPE, &type, &type_length) == 0 && type == SOCK_DGRAM &&
         ::getsockname(fd, reinterpret_cast<sockaddr*>(&own), &length) == 0 && own.sin_family == AF_INET &&
         ntohs(own.sin_port) == port;
}

/// Makes the receive buffer of the stream's socket so large; gives what the kernel granted. Aravis does so only when
/// the first packet has come, too late for the first frame, and keeps its socket to itself: it is found by its port.
std::optional<int> enlarge_socket(ArvStream* stream, int bytes) {
  const guint16 port = arv_gv_stream_get_port(ARV_GV_STREAM(stream));
  std::error_code ignored;
  for (const auto& entry : std::filesystem::directory_iterator("/proc/self/fd", ignored)) {
    const std::string name = entry.path().filename().string();
    int fd = -1;
    if (std::from_chars(name.data(), name.data() + name.size(), fd).ec != std::errc() || !is_bound_to(fd, port))
      continue;
    // Beyond the limit of the system only with privilege.
    if (::setsockopt(fd, SOL_SOCKET, SO_RCVBUFFORCE, &bytes, sizeof bytes) != 0)
      (void)::setsockopt(fd, SOL_SOCKET, SO_RCVBUF, &bytes, sizeof bytes);
    int granted = 0;
    socklen_t length = sizeof granted;
    if (::getsockopt(fd, SOL_SOCKET, SO_RCVBUF, &granted, &length) == 0)
      return granted / 2;  // the kernel counts double
  }
  return std::nullopt;
}

}  // namespace

void Unref::operator()(void* object) const { g_object_unref(object); }

Problem::~Problem() { g_clear_error(&error_); }
GError** Problem::out() {
  g_clear_error(&error_);
  return &error_;
}
std::string Problem::text() const { return error_ == nullptr ? "" : error_->message; }

core::Result<Held<ArvCamera>> open(const Located& located) {
  Problem problem;
  Held<ArvCamera> camera(arv_camera_new(located.open_name.c_str(), problem.out()));
  if (!camera)
    return failure(ErrorCode::device, located.shown, "cannot be opened" + (problem ? ": " + problem.text() : ""),
                   "check the cable; for USB3 the rights on the device (docs/cameras.md)");
  ArvDevice* device = arv_camera_get_device(camera.get());
  if (ARV_IS_GV_DEVICE(device) && !arv_gv_device_is_controller(ARV_GV_DEVICE(device)))
    return failure(ErrorCode::device, located.shown, "another program holds the camera", "close it there");
  return camera;
}

core::Status apply(ArvCamera* camera, const std::string& shown, const CameraSettings& s) {
  if (auto done = apply_format(camera, shown, s); !done) return done;
  Problem ignored;  // cameras without other modes run continuously
  arv_camera_set_acquisition_mode(camera, ARV_ACQUISITION_MODE_CONTINUOUS, ignored.out());
  // The trigger first: it limits the frame rate of some cameras.
  if (auto done = apply_trigger(camera, shown, s); !done) return done;
  if (auto done = apply_exposure(camera, shown, s); !done) return done;
  for (const auto& [key, value] : s.features)
    if (auto done = set_feature(camera, shown, key, value); !done) return done;
  if (auto done = apply_chunks(camera, shown, s); !done) return done;
  return choose_packets(camera, shown, s);
}

core::Result<Held<ArvStream>> make_stream(ArvCamera* camera, const std::string& shown, const CameraSettings& s,
                                          int buffers, std::optional<int>* granted_socket) {
  Problem problem;
  Held<ArvStream> stream(arv_camera_create_stream(camera, nullptr, nullptr, problem.out()));
  if (!stream)
    return failure(ErrorCode::device, shown, "cannot stream: " + problem.text(), "check the camera and its cable");
  const guint payload = arv_camera_get_payload(camera, problem.out());
  if (problem || payload == 0 || payload > 1U << 30)
    return failure(ErrorCode::device, shown, "tells no usable size of its frames", "set pixel_format and roi_px");
  if (ARV_IS_GV_STREAM(stream.get())) {
    const auto granted = enlarge_socket(stream.get(), socket_bytes(s, payload));
    // 0: Aravis leaves the socket as it is now.
    g_object_set(stream.get(), "socket-buffer", ARV_GV_STREAM_SOCKET_BUFFER_FIXED, "socket-buffer-size",
                 granted ? 0 : socket_bytes(s, payload), "frame-retention", kRetention_us, nullptr);
    if (granted) *granted_socket = *granted;
    if (!s.resend) g_object_set(stream.get(), "packet-resend", ARV_GV_STREAM_PACKET_RESEND_NEVER, nullptr);
  }
  for (int i = 0; i < buffers; ++i) arv_stream_push_buffer(stream.get(), arv_buffer_new_allocate(payload));
  return stream;
}

DeviceInfo describe(ArvCamera* camera, const Located& located, const CameraSettings& s,
                    std::optional<int> granted_socket) {
  Problem p;
  const auto text = [](const char* t) { return std::string(t == nullptr ? "" : t); };
  DeviceInfo out;
  const std::string vendor = text(arv_camera_get_vendor_name(camera, p.out()));
  const std::string model = text(arv_camera_get_model_name(camera, p.out()));
  std::string serial = text(arv_camera_get_device_serial_number(camera, p.out()));
  if (serial.empty()) serial = text(arv_camera_get_device_id(camera, p.out()));
  out.id = vendor + "-" + model + "-" + serial;
  const bool gige = arv_camera_is_gv_device(camera) != 0;
  out.protocol = gige ? "GigE Vision" : "USB3 Vision";
  out.address = located.open_name;
  int x = 0, y = 0;
  arv_camera_get_region(camera, &x, &y, &out.width_px, &out.height_px, p.out());
  out.settings.offset_x_px = x;
  out.settings.offset_y_px = y;
  out.settings.pixel_format = text(arv_camera_get_pixel_format_as_string(camera, p.out()));
  if (const double v = arv_camera_get_exposure_time(camera, p.out()); !p) out.settings.exposure_us = v;
  if (const double v = arv_camera_get_gain(camera, p.out()); !p) out.settings.gain = v;
  auto& facts = out.facts;
  facts.emplace_back("vendor", vendor);
  facts.emplace_back("model", model);
  facts.emplace_back("serial", serial);
  guint n = 0;
  std::string formats;
  if (const char** all = arv_camera_dup_available_pixel_formats_as_strings(camera, &n, p.out())) {
    for (guint i = 0; i < n; ++i) formats += (i ? "," : "") + text(all[i]);
    g_free(all);
  }
  facts.emplace_back("pixel_formats", formats);
  if (const double v = arv_camera_get_frame_rate(camera, p.out()); !p) facts.emplace_back("fps", number(v));
  facts.emplace_back("trigger", s.trigger);
  if (!gige) return out;
  facts.emplace_back("packet_bytes", std::to_string(arv_camera_gv_get_packet_size(camera, p.out())));
  const guint payload = arv_camera_get_payload(camera, p.out());
  facts.emplace_back("frame_kib", std::to_string(payload / 1024));
  facts.emplace_back("socket_kib", std::to_string(socket_bytes(s, payload) / 1024));
  if (granted_socket) facts.emplace_back("socket_kib_granted", std::to_string(*granted_socket / 1024));
  facts.emplace_back("loopback", on_loopback(located) ? "true" : "false");
  return out;
}

namespace {

void list_category(ArvGc* gc, const char* name, std::vector<std::pair<std::string, std::string>>& out, int depth) {
  ArvGcNode* node = arv_gc_get_node(gc, name);
  if (ARV_IS_GC_CATEGORY(node)) {
    if (depth > 8) return;  // a description that contains itself
    for (const GSList* i = arv_gc_category_get_features(ARV_GC_CATEGORY(node)); i != nullptr; i = i->next)
      list_category(gc, static_cast<const char*>(i->data), out, depth + 1);
    return;
  }
  if (!ARV_IS_GC_FEATURE_NODE(node)) return;
  Problem p;
  if (!arv_gc_feature_node_is_available(ARV_GC_FEATURE_NODE(node), p.out()) || p) return;
  const char* value = ARV_IS_GC_COMMAND(node)
                          ? "(command)"
                          : arv_gc_feature_node_get_value_as_string(ARV_GC_FEATURE_NODE(node), p.out());
  out.emplace_back(name, value == nullptr || p ? "" : value);
}

}  // namespace

std::vector<std::pair<std::string, std::string>> features(ArvCamera* camera) {
  std::vector<std::pair<std::string, std::string>> out;
  list_category(arv_device_get_genicam(arv_camera_get_device(camera)), "Root", out, 0);
  return out;
}

}  // namespace pickcell::frames::aravis
