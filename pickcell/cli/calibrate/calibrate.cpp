/// pickcell calibrate: lens, work plane, hand-eye, and whether they still hold.

#include "pickcell/cli/calibrate/calibrate.hpp"

#include <CLI/CLI.hpp>
#include <memory>

namespace pickcell::cli {

namespace {

struct Mode {
  const char* name;
  const char* summary;
  Runner (*add)(CLI::App& app);
};

Runner add(CLI::App& app) {
  static constexpr Mode kModes[] = {
      {"camera", "the lens, from pictures of a board", add_calibrate_camera},
      {"plane", "a fixed camera over a work plane, from touched points", add_calibrate_plane},
      {"handeye", "camera and arm, from pictures and arm poses", add_calibrate_handeye},
      {"verify", "whether a camera still stands where it was calibrated", add_calibrate_verify},
  };
  auto chosen = std::make_shared<Runner>();
  app.require_subcommand(1);
  for (const Mode& mode : kModes) {
    CLI::App* sub = app.add_subcommand(mode.name, mode.summary);
    sub->final_callback([chosen, runner = mode.add(*sub)] { *chosen = runner; });
  }
  return [chosen](Io& io) { return (*chosen)(io); };
}

const Registration registered({"calibrate", "lens, work plane, hand-eye: from pixels to millimetres", add});

}  // namespace

}  // namespace pickcell::cli
