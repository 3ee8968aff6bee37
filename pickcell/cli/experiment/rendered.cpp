/// pickcell experiment rendered: data sets for `pickcell bench` with exact truth, rendered from the project's own
/// parts.

#include <ostream>

#include "pickcell/cli/experiment/experiment.hpp"
#include "pickcell/core/json.hpp"
#include "pickcell/sim/rendered_set.hpp"

namespace pickcell::cli {

namespace {

core::Result<int> run(const ExperimentOptions& options, Io& io) {
  const std::filesystem::path one = options.out / "one", several = options.out / "several";
  const int pictures = options.n.value_or(75);
  if (auto done = sim::write_rendered_set(one, options.seed, pictures); !done) return core::forward(done);
  if (auto done = sim::write_rendered_multi_set(several, options.seed, (pictures + 2) / 3); !done)
    return core::forward(done);
  if (options.json) {
    core::Json report = core::Json::object();
    report.set("one", one.string()).set("several", several.string());
    io.out << report.set("seed", static_cast<std::int64_t>(options.seed)).dump() << "\n";
  } else {
    io.out << "search them with: pickcell bench " << one.string() << " (one part in each picture), pickcell bench "
           << several.string() << " (two to seven, or none)\n";
  }
  return 0;
}

const ExperimentRegistration registered({"rendered",
                                         "sets of pictures with exact truth for 'pickcell bench', written below DIR; "
                                         "--n: pictures with one part (default 75), a third as many with several",
                                         false, run});

}  // namespace

}  // namespace pickcell::cli
