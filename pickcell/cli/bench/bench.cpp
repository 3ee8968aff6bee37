/// `pickcell bench`: a whole set of pictures with known poses, timed and judged (docs/interfaces.md, bench).

#include <CLI/CLI.hpp>
#include <memory>
#include <ostream>

#include "pickcell/cli/bench/plots.hpp"
#include "pickcell/cli/bench/report.hpp"
#include "pickcell/cli/bench/run.hpp"
#include "pickcell/cli/subcommand.hpp"
#include "pickcell/cli/values.hpp"
#include "pickcell/cli/yardstick.hpp"
#include "pickcell/core/file.hpp"

namespace pickcell::cli {

namespace {

struct BenchArguments {
  std::string dataset;
  BenchOptions options;
  std::string threads = "1";
  std::vector<std::string> settings;
  std::string params_file;
  bool json = false;
  std::string json_file;  ///< empty: stdout
  std::string plots_folder;
};

/// `bench --json SET` reads as if SET were the file: a folder cannot be one.
void sort_out_positions(BenchArguments& arguments) {
  std::error_code ignored;
  if (arguments.dataset.empty() && std::filesystem::is_directory(arguments.json_file, ignored))
    std::swap(arguments.dataset, arguments.json_file);
}

void warn_of_slow_yardstick(const BenchReport& report, std::ostream& err) {
  if (!report.yardstick_ms)
    err << "pickcell: yardstick: built without OpenCV; configure with -DPICKCELL_WITH_YARDSTICK=ON for times in "
           "yardsticks\n";
  else if (*report.yardstick_ms > kSlowYardstickMs)
    err << "pickcell: yardstick: " << *report.yardstick_ms << " ms is above " << kSlowYardstickMs
        << " ms; times mean little on a busy machine, run again when it is quiet\n";
}

core::Status write_report(const BenchArguments& arguments, const BenchReport& report, std::ostream& out) {
  const std::string json = to_json(report).dump() + "\n";
  if (arguments.json && arguments.json_file.empty()) {
    out << json;
    return {};
  }
  out << to_table(report);
  return arguments.json ? core::write_file_atomically(arguments.json_file, json) : core::Status{};
}

core::Result<int> bench(BenchArguments arguments, Io& io) {
  keep_freed_memory();
  sort_out_positions(arguments);
  if (arguments.dataset.empty())
    return core::failure(core::ErrorCode::usage, "bench", "no data set given", "see 'pickcell bench --help'");
  auto settings = parse_settings(arguments.settings, arguments.params_file);
  if (!settings) return core::forward(settings);
  arguments.options.settings = std::move(*settings);
  auto threads = parse_threads(arguments.threads);
  if (!threads) return core::forward(threads);
  arguments.options.threads = *threads;
  auto set = load_dataset(arguments.dataset);
  if (!set) return core::forward(set);
  auto run = run_bench(*set, arguments.options);
  if (!run) return core::forward(run);
  const BenchReport report = summarise(*set, *run);
  warn_of_slow_yardstick(report, io.err);
  if (auto written = write_report(arguments, report, io.out); !written) return core::forward(written);
  if (!arguments.plots_folder.empty())
    if (auto drawn = write_plots(arguments.plots_folder, bench_plots(*set, *run, report)); !drawn)
      return core::forward(drawn);
  return 0;
}

Runner add_bench(CLI::App& app) {
  auto arguments = std::make_shared<BenchArguments>();
  BenchOptions& options = arguments->options;
  app.add_option("dataset", arguments->dataset, "folder with truth.json, templates/ and images/");
  app.add_option("--engine", options.engine, "best (default), rst or erst");
  app.add_option("--threads", arguments->threads, "threads of one search, or all")->capture_default_str();
  app.add_option("--every", options.every, "only the pictures 0, K, 2K, ... of the set's list")
      ->check(CLI::Range(1, 1 << 30));
  app.add_flag("--absent", options.absent, "also search each picture for a part that is not in it");
  app.add_flag("--explain", options.explain, "name the stage that lost each part that was not found");
  app.add_option("--set", arguments->settings, "KEY=VALUE, a setting of the engine")->allow_extra_args(false);
  app.add_option("--params", arguments->params_file, "TOML file with settings of the engine");
  CLI::Option* json = app.add_option("--json", arguments->json_file, "JSON on stdout, or into a file")->expected(0, 1);
  app.add_option("--plots", arguments->plots_folder, "folder for plots (SVG)");
  return [arguments, json](Io& io) {
    arguments->json = json->count() > 0;
    return bench(*arguments, io);
  };
}

const Registration kRegistered({"bench", "accuracy and speed on a set of pictures with known poses", add_bench});

}  // namespace

}  // namespace pickcell::cli
