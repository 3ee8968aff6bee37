#pragma once
/// What serve and start share: run the cell of a file, with its page or for so many picks.

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include "pickcell/cli/cell/setup.hpp"
#include "pickcell/cli/subcommand.hpp"

namespace pickcell::cli {

struct CellRun {
  CellFile file;
  std::int64_t picks = 0;             ///< > 0: without a page, until so many are dealt with
  std::optional<std::string> listen;  ///< instead of the file's
  bool json = false;
  std::optional<std::filesystem::path> web_root{};  ///< the page's files, instead of the embedded ones
};

/// Whether options of the command line go together: a report is of --picks, a page is of a run without. Errors: usage.
[[nodiscard]] core::Status check_page_or_picks(std::int64_t picks, bool json, const std::string& listen,
                                               const std::string& web_root);

/// Exit code 0 when all picks were placed right (or the page was closed by Ctrl-C), 1 when not (or when a fault
/// was the picks' own), 3 when a device or link failed.
[[nodiscard]] core::Result<int> run_cell(const CellRun& run, Io& io);

}  // namespace pickcell::cli
