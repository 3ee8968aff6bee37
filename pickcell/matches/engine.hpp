#pragma once
/// The seam of all matchers: best (default), and the paper's rst and erst.

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "pickcell/core/result.hpp"
#include "pickcell/image/pyramid.hpp"
#include "pickcell/matches/match.hpp"
#include "pickcell/matches/model.hpp"

namespace pickcell::matches {

/// What to look for in one picture. Unset values come from the model.
struct SearchOptions {
  /// Engine best answers at most the tolerances of limits.hpp beyond these: 0.5 degrees and 0.5 %, of a range of one
  /// value 2 degrees and 2 %.
  std::optional<Range> angle_deg;
  std::optional<Range> scale;
  int max_matches = 1;              ///< best first; over all models together when there are several
  std::optional<double> min_score;  ///< 0: no threshold
  double max_overlap = 0.3;         ///< of rotated rectangles: intersection over the smaller area
  std::optional<double> budget_ms;  ///< thread CPU time; what was found so far is returned
  int threads = 1;                  ///< 0: all
  bool explain = false;             ///< fill FindResult::rejected
  /// With explain: candidates near this pose are reported before others (rst, erst: also what step 1 saw there).
  std::optional<Pose2d> watch;
  struct Roi {
    int x, y, w, h;
  };
  std::optional<Roi> roi;  ///< centres are searched in this part of the picture only
};

/// Work done by one stage, for tests and --explain.
struct StageReport {
  std::string stage;
  std::int64_t population = 0;  ///< candidates that entered
  std::int64_t survivors = 0;
  std::int64_t ncc_count = 0;      ///< correlations of the template with the picture
  double ms = 0;                   ///< CPU time of the calling thread
  std::int64_t feature_count = 0;  ///< comparisons of short feature vectors (rst, erst: circles, lines)
};

struct FindResult {
  std::vector<Match> matches;      ///< sorted by score, best first
  std::vector<Rejected> rejected;  ///< with SearchOptions::explain
  std::vector<StageReport> stages;
  bool complete = true;        ///< false when the budget cut the search
  double longest_step_ms = 0;  ///< with a budget: the longest time that was not looked at the clock
};

class Engine {
 public:
  virtual ~Engine() = default;
  /// Finds every model in the picture that the pyramid was built from. Derived data of a model is cached in the engine
  /// under the model's address: a model must stay alive and unchanged while the engine is used with it. One thread at a
  /// time.
  [[nodiscard]] virtual core::Result<FindResult> find(const image::Pyramid& scene, std::span<const Model* const> models,
                                                      const SearchOptions& options) = 0;
  /// The same into a result whose memory is used again. Engine `best` then takes nothing from the heap once it has
  /// searched a picture of this size for these models with one thread and without explain.
  [[nodiscard]] virtual core::Status find_into(const image::Pyramid& scene, std::span<const Model* const> models,
                                               const SearchOptions& options, FindResult& result) {
    auto found = find(scene, models, options);
    if (!found) return core::forward(found);
    result = std::move(*found);
    return {};
  }
  /// Derives now what find would derive from the models on first use, so that the first picture takes no longer than
  /// the others. Optional. Errors are left to find.
  virtual void prepare(std::span<const Model* const> models, const SearchOptions& options) {
    static_cast<void>(models);
    static_cast<void>(options);
  }
  [[nodiscard]] virtual std::string name() const = 0;
  /// The SIMD target that its kernels run with on this machine, in lower case ("avx2"); "baseline": the one it was
  /// compiled for.
  [[nodiscard]] virtual std::string isa() const { return "baseline"; }
};

/// KEY=VALUE settings of an engine (--set, --params); every key must be known to the engine.
using Settings = std::map<std::string, std::string>;

/// name: "best", "rst" or "erst". Unknown names and unknown or malformed settings are usage errors that name the known
/// ones.
[[nodiscard]] core::Result<std::unique_ptr<Engine>> make_engine(std::string_view name, const Settings& settings);

}  // namespace pickcell::matches
