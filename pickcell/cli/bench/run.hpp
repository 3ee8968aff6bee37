#pragma once
/// A whole bench run: engine, teaching, matching (docs/interfaces.md, bench).

#include "pickcell/cli/bench/match.hpp"

namespace pickcell::cli {

/// Teaches the templates that the run needs: all angles, the set's scale range, the mask where there is one. The times
/// go into run.
[[nodiscard]] core::Result<Models> teach_templates(const Dataset& set, BenchRun& run);

[[nodiscard]] core::Result<BenchRun> run_bench(const Dataset& set, const BenchOptions& options);

}  // namespace pickcell::cli
