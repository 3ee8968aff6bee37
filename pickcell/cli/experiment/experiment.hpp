#pragma once
/// `pickcell experiment NAME`: each experiment is a .cpp of this folder that registers itself, as subcommands do. It
/// prints its table on Io::out (or one line of JSON), writes tables, plots and pictures into the given folder, and
/// prints every figure that a document of the project quotes.

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "pickcell/cli/subcommand.hpp"
#include "pickcell/core/result.hpp"

namespace pickcell::cli {

struct ExperimentOptions {
  std::filesystem::path out;  ///< exists and is writable when the experiment begins
  std::optional<std::filesystem::path> photos;
  std::optional<int> n;  ///< how many, in the experiment's own unit; each has its default
  std::uint64_t seed = 1;
  bool json = false;
};

struct Experiment {
  std::string name;
  std::string summary;  ///< one line for --help, with what --n counts
  bool uses_photos = false;
  /// The exit code: 0 done, 1 what it is there to show does not hold.
  core::Result<int> (*run)(const ExperimentOptions& options, Io& io) = nullptr;
};

/// A static object of this type makes the experiment known. Before main() only.
class ExperimentRegistration {
 public:
  explicit ExperimentRegistration(Experiment experiment);
};

/// Sorted by name.
[[nodiscard]] std::vector<Experiment> experiments();

}  // namespace pickcell::cli
