#pragma once
/// The files that made a cell what it was: cell file, models, calibration. A run whose pictures are kept keeps copies
/// of them, so that it can be searched again when they have changed or are gone.

#include <filesystem>
#include <string>
#include <vector>

#include "pickcell/cell/cell_config.hpp"
#include "pickcell/core/config.hpp"
#include "pickcell/core/result.hpp"

namespace pickcell::cell {

struct KeptFiles {
  std::filesystem::path cell;
  std::vector<std::filesystem::path> models;  ///< in the order of the recipe
  std::filesystem::path camera;
  std::filesystem::path plane;    ///< empty with handeye
  std::filesystem::path handeye;  ///< empty with plane
};

/// Those that the cell reads now.
[[nodiscard]] KeptFiles files_of(const CellConfig& config);

/// Copies them into RUN/cell, which is made, and returns what run.toml says of them: the table [kept], paths from the
/// run's folder. Errors: unreadable: a file that cannot be read or written.
[[nodiscard]] core::Result<std::string> keep_files(const std::filesystem::path& run, const KeptFiles& files);

/// Reads the table [kept]. Paths that lead out of the run's folder are noted as problems of their file.
[[nodiscard]] KeptFiles read_kept(core::Config table, const std::filesystem::path& run);

/// A cell that reads the kept files instead of its own. Errors: unreadable: another number of models than the cell has
/// parts.
[[nodiscard]] core::Status read_from(CellConfig& config, const KeptFiles& files);

}  // namespace pickcell::cell
