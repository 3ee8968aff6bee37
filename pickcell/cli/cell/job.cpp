#include "pickcell/cli/cell/job.hpp"

#include <stdexcept>

#include "pickcell/core/file.hpp"
#include "pickcell/core/log.hpp"
#include "pickcell/robot/vispick_job.hpp"

namespace pickcell::cli {

core::Result<std::string> job_for(const cell::CellConfig& config) {
  robot::VispickSettings job;
  const double share = config.limits.speed_pct / 100;
  job.tool = config.robot.tool;
  job.window_min_mm = config.limits.box_min_mm;
  job.window_max_mm = config.limits.box_max_mm;
  job.approach_mm = config.limits.approach_mm;  // that much below the window's top: planner and pick check see to it
  job.home_mm = config.robot.home_mm;
  job.gripper_output = config.robot.gripper_output;
  job.grip_sensor_input = config.robot.grip_sensor_input;
  for (double* speed : {&job.home_pct, &job.travel_pct, &job.travel_mm_s, &job.final_mm_s}) *speed *= share;
  try {
    return robot::vispick_job(job);
  } catch (const std::invalid_argument& problem) {
    return core::failure(core::ErrorCode::usage, config.file.string(),
                         std::string("no job can be made for its limits: ") + problem.what(),
                         "correct [limits] and [robot]");
  }
}

namespace {

/// Worth a word: the first motion after Start goes there.
std::string doubt_about_home(const cell::CellConfig& config) {
  for (std::size_t i = 0; i < 3; ++i)
    if (config.robot.home_mm[i] < config.limits.box_min_mm[i] || config.robot.home_mm[i] > config.limits.box_max_mm[i])
      return "; its home position lies outside the box: set home_mm in [robot]";
  return {};
}

}  // namespace

core::Status write_job(const cell::CellConfig& config) {
  const auto job = job_for(config);
  if (!job) return tl::unexpected(job.error());
  const auto file = config.state_dir / "VISPICK.JBI";
  const auto before = core::read_text_file(file);
  if (before && *before == *job) return {};
  if (auto written = core::write_file_atomically(file, *job); !written) return written;
  core::log(core::LogLevel::warning, "robot",
            "this cell's job (window, tool, speeds) is new in " + file.string() +
                ": load it on the controller; window, home and speed_pct act through it" + doubt_about_home(config));
  return {};
}

}  // namespace pickcell::cli
