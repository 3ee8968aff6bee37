/// pickcell start: the demonstration cell, everything simulated but the protocols (what ./start calls).

#include <CLI/CLI.hpp>
#include <memory>
#include <optional>

#include "pickcell/cli/cell/run.hpp"
#include "pickcell/cli/cell/start_demo.hpp"
#include "pickcell/frames/open_source.hpp"

namespace pickcell::cli {

using core::ErrorCode;
using core::failure;

namespace {

struct Options {
  std::int64_t picks = 0;
  bool json = false;
  bool record = false;
  std::string cell;
  std::string robot = "tcp80";
  std::string camera = "inprocess";
  std::optional<std::int64_t> seed;
  std::string listen;
  std::string web_root;
};

core::Status check(const Options& options) {
  if (options.robot != "tcp80" && options.robot != "hses")
    return failure(ErrorCode::usage, "--robot " + options.robot, "no protocol that carries picks", "use tcp80 or hses");
  if (options.camera != "inprocess" && options.camera != "gige")
    return failure(ErrorCode::usage, "--camera " + options.camera, "is no way to a camera", "use inprocess or gige");
  if (options.camera == "gige")  // before the demonstration is calibrated, which takes a while
    if (auto can = frames::check_source("aravis:"); !can)
      return failure(ErrorCode::usage, "--camera gige", can.error().why, can.error().remedy);
  return check_page_or_picks(options.picks, options.json, options.listen, options.web_root);
}

core::Result<std::filesystem::path> demo_file(const Options& options) {
  auto folder = new_demo_folder();
  if (!folder) return folder;
  DemoOptions demo;
  demo.seed = static_cast<std::uint64_t>(options.seed.value_or(1));
  demo.calibrate = true;
  // Headless runs live on a simulated clock, whose dates those of the calibrations must fit.
  demo.now_unix_us = options.picks > 0 ? core::SimulatedClock().unix_us() : core::RealClock().unix_us();
  return prepare_demo(*folder, demo);
}

core::Result<int> run(const Options& options, Io& io) {
  if (auto known = check(options); !known) return core::forward(known);
  std::filesystem::path path = options.cell;
  if (path.empty()) {
    auto made = demo_file(options);
    if (!made) return core::forward(made);
    path = *made;
  }
  auto file = load_cell_file(path);
  if (!file) return core::forward(file);
  if (options.seed && !options.cell.empty() && file->cell.camera.source != "sim" && file->cell.robot.link != "sim")
    return failure(ErrorCode::usage, "--seed", "nothing in " + options.cell + " is simulated", "leave it out");
  if (options.seed) file->sim.seed = static_cast<std::uint64_t>(*options.seed);
  if (options.robot == "hses") file->sim.protocol = RobotProtocol::hses;
  if (options.robot != "tcp80" && file->cell.robot.link != "sim")
    return failure(ErrorCode::usage, "--robot " + options.robot, "the robot of " + options.cell + " is not simulated",
                   "say hses:// in its [robot] link");
  if (options.camera == "gige") {
    if (file->cell.camera.source != "sim")
      return failure(ErrorCode::usage, "--camera gige", "the camera of " + options.cell + " is not simulated",
                     "leave it out");
    file->sim.camera_over_gige = true;
  }
  if (options.record) file->cell.record_frames = true;
  CellRun cell_run{std::move(*file), options.picks, std::nullopt, options.json};
  if (!options.listen.empty()) cell_run.listen = options.listen;
  if (!options.web_root.empty()) cell_run.web_root = options.web_root;
  return run_cell(cell_run, io);
}

Runner add(CLI::App& app) {
  auto options = std::make_shared<Options>();
  app.add_option("--picks", options->picks, "no page: deal with N parts, report, end")
      ->check(CLI::Range(std::int64_t{1}, std::int64_t{100'000'000}));
  app.add_flag("--json", options->json, "with --picks: the report as one line of JSON");
  app.add_option("--cell", options->cell, "a cell of your own instead of the demonstration")->type_name("CELL.toml");
  app.add_option("--robot", options->robot, "protocol of the simulated controller")->type_name("tcp80|hses");
  app.add_option("--camera", options->camera, "how the simulated camera is reached")->type_name("inprocess|gige");
  app.add_option("--seed", options->seed, "of the simulated parts, light and noise")
      ->type_name("S")
      ->check(CLI::NonNegativeNumber);
  app.add_option("--listen", options->listen, "address and port of the page")->type_name("ADDR:PORT");
  app.add_option("--web-root", options->web_root, "the page from this folder, instead of the embedded one")
      ->type_name("DIR");
  app.add_flag("--record", options->record, "keep every picture with what searched it, for pickcell replay");
  return [options](Io& io) { return run(*options, io); };
}

const Registration registered({"start", "the demonstration cell, simulated, with its page at http://127.0.0.1:8080",
                               add});

}  // namespace

}  // namespace pickcell::cli
