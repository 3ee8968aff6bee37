#include "pickcell/cli/cell_job.hpp"

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
  job.window_max_mm[2] += job.approach_mm;  // the window holds the points above grasp and place too
  for (double* speed : {&job.home_pct, &job.travel_pct, &job.travel_mm_s, &job.final_mm_s}) *speed *= share;
  try {
    return robot::vispick_job(job);
  } catch (const std::invalid_argument& problem) {
    return core::failure(core::ErrorCode::usage, config.file.string(),
                         std::string("no job can be made for its limits: ") + problem.what(),
                         "correct box_min_mm, box_max_mm or speed_pct in [limits]");
  }
}

core::Status write_job(const cell::CellConfig& config) {
  const auto job = job_for(config);
  if (!job) return tl::unexpected(job.error());
  const auto file = config.state_dir / "VISPICK.JBI";
  const auto before = core::read_text_file(file);
  if (before && *before == *job) return {};
  if (auto written = core::write_file_atomically(file, *job); !written) return written;
  core::log(core::LogLevel::warning, "robot",
            "this cell's job (window, tool, speeds) is new in " + file.string() +
                ": load it on the controller; window and speed_pct act through it");
  return {};
}

}  // namespace pickcell::cli
