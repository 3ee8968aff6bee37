/// pickcell replay: a recorded run searched again by today's code.

#include <CLI/CLI.hpp>
#include <memory>
#include <ostream>

#include "pickcell/cli/replay/report.hpp"
#include "pickcell/cli/replay/run.hpp"
#include "pickcell/cli/replay/shard.hpp"
#include "pickcell/cli/subcommand.hpp"
#include "pickcell/cli/values.hpp"

namespace pickcell::cli {

namespace {

struct Options {
  std::string run, cell, shard = "1/1", threads = "all", tolerance;
  bool json = false;
};

core::Status read_tolerance(const std::string& text, Tolerance& tolerance) {
  if (text.empty()) return {};
  const auto numbers = parse_numbers("--tolerance", text);
  if (!numbers) return tl::unexpected(numbers.error());
  bool fine = numbers->size() == 3;
  for (const double v : *numbers) fine = fine && v >= 0;
  if (!fine)
    return core::failure(core::ErrorCode::usage, "--tolerance", "'" + text + "' is not three numbers of 0 and more",
                         "use px,deg,mm as in 0.05,0.05,0.05");
  tolerance.px = (*numbers)[0];
  tolerance.deg = (*numbers)[1];
  tolerance.mm = (*numbers)[2];
  return {};
}

/// A picture that cannot be read is worse than one that changed.
core::Result<int> run(const Options& options, Io& io) {
  ReplayOptions how;
  how.run = options.run;
  if (!options.cell.empty()) how.cell = options.cell;
  auto shard = parse_shard(options.shard);
  if (!shard) return core::forward(shard);
  how.shard = *shard;
  auto threads = parse_threads(options.threads);
  if (!threads) return core::forward(threads);
  how.threads = *threads;
  if (auto fine = read_tolerance(options.tolerance, how.tolerance); !fine) return core::forward(fine);
  auto done = replay(how, [&](const core::Error& error) { io.err << "pickcell: " << error.line() << "\n"; });
  if (!done) return core::forward(done);
  io.out << (options.json ? to_json(*done).dump() + "\n" : to_words(*done));
  if (done->unreadable > 0) return core::exit_code(core::ErrorCode::unreadable);
  return done->all_same() ? 0 : 1;
}

Runner add(CLI::App& app) {
  auto o = std::make_shared<Options>();
  app.add_option("RUN_DIR", o->run, "folder of a run that kept its pictures (start --record)")->required();
  app.add_option("--cell", o->cell, "models, calibration and limits of this cell, instead of the run's own")
      ->type_name("CELL.toml");
  app.add_option("--shard", o->shard, "the i-th of n shares: frames i, i+n, i+2n, ...")
      ->type_name("i/n")
      ->capture_default_str();
  app.add_option("--threads", o->threads, "number of threads, or all")->capture_default_str();
  app.add_option("--tolerance", o->tolerance, "differences up to these are none (default: 0.05,0.05,0.05)")
      ->type_name("px,deg,mm");
  app.add_flag("--json", o->json, "the figures and every change as one line of JSON");
  return [o](Io& io) { return run(*o, io); };
}

const Registration registered({"replay", "search a recorded run again: same frames, today's code, what changed", add});

}  // namespace

}  // namespace pickcell::cli
