/// pickcell serve CELL.toml: the cell of a file with its page, or headless for N picks.

#include <CLI/CLI.hpp>
#include <memory>

#include "pickcell/cli/cell/run.hpp"

namespace pickcell::cli {

namespace {

struct Options {
  std::string file;
  std::int64_t picks = 0;
  std::string listen;
  std::string web_root;
  bool json = false;
  bool record = false;
};

core::Result<int> run(const Options& options, Io& io) {
  if (auto fits = check_page_or_picks(options.picks, options.json, options.listen, options.web_root); !fits)
    return core::forward(fits);
  auto file = load_cell_file(options.file);
  if (!file) return core::forward(file);
  if (options.record) file->cell.record_frames = true;
  CellRun cell_run{std::move(*file), options.picks, std::nullopt, options.json};
  if (!options.listen.empty()) cell_run.listen = options.listen;
  if (!options.web_root.empty()) cell_run.web_root = options.web_root;
  return run_cell(cell_run, io);
}

Runner add(CLI::App& app) {
  auto options = std::make_shared<Options>();
  app.add_option("cell", options->file, "the cell's file")->required()->type_name("CELL.toml");
  app.add_option("--picks", options->picks, "no page: start, deal with N parts, report, end")
      ->check(CLI::Range(std::int64_t{1}, std::int64_t{100'000'000}));
  app.add_option("--listen", options->listen, "address and port of the page, instead of the file's")
      ->type_name("ADDR:PORT");
  app.add_option("--web-root", options->web_root, "the page from this folder, instead of the embedded one")
      ->type_name("DIR");
  app.add_flag("--json", options->json, "with --picks: the report as one line of JSON");
  app.add_flag("--record", options->record, "keep every picture with what searched it, for pickcell replay");
  return [options](Io& io) { return run(*options, io); };
}

const Registration registered({"serve", "run a cell: picture, match, pick, with its page", add});

}  // namespace

}  // namespace pickcell::cli
