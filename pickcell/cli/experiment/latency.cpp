/// pickcell experiment latency: from the end of exposure to the matcher's start, from a pick to the arm's motion.

#include <cstdio>
#include <ostream>

#include "pickcell/cli/experiment/latency_camera.hpp"
#include "pickcell/cli/experiment/latency_robot.hpp"

namespace pickcell::cli {

namespace {

core::Result<int> run(const ExperimentOptions& options, Io& io) {
  auto camera = measure_camera_latency(options);
  if (!camera) return core::forward(camera);
  auto robot = measure_robot_latencies(options);
  if (!robot) return core::forward(robot);
  if (options.json) {
    core::Json out = core::Json::object();
    out.set("camera", *camera);
    out.set("robot", *robot);
    io.out << out.dump() << "\n";
    return 0;
  }
  const auto number = [&](const char* key) { return (*camera)[key].number().value_or(0); };
  char line[200];
  std::snprintf(
      line, sizeof line,
      "camera, end of exposure to matcher's start: median %.2f ms, p99 %.2f ms, worst %.2f ms over %.0f frames, "
      "%.0f lost (picture in hand: median %.2f ms)\n",
      number("median_ms"), number("p99_ms"), number("worst_ms"), number("frames"), number("lost"),
      number("in_hand_median_ms"));
  io.out << line << robot_latency_words(*robot);
  return 0;
}

const ExperimentRegistration registered(
    {"latency", "from exposure to matcher, from pick to motion; --n frames (300) and picks (50)", false, run});

}  // namespace

}  // namespace pickcell::cli
