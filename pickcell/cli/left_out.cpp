/// The commands that a build without the cell does not have say so (PICKCELL_WITH_CELL=OFF).

#include <CLI/CLI.hpp>

#include "pickcell/cli/subcommand.hpp"

namespace pickcell::cli {

namespace {

Runner add(CLI::App& app) {
  app.allow_extras();
  app.set_help_flag();  // there is nothing to help with: even --help says what is missing
  const std::string command = app.get_name().substr(app.get_name().rfind(' ') + 1);
  return [command](Io&) -> core::Result<int> {
    return core::failure(core::ErrorCode::usage, command, "this build has no cell, only the matcher",
                         "configure with -DPICKCELL_WITH_CELL=ON");
  };
}

constexpr const char* kSummary = "not in this build";

const Registration registered[] = {
    Registration({"serve", kSummary, add}), Registration({"start", kSummary, add}),
    Registration({"sim", kSummary, add}),   Registration({"camera", kSummary, add}),
    Registration({"robot", kSummary, add}),
};

}  // namespace

}  // namespace pickcell::cli
