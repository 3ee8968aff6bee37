/// The commands that a build does not have say so (PICKCELL_WITH_CELL=OFF, PICKCELL_WITH_CALIBRATION=OFF).

#include <CLI/CLI.hpp>

#include "pickcell/cli/subcommand.hpp"

namespace pickcell::cli {

namespace {

#if !defined(PICKCELL_WITH_CELL) || !defined(PICKCELL_WITH_CALIBRATION)

Runner say_missing(CLI::App& app, std::string what, std::string options) {
  app.allow_extras();
  app.set_help_flag();  // there is nothing to help with: even --help says what is missing
  const std::string command = app.get_name().substr(app.get_name().rfind(' ') + 1);
  return [=](Io&) -> core::Result<int> {
    return core::failure(core::ErrorCode::usage, command, "this build has no " + what, "configure with " + options);
  };
}

constexpr const char* kSummary = "not in this build";

#endif

#ifndef PICKCELL_WITH_CELL

Runner add_of_cell(CLI::App& app) { return say_missing(app, "cell, only the matcher", "-DPICKCELL_WITH_CELL=ON"); }

const Registration of_cell[] = {
    Registration({"serve", kSummary, add_of_cell}), Registration({"start", kSummary, add_of_cell}),
    Registration({"sim", kSummary, add_of_cell}),   Registration({"camera", kSummary, add_of_cell}),
    Registration({"robot", kSummary, add_of_cell}), Registration({"replay", kSummary, add_of_cell}),
};

#endif

#ifndef PICKCELL_WITH_CALIBRATION

Runner add_calibrate(CLI::App& app) {
  return say_missing(
      app, "calibration",
      "-DPICKCELL_WITH_CELL=ON -DPICKCELL_WITH_CALIBRATION=ON (needs libopencv-contrib-dev, libceres-dev)");
}

const Registration of_calibration({"calibrate", kSummary, add_calibrate});

#endif

}  // namespace

}  // namespace pickcell::cli
