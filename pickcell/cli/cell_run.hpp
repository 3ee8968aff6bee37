#pragma once
/// What serve and start share: run the cell of a file, with its page or for so many picks.

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include "pickcell/cli/cell_setup.hpp"
#include "pickcell/cli/subcommand.hpp"

namespace pickcell::cli {

struct CellRun {
  CellFile file;
  std::int64_t picks = 0;             ///< > 0: without a page, until so many are dealt with
  std::optional<std::string> listen;  ///< instead of the file's
  bool json = false;
  std::optional<std::filesystem::path> web_root{};  ///< the page's files, instead of the embedded ones
};

/// Exit code 0 when all picks were placed right (or the page was closed by Ctrl-C), 1 when not, 3 when the cell is in
/// fault.
[[nodiscard]] core::Result<int> run_cell(const CellRun& run, Io& io);

}  // namespace pickcell::cli
