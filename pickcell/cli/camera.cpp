/// pickcell camera: commissioning from the shell. What is there, how is it set, one picture, and how well frames
/// arrive.

#include <CLI/CLI.hpp>
#include <memory>

#include "pickcell/cli/camera_stream.hpp"
#include "pickcell/cli/process.hpp"
#include "pickcell/core/json.hpp"
#include "pickcell/frames/camera_list.hpp"
#include "pickcell/frames/live_source.hpp"
#include "pickcell/frames/open_source.hpp"
#include "pickcell/image/codec.hpp"

namespace pickcell::cli {

using core::ErrorCode;
using core::failure;
using core::Json;

namespace {

struct Options {
  std::string action, source;
  CameraCommand command;
  bool features = false;
};

core::Result<int> list(const Options& options, Io& io) {
  const auto found = frames::list_cameras();
  for (const frames::ListedCamera& c : found) {
    if (options.command.json) {
      Json line = Json::object();
      line.set("source", c.source).set("protocol", c.protocol).set("vendor", c.vendor).set("model", c.model);
      line.set("serial", c.serial).set("address", c.address).set("user_name", c.user_name).set("held", c.held);
      io.out << line.dump() << "\n";
    } else {
      io.out << c.source << "  " << c.protocol << ", " << c.vendor << " " << c.model << ", at " << c.address
             << (c.user_name.empty() ? "" : ", called " + c.user_name) << (c.held ? ", held by another program" : "")
             << "\n";
    }
  }
  const bool sees_gige = frames::check_source("aravis:").has_value();
  if (found.empty())
    io.err << "pickcell: camera list: no camera found"
           << (sees_gige
                   ? "; check power and cable (docs/cameras.md)\n"
                   : " on V4L2, and this build has no GigE or USB3 Vision; build with -DPICKCELL_WITH_ARAVIS=ON\n");
  return found.empty() ? 1 : 0;
}

Json settings_json(const frames::ExposureSettings& s) {
  Json out = Json::object();
  out.set("exposure_us", s.exposure_us ? Json(*s.exposure_us) : Json());
  out.set("gain", s.gain ? Json(*s.gain) : Json());
  out.set("pixel_format", s.pixel_format);
  out.set("offset_x_px", s.offset_x_px).set("offset_y_px", s.offset_y_px);
  return out;
}

core::Result<int> info(const Options& options, Io& io) {
  core::RealClock clock;
  auto source = open_camera(options.source, options.command, frames::LiveSource::Policy::newest, clock);
  if (!source) return core::forward(source);
  const frames::SourceInfo info = (*source)->info();
  Json out = Json::object();
  out.set("camera_id", info.camera_id).set("width_px", info.width_px).set("height_px", info.height_px);
  if (const auto* live = dynamic_cast<const frames::LiveSource*>(source->get())) {
    const frames::DeviceInfo device = live->device();
    out.set("protocol", device.protocol).set("address", device.address);
    const Json settings = settings_json(device.settings);
    for (const auto& [key, value] : settings.members()) out.set(key, value);
    for (const auto& [key, value] : device.facts) out.set(key, value);
  }
  if (options.features) {
    source->reset();
    auto features = frames::camera_features(options.source);
    if (!features) return core::forward(features);
    Json all = Json::object();
    for (const auto& [key, value] : *features) all.set(key, value);
    out.set("features", std::move(all));
  }
  if (options.command.json) {
    io.out << out.dump() << "\n";
    return 0;
  }
  for (const auto& [key, value] : out.members()) {
    if (value.is_object())
      for (const auto& [name, v] : value.members()) io.out << "  " << name << " = " << v.string() << "\n";
    else if (!value.is_null())
      io.out << key << ": " << (value.is_string() ? value.string() : value.dump()) << "\n";
  }
  return 0;
}

core::Result<int> snap(const Options& options, Io& io) {
  core::RealClock clock;
  auto source = open_camera(options.source, options.command, frames::LiveSource::Policy::newest, clock);
  if (!source) return core::forward(source);
  const auto seat = clock.join("camera");
  auto frame = (*source)->grab(*seat, core::duration_s(options.command.timeout_s));
  if (!frame) return core::forward(frame);
  const std::string file = options.command.out.empty() ? "snap.png" : options.command.out;
  if (auto saved = image::save_png(file, frame->picture->view()); !saved) return core::forward(saved);
  Json line = Json::object();
  line.set("file", file).set("camera_id", frame->camera_id.str());
  line.set("width_px", frame->picture->width()).set("height_px", frame->picture->height());
  line.set("sequence", static_cast<std::int64_t>(frame->sequence)).set("exposed_unix_us", frame->exposed_unix_us);
  line.set("device_ns", frame->device_ns ? Json(*frame->device_ns) : Json());
  line.set("encoder", frame->encoder ? Json(*frame->encoder) : Json());
  const Json settings = frame->settings ? settings_json(*frame->settings) : Json::object();
  for (const auto& [key, value] : settings.members()) line.set(key, value);
  if (options.command.json)
    io.out << line.dump() << "\n";
  else
    io.out << file << ": " << frame->picture->width() << "x" << frame->picture->height() << " of "
           << frame->camera_id.str() << "\n";
  return 0;
}

core::Result<int> set(const Options& options, Io& io) {
  if (options.command.set.empty())
    return failure(ErrorCode::usage, "camera set", "nothing to set", "give --set KEY=VALUE");
  return info(options, io);
}

core::Result<int> run(const Options& options, Io& io) {
  const LogOnErr log(io.err);
  if (options.action == "list") return list(options, io);
  if (options.source.empty())
    return failure(ErrorCode::usage, "camera " + options.action, "no SOURCE given",
                   "one that `pickcell camera list` shows, or files:PATH");
  if (options.action == "info") return info(options, io);
  if (options.action == "snap") return snap(options, io);
  if (options.action == "set") return set(options, io);
  return stream(options.source, options.command, io);
}

Runner add(CLI::App& app) {
  auto o = std::make_shared<Options>();
  app.add_option("action", o->action, "list: what is there; info; snap: one picture; stream: rate and losses; set")
      ->required()
      ->check(CLI::IsMember({"list", "info", "snap", "stream", "set"}));
  app.add_option("source", o->source, "aravis:NAME, v4l2:/dev/videoN or files:PATH")->type_name("SOURCE");
  app.add_option("-o,--out", o->command.out, "snap: the picture (snap.png); stream: a folder for every frame")
      ->type_name("FILE|DIR");
  app.add_option("--frames", o->command.frames, "stream: end after so many; 0: with Ctrl-C (100)")
      ->check(CLI::Range(std::int64_t{0}, std::int64_t{1'000'000'000}));
  app.add_option("--set", o->command.set, "a setting or a feature of the camera (docs/cameras.md)")
      ->type_name("KEY=VALUE")
      ->allow_extra_args(false);
  app.add_option("--timeout-s", o->command.timeout_s, "how long to wait for a picture (5)")
      ->check(CLI::Range(0.01, 3600.0));
  app.add_option("--fps", o->command.fps, "of files: pictures per second; 0: as fast as possible (0)")
      ->check(CLI::Range(0.0, 100'000.0));
  app.add_flag("--loop", o->command.loop, "of files: begin again after the last");
  app.add_flag("--features", o->features, "info: every feature of the camera");
  app.add_flag("--json", o->command.json, "one JSON object per line");
  return [o](Io& io) { return run(*o, io); };
}

const Registration registered({"camera", "find, set and try cameras", add});

}  // namespace

}  // namespace pickcell::cli
