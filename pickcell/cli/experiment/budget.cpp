/// pickcell experiment budget: whether --budget-ms holds. Calls on pictures that need the whole search (no part is to
/// be found) at 2, 5 and 20 ms: thread CPU time within the budget + max(10 %, 0.3 ms).

#include <algorithm>
#include <cstdio>
#include <memory>
#include <ostream>
#include <random>
#include <vector>

#include "pickcell/cli/experiment/blob_scene.hpp"
#include "pickcell/cli/experiment/experiment.hpp"
#include "pickcell/core/file.hpp"
#include "pickcell/core/json.hpp"
#include "pickcell/matches/engine.hpp"
#include "pickcell/matches/work.hpp"

namespace pickcell::cli {

namespace {

constexpr double kBudgets_ms[] = {2, 5, 20};
constexpr double kDemanded = 0.999;

struct Calls {
  double budget_ms = 0;
  int calls = 0, within = 0, incomplete = 0;
  double median_ms = 0, worst_ms = 0, longest_step_ms = 0;
  [[nodiscard]] double allowed_ms() const { return budget_ms + std::max(0.1 * budget_ms, 0.3); }
  [[nodiscard]] double share() const { return static_cast<double>(within) / calls; }
};

/// Pictures in which parts of several sizes are searched for: some hold the part, some another.
struct Case {
  matches::Model model;
  image::Image picture;
};

std::vector<Case> cases(std::uint64_t seed) {
  std::mt19937_64 rng(seed);
  std::vector<Case> out;
  for (const int side : {40, 80, 140, 220})
    for (const bool there : {true, false}) {
      const BlobScene own(side, 640, 480, rng());
      const BlobScene shown = there ? own : BlobScene(side, 640, 480, rng());
      out.push_back({own.model(), BlobScene::expose(shown.draw({300.3, 200.7, 40, 1.03}), 6, rng)});
    }
  return out;
}

Calls measure(matches::Engine& engine, const std::vector<Case>& all, double budget_ms, int calls) {
  Calls result;
  result.budget_ms = budget_ms;
  image::Pyramid pyramid;
  std::vector<double> times;
  for (int i = 0; i < calls; ++i) {
    const Case& c = all[static_cast<std::size_t>(i) % all.size()];
    pyramid.build(c.picture.view());
    matches::SearchOptions options;
    options.budget_ms = budget_ms;
    const matches::Model* one[] = {&c.model};
    const double start_ms = matches::thread_cpu_ms();
    const auto found = engine.find(pyramid, one, options);
    const double ms = matches::thread_cpu_ms() - start_ms;
    if (found && !found->complete) ++result.incomplete;
    if (found) result.longest_step_ms = std::max(result.longest_step_ms, found->longest_step_ms);
    times.push_back(ms);
    ++result.calls;
    if (ms <= result.allowed_ms()) ++result.within;
  }
  std::sort(times.begin(), times.end());
  result.median_ms = times[times.size() / 2];
  result.worst_ms = times.back();
  return result;
}

core::Result<int> run(const ExperimentOptions& options, Io& io) {
  auto engine = matches::make_engine("best", {});
  if (!engine) return core::forward(engine);
  const std::vector<Case> all = cases(options.seed);
  matches::SearchOptions plain;
  image::Pyramid pyramid;
  for (const Case& c : all) {  // what is derived from a model is derived once, before the first picture
    const matches::Model* one[] = {&c.model};
    (*engine)->prepare(one, plain);
    pyramid.build(c.picture.view());
    if (auto first = (*engine)->find(pyramid, one, plain); !first) return core::forward(first);
  }
  bool held = true;
  std::string text;
  core::Json list = core::Json::array();
  for (const double budget_ms : kBudgets_ms) {
    const Calls c = measure(**engine, all, budget_ms, std::max(1, options.n.value_or(1000)));
    held = held && c.share() >= kDemanded;
    char line[200];
    std::snprintf(
        line, sizeof line,
        "budget %4.1f ms: %d of %d calls within %.2f ms (%.2f %%), median %.2f, worst %.2f ms, %d cut short; longest "
        "step %.2f ms\n",
        c.budget_ms, c.within, c.calls, c.allowed_ms(), 100 * c.share(), c.median_ms, c.worst_ms, c.incomplete,
        c.longest_step_ms);
    text += line;
    core::Json entry;
    entry.set("budget_ms", c.budget_ms).set("calls", c.calls).set("within", c.within).set("allowed_ms", c.allowed_ms());
    entry.set("median_ms", c.median_ms)
        .set("worst_ms", c.worst_ms)
        .set("incomplete", c.incomplete)
        .set("longest_step_ms", c.longest_step_ms);
    list.push(entry);
  }
  if (auto written = core::write_file_atomically(options.out / "budget.txt", text); !written)
    return core::forward(written);
  if (options.json)
    io.out << core::Json().set("budgets", list).set("held", held).dump() << "\n";
  else
    io.out << text;
  return held ? 0 : 1;
}

const ExperimentRegistration kRegistered(
    {"budget", "thread CPU time of searches under --budget-ms 2, 5 and 20 (--n calls of each, default 1000)", false,
     run});

}  // namespace

}  // namespace pickcell::cli
