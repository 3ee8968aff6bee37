#pragma once
/// Matches every picture of a set with its template and scores the outcome (docs/interfaces.md, bench).

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "pickcell/cli/bench/dataset.hpp"
#include "pickcell/cli/bench/loss.hpp"
#include "pickcell/cli/bench/score.hpp"
#include "pickcell/core/result.hpp"
#include "pickcell/matches/engine.hpp"
#include "pickcell/matches/model.hpp"

namespace pickcell::cli {

struct BenchOptions {
  std::string engine = "best";
  matches::Settings settings;
  int threads = 1;       ///< 0: all
  int every = 1;         ///< pictures 0, every, 2 * every, ... of the set's list
  bool absent = false;   ///< search each picture for a part that is not there, too
  bool explain = false;  ///< say where a search lost what it did not find
};

/// One picture, searched and scored.
struct ImageOutcome {
  std::size_t image = 0;  ///< place in Dataset::images
  ImageScore score;
  bool loose = false;                 ///< one pose asked for: found loosely (is_loose)
  std::optional<Loss> loss;           ///< with BenchOptions::explain, where one pose was not found loosely
  bool correct_at_threshold = false;  ///< correct, and no score below the model's suggested threshold
  std::optional<double>
      ms;  ///< of the second run: thread CPU time with one thread, wall time with more; pyramid included
  std::int64_t ncc_count = 0;                  ///< of all stages
  std::vector<matches::StageReport> stages{};  ///< of the timed search
  std::optional<bool> false_accept;  ///< with BenchOptions::absent, where the set allows it: something was reported
};

struct BenchRun {
  BenchOptions options;
  std::string isa;                              ///< what the engine's kernels were run with
  std::vector<double> teach_ms;                 ///< thread CPU time per template that was taught
  std::map<std::size_t, std::string> untaught;  ///< why, by the place of the template
  std::vector<double> yardstick_ms;             ///< empty when built without it
  std::vector<ImageOutcome> images;
};

/// The models of a set by the place of their template; empty where no picture of the run needs it
/// or teaching refused it. Models must not
/// move.
using Models = std::vector<std::unique_ptr<matches::Model>>;

/// Which of the set's pictures a run looks at.
[[nodiscard]] std::vector<std::size_t> chosen_images(const Dataset& set, int every);

/// A picture of another size than the set records does not belong to the recorded poses: an error.
[[nodiscard]] core::Status check_size(const std::filesystem::path& file, const std::optional<PictureSize>& stated,
                                      int width, int height);

/// Matches with models and measures the yardstick in between; load gives the pictures of the set (image::load_grey in
/// the program).
using LoadPicture = std::function<core::Result<image::Image>(const std::filesystem::path&)>;
[[nodiscard]] core::Status match_images(const Dataset& set, const Models& models, matches::Engine& engine,
                                        const LoadPicture& load, BenchRun& run);

}  // namespace pickcell::cli
