// pickcell sim: the simulated controller with its world as a process of its own, in real time, for foreign clients.

#include <CLI/CLI.hpp>
#include <array>
#include <memory>
#include <optional>
#include <ostream>
#include <stdexcept>

#include "pickcell/cli/process.hpp"
#include "pickcell/cli/subcommand.hpp"
#include "pickcell/core/config.hpp"
#include "pickcell/core/file.hpp"
#ifdef PICKCELL_WITH_ARAVIS
#include "pickcell/sim/gige_camera.hpp"
#endif
#include "pickcell/sim/controller.hpp"
#include "pickcell/sim/controller_commands.hpp"
#include "pickcell/sim/shipped_jobs.hpp"
#include "pickcell/sim/world.hpp"

namespace pickcell::cli {

namespace {

using core::ErrorCode;
using core::failure;

struct Options {
  std::string file, scenario;
  std::optional<std::string> bind, model, controller, banner;
  std::optional<int> tcp80_port, hses_port, motoros_port;
  std::optional<std::string> motoros_endian;
  bool camera = false, no_camera = false;
};

struct Setup {
  sim::ControllerSettings controller;
  std::uint64_t seed = 1;
  bool camera = false;
  std::vector<sim::FaultEvent> scenario;
};

/// What real clients need to see the OK line and the result apart.
constexpr double kSegmentPause_s = 0.02;
constexpr int kRealPort = 80, kRealHsesPort = 10040, kRealMotoRosPort = 50240;

/// What this build leaves out.
core::Status refuse_missing_doors([[maybe_unused]] const Options& o) {
#ifndef PICKCELL_WITH_ARAVIS
  if (o.camera)
    return failure(ErrorCode::usage, "--camera", "this build has no support for GigE Vision",
                   "build with -DPICKCELL_WITH_ARAVIS=ON");
#endif
  return {};
}

core::Result<sim::ArmModel> arm_of(const std::string& name) {
  const auto model = sim::arm_model(name);
  if (!model) return failure(ErrorCode::usage, "model", "no arm '" + name + "'", "one of gp7, gp8, motomini");
  return *model;
}

core::Result<robot::ByteOrder> order_of(const std::string& name) {
  if (name == "little") return robot::ByteOrder::little;
  if (name == "big") return robot::ByteOrder::big;
  return failure(ErrorCode::usage, "motoros_endian", "no byte order '" + name + "'", "little or big");
}

core::Status read_file(const std::string& path, Setup& setup) {
  auto config = core::Config::load(path);
  if (!config) return core::forward(config);
  sim::ControllerSettings& c = setup.controller;
  c.bind = config->string_or("bind", c.bind);
  c.tcp80_port = static_cast<int>(config->integer_or("tcp80_port", c.tcp80_port));
  c.hses_port = static_cast<int>(config->integer_or("hses_port", c.hses_port));
  c.motoros_port = static_cast<int>(config->integer_or("motoros_port", *c.motoros_port));
  if (config->has("motoros_endian")) {
    auto order = order_of(config->string("motoros_endian"));
    if (!order) return core::forward(order);
    c.motoros_order = *order;
  }
  c.type = config->string_or("controller", c.type);
  c.banner = config->string_or("banner", c.banner);
  c.segment_pause_s = config->number_or("segment_pause_s", c.segment_pause_s);
  c.tool_length_m = config->number_or("tool_length_mm", c.tool_length_m * 1000) / 1000;
  setup.seed = static_cast<std::uint64_t>(config->integer_or("seed", static_cast<std::int64_t>(setup.seed)));
  const std::string model = config->string_or("model", std::string(sim::name(c.model)));
  const auto arm = sim::arm_model(model);
  if (arm)
    c.model = *arm;
  else
    config->problem("model", "must be one of gp7, gp8, motomini");
  if (c.segment_pause_s < 0 || c.segment_pause_s > 10) config->problem("segment_pause_s", "must be between 0 and 10");
  for (core::Config& job : config->tables("job")) {
    auto text = core::read_text_file(job.path("file"));
    if (!text) return core::forward(text);
    c.jobs.push_back(*text);
  }
  auto events = sim::parse_scenario(*config);
  if (!events) return core::forward(events);
  setup.scenario = std::move(*events);
  return {};
}

core::Status read_scenario(const std::string& path, Setup& setup) {
  auto config = core::Config::load(path);
  if (!config) return core::forward(config);
  auto events = sim::parse_scenario(*config);
  if (!events) return core::forward(events);
  setup.scenario.insert(setup.scenario.end(), events->begin(), events->end());
  return {};
}

core::Status check(const sim::ControllerSettings& c) {
  if (c.tcp80_port < 0 || c.tcp80_port > 65535)
    return failure(ErrorCode::usage, "--tcp80-port", std::to_string(c.tcp80_port) + " is no TCP port",
                   "0 (any free one) to 65535");
  if (c.hses_port < 0 || c.hses_port > 65534)
    return failure(ErrorCode::usage, "--hses-port", std::to_string(c.hses_port) + " is no UDP port with a next one",
                   "0 (any free ones) to 65534");
  if (*c.motoros_port < 0 || *c.motoros_port > 65533)
    return failure(ErrorCode::usage, "--motoros-port",
                   std::to_string(*c.motoros_port) + " and the next two are no ports", "0 (any free three) to 65533");
  if (!sim::controller_type(c.type))
    return failure(ErrorCode::usage, "--controller", "no controller '" + c.type + "'",
                   "one of nx100, dx100, fs100, dx200, yrc1000");
  if (!c.banner.empty() && c.banner != "NX" && c.banner != "DX" && c.banner != "YR")
    return failure(ErrorCode::usage, "--banner", "no banner '" + c.banner + "'", "one of NX, DX, YR");
  for (const std::string& text : c.jobs)
    if (const auto job = sim::parse_job(text); !job)
      return failure(ErrorCode::unreadable, "job", "line " + std::to_string(job.error().line) + ": " + job.error().why);
  return {};
}

core::Result<Setup> setup_of(const Options& o) {
  if (auto status = refuse_missing_doors(o); !status) return core::forward(status);
  Setup setup;
  sim::ControllerSettings& c = setup.controller;
  c.tcp80_port = kRealPort;
  c.hses_port = kRealHsesPort;
  c.motoros_port = kRealMotoRosPort;
  c.segment_pause_s = kSegmentPause_s;
  c.jobs = sim::shipped_jobs();
  if (!o.file.empty())
    if (auto status = read_file(o.file, setup); !status) return core::forward(status);
  if (!o.scenario.empty())
    if (auto status = read_scenario(o.scenario, setup); !status) return core::forward(status);
  c.bind = o.bind.value_or(c.bind);
  c.tcp80_port = o.tcp80_port.value_or(c.tcp80_port);
  // Who lets the system choose the first port does not care for the others either.
  if (o.tcp80_port == 0) c.hses_port = *(c.motoros_port = 0);
  c.hses_port = o.hses_port.value_or(c.hses_port);
  c.motoros_port = o.motoros_port.value_or(*c.motoros_port);
  if (o.motoros_endian) {
    auto order = order_of(*o.motoros_endian);
    if (!order) return core::forward(order);
    c.motoros_order = *order;
  }
  c.type = o.controller.value_or(c.type);
  c.banner = o.banner.value_or(c.banner);
  if (o.model) {
    auto arm = arm_of(*o.model);
    if (!arm) return core::forward(arm);
    c.model = *arm;
  }
  setup.camera = o.camera && !o.no_camera;
  if (auto status = check(c); !status) return core::forward(status);
  return setup;
}

core::Result<int> run(const Options& options, Io& io) {
  auto setup = setup_of(options);
  if (!setup) return core::forward(setup);
  const StopSignals stop;
  core::RealClock clock;
  sim::World world(sim::default_world(setup->seed));
  auto controller = sim::Controller::switch_on(setup->controller, clock, &world);
  if (!controller) return core::forward(controller);
  // A controller shows a job from the day it was set up: hosts that ask for it first must get an answer.
  (*controller)->with_state([](sim::ControllerState& s) { (void)sim::select_job(s, "TEST1", 0); });
  (*controller)->follow(std::move(setup->scenario));
#ifdef PICKCELL_WITH_ARAVIS
  sim::SimulatedCamera camera(sim::default_camera(world.settings().T_base_plane, setup->seed), world, clock);
  std::unique_ptr<sim::GigeCamera> gige;
  if (setup->camera) {
    auto served = sim::GigeCamera::switch_on({setup->controller.bind}, camera, clock);
    if (!served) return core::forward(served);
    gige = std::move(*served);
    io.err << "pickcell: camera: serving " << gige->source() << std::endl;
  }
#endif
  io.err << "pickcell: tcp80: listening on " << setup->controller.bind << ":" << (*controller)->tcp80_port()
         << "\npickcell: hses: listening on " << setup->controller.bind << ":" << (*controller)->hses_port()
         << ", files on the next port\npickcell: motoros: listening on " << setup->controller.bind << ":"
         << (*controller)->motoros_port() << ", state and I/O on the next two" << std::endl;
  io.out << "ready" << std::endl;
  stop.wait();
  return 0;
}

Runner add(CLI::App& app) {
  auto o = std::make_shared<Options>();
  app.add_option("sim_toml", o->file, "settings (SIM.toml); options win");
  app.add_option("--bind", o->bind, "address to listen on (127.0.0.1)");
  app.add_option("--tcp80-port", o->tcp80_port, "Ethernet Server port (80; 0: any free one, named on stderr)");
  app.add_option("--hses-port", o->hses_port,
                 "High Speed Ethernet Server, UDP, files on the next (10040; 0: any free ones, named on stderr)");
  app.add_option("--motoros-port", o->motoros_port,
                 "MotoROS motion port, state and I/O on the next two (50240; 0: any free, named on stderr)");
  app.add_option("--motoros-endian", o->motoros_endian, "little or big (the controller's own: fs100 big, else little)");
  app.add_option("--model", o->model, "gp7, gp8 or motomini (gp7)");
  app.add_option("--controller", o->controller, "nx100, dx100, fs100, dx200 or yrc1000 (yrc1000)");
  app.add_option("--banner", o->banner, "NX, DX or YR (the controller's own)");
  auto* camera = app.add_flag("--camera", o->camera, "serve the simulated camera over GigE Vision (UDP 3956)");
  app.add_flag("--no-camera", o->no_camera, "no camera (as it is)")->excludes(camera);
  app.add_option("--scenario", o->scenario, "faults to inject, [[event]] tables");
  return [o](Io& io) { return run(*o, io); };
}

const Registration registered({"sim", "simulated controller for foreign clients, in real time", add});

}  // namespace

}  // namespace pickcell::cli
