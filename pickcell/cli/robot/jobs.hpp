#pragma once
/// `pickcell robot LINK job ...`: list, show, download, upload, delete, start.

#include <string>
#include <vector>

#include "pickcell/cli/robot/moves.hpp"
#include "pickcell/cli/subcommand.hpp"
#include "pickcell/core/json.hpp"
#include "pickcell/core/result.hpp"
#include "pickcell/robot/controller_link.hpp"

namespace pickcell::cli {

struct JobRequest {
  std::vector<std::string> words;  ///< what stands behind `job`
  std::string output;              ///< file of a download
  MoveLimits limits;               ///< of start
};

/// What a job file must have before it is sent: CR LF, /JOB, //NAME that is the file's name, NOP first, END last. Its
/// name, or a usage error with the line.
[[nodiscard]] core::Result<std::string> check_job_text(const std::string& text, const std::string& file);

/// The answer as one object; words for a person under "text" where there is more to say.
[[nodiscard]] core::Result<core::Json> run_job_request(robot::ControllerLink& link, const JobRequest& request);

}  // namespace pickcell::cli
