#include "pickcell/cli/experiment/latency_camera.hpp"

#ifdef PICKCELL_WITH_ARAVIS

#include <algorithm>
#include <cstdio>
#include <memory>
#include <vector>

#include "pickcell/cell/vision.hpp"
#include "pickcell/core/file.hpp"
#include "pickcell/core/statistics.hpp"
#include "pickcell/frames/open_source.hpp"
#include "pickcell/sim/camera.hpp"
#include "pickcell/sim/gige_camera.hpp"
#include "pickcell/sim/world.hpp"

namespace pickcell::cli {

namespace {

constexpr int kFrames = 300, kWarmUp = 10;

/// Notes when the cell's vision sets it to work, and finds nothing.
class StampingEngine final : public matches::Engine {
 public:
  StampingEngine(const core::Clock& clock, core::TimePoint& started) : clock_(clock), started_(started) {}
  [[nodiscard]] core::Result<matches::FindResult> find(const image::Pyramid&, std::span<const matches::Model* const>,
                                                       const matches::SearchOptions&) override {
    started_ = clock_.now();
    return matches::FindResult{};
  }
  [[nodiscard]] std::string name() const override { return "stamp"; }

 private:
  const core::Clock& clock_;
  core::TimePoint& started_;
};

double ms_between(core::TimePoint from, core::TimePoint to) { return core::seconds(to - from) * 1e3; }

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

  core::TimePoint matcher_started{};
  cell::Vision vision(std::make_unique<StampingEngine>(clock, matcher_started), {}, {});

  std::vector<double> ms, in_hand_ms;
  std::string csv = "frame,in_hand_ms,latency_ms\n";
  const int n = options.n.value_or(kFrames);
  for (int i = -kWarmUp; i < n; ++i) {
    const auto frame = (*source)->grab(*seat, std::chrono::seconds(10));
    const core::TimePoint in_hand = clock.now();
    if (!frame) return tl::unexpected(frame.error());
    if (auto looked = vision.look(*frame, 1); !looked) return core::forward(looked);
    if (i < 0) continue;
    const core::TimePoint exposed(core::Duration(*frame->device_ns));
    ms.push_back(ms_between(exposed, matcher_started));
    in_hand_ms.push_back(ms_between(exposed, in_hand));
    char line[64];
    std::snprintf(line, sizeof line, "%d,%.4f,%.4f\n", i, in_hand_ms.back(), ms.back());
    csv += line;
  }
  if (auto written = core::write_file_atomically(options.out / "latency_camera.csv", csv); !written)
    return core::forward(written);
  const frames::FrameCounters c = (*source)->counters();
  core::Json out = core::Json::object();
  out.set("frames", n).set("median_ms", *core::median(ms)).set("p99_ms", *core::quantile(ms, 0.99));
  out.set("worst_ms", *std::max_element(ms.begin(), ms.end())).set("in_hand_median_ms", *core::median(in_hand_ms));
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
