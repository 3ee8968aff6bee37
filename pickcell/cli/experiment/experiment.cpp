/// pickcell experiment: what a document claims, measured again by a command.

#include "pickcell/cli/experiment/experiment.hpp"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <memory>
#include <system_error>

#include "pickcell/core/config.hpp"

namespace pickcell::cli {

using core::ErrorCode;
using core::failure;

namespace {

std::vector<Experiment>& registry() {
  static std::vector<Experiment> all;
  return all;
}

struct Options {
  std::string name;
  std::string photos;
  ExperimentOptions experiment;
};

core::Result<Experiment> known(const std::string& name) {
  std::vector<std::string> names;
  std::string list;
  for (const Experiment& e : experiments()) {
    if (e.name == name) return e;
    names.push_back(e.name);
    list += (list.empty() ? "" : ", ") + e.name;
  }
  const std::string near = core::nearest(name, names);
  return failure(ErrorCode::usage, "experiment " + name, "there is no such experiment",
                 near.empty() ? "known: " + list : "did you mean '" + near + "'?");
}

core::Result<int> run(const Options& options, Io& io) {
  auto experiment = known(options.name);
  if (!experiment) return core::forward(experiment);
  ExperimentOptions own = options.experiment;
  if (!options.photos.empty()) {
    if (!experiment->uses_photos)
      return failure(ErrorCode::usage, "--photos", "the experiment " + options.name + " uses none", "leave it out");
    if (!std::filesystem::is_directory(options.photos))
      return failure(ErrorCode::usage, options.photos, "is no folder", "name a folder of pictures");
    own.photos = options.photos;
  }
  std::error_code problem;
  std::filesystem::create_directories(own.out, problem);
  if (problem)
    return failure(ErrorCode::unreadable, own.out.string(), "cannot be made: " + problem.message(),
                   "name a folder that can be written");
  return experiment->run(own, io);
}

Runner add(CLI::App& app) {
  auto options = std::make_shared<Options>();
  std::string list = "which one:";
  for (const Experiment& e : experiments()) list += "\n" + e.name + ": " + e.summary;
  app.add_option("name", options->name, list)->required()->type_name("NAME");
  app.add_option("--out", options->experiment.out, "tables, plots and pictures go there")->required()->type_name("DIR");
  app.add_option("--photos", options->photos, "own photographs instead of rendered pictures")->type_name("DIR");
  app.add_option("--n", options->experiment.n, "how many")->check(CLI::Range(1, 100'000'000));
  app.add_option("--seed", options->experiment.seed, "of everything random")->type_name("S");
  app.add_flag("--json", options->experiment.json, "the figures as one line of JSON");
  return [options](Io& io) { return run(*options, io); };
}

const Registration registered({"experiment", "measure again what the documents claim", add});

}  // namespace

ExperimentRegistration::ExperimentRegistration(Experiment experiment) { registry().push_back(std::move(experiment)); }

std::vector<Experiment> experiments() {
  std::vector<Experiment> out = registry();
  std::sort(out.begin(), out.end(), [](const auto& a, const auto& b) { return a.name < b.name; });
  return out;
}

}  // namespace pickcell::cli
