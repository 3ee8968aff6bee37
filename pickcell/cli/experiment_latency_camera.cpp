#include "pickcell/cli/experiment_latency_camera.hpp"

#ifdef PICKCELL_WITH_ARAVIS

#include <algorithm>
#include <cstdio>
#include <vector>

#include "pickcell/core/file.hpp"
#include "pickcell/core/statistics.hpp"
#include "pickcell/frames/open_source.hpp"
#include "pickcell/sim/camera.hpp"
#include "pickcell/sim/gige_camera.hpp"
#include "pickcell/sim/world.hpp"

namespace pickcell::cli {

namespace {

constexpr int kFrames = 300, kWarmUp = 10;

}  // namespace

core::Result<core::Json> measure_camera_latency(const ExperimentOptions& options) {
  core::RealClock clock;
  sim::World world(sim::default_world(options.seed));
  sim::SimulatedCamera camera(sim::default_camera(world.settings().T_base_plane, options.seed), world, clock);
  sim::GigeCamera::Settings settings;
  settings.still = true;
  auto served = sim::GigeCamera::switch_on(settings, camera, clock);
  if (!served) return core::forward(served);
  frames::SourceOptions open;
  open.settings.trigger = "software";
  auto source = frames::open_source((*served)->source(), open, clock);
  if (!source) return core::forward(source);
  const auto seat = clock.join("latency");

  std::vector<double> ms;
  std::string csv = "frame,latency_ms\n";
  const int n = options.n.value_or(kFrames);
  for (int i = -kWarmUp; i < n; ++i) {
    const auto frame = (*source)->grab(*seat, std::chrono::seconds(10));
    const core::TimePoint now = clock.now();
    if (!frame) return tl::unexpected(frame.error());
    if (i < 0) continue;
    ms.push_back(core::seconds(now - core::TimePoint(core::Duration(*frame->device_ns))) * 1e3);
    char line[48];
    std::snprintf(line, sizeof line, "%d,%.4f\n", i, ms.back());
    csv += line;
  }
  if (auto written = core::write_file_atomically(options.out / "latency_camera.csv", csv); !written)
    return core::forward(written);
  const frames::FrameCounters c = (*source)->counters();
  core::Json out = core::Json::object();
  out.set("frames", n).set("median_ms", *core::median(ms)).set("p99_ms", *core::quantile(ms, 0.99));
  out.set("worst_ms", *std::max_element(ms.begin(), ms.end()));
  out.set("lost", static_cast<std::int64_t>(c.incomplete + c.missing + c.torn + c.late));
  return out;
}

}  // namespace pickcell::cli

#else

namespace pickcell::cli {

core::Result<core::Json> measure_camera_latency(const ExperimentOptions&) {
  return core::failure(core::ErrorCode::usage, "latency of the camera", "this build has no support for GigE Vision",
                       "build with -DPICKCELL_WITH_ARAVIS=ON");
}

}  // namespace pickcell::cli

#endif
