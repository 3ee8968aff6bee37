/// What the paper leaves open, as other settings of its engines have it.

#include <array>
#include <cstdio>

#include "pickcell/cli/experiment/paper_table.hpp"

namespace pickcell::cli {
namespace {

struct Variant {
  const char* words;
  matches::Settings settings;  ///< empty: as it is by default
};

std::string percent(int part, int of) {
  char out[16];
  std::snprintf(out, sizeof out, "%.1f", of > 0 ? 100.0 * part / of : 0);
  return out;
}

/// Loosely found of the pictures without a disturbance, and of all.
std::string found(const PaperTable& table, const char* engine) {
  int images = 0, loose = 0;
  for (const auto& [name, kind] : table.kinds) {
    images += kind.images.at(engine);
    loose += kind.loose.at(engine);
  }
  const auto clean = table.kinds.find("clean");
  const std::string of_clean =
      clean == table.kinds.end() ? "-" : percent(clean->second.loose.at(engine), clean->second.images.at(engine));
  return of_clean + ", " + percent(loose, images);
}

std::string row(const std::string& words, const PaperTable& table) {
  std::string out = "| " + words + " | " + found(table, "erst") + " | " + found(table, "rst");
  for (std::size_t s = 0; s < kPaperSizes.size(); ++s) {
    const EngineFigures &e = table.all.at("erst")[s], &r = table.all.at("rst")[s];
    char times[48] = "-";
    if (r.images > 0 && r.mean_ms() > 0)
      std::snprintf(times, sizeof times, "%.1f (%.1f)", e.mean_ms() / r.mean_ms(), e.median_ms() / r.median_ms());
    out += " | " + std::string(times);
  }
  return out + " |\n";
}

}  // namespace

core::Result<std::string> variant_table(const Dataset& set, const PaperTable& by_default) {
  const std::array<Variant, 4> variants = {{{"by default: pyramid=binomial, smooth=1, location=halving", {}},
                                            {"smooth=0", {{"smooth", "0"}}},
                                            {"smooth=0, pyramid=box", {{"smooth", "0"}, {"pyramid", "box"}}},
                                            {"location=quadrant", {{"location", "quadrant"}}}}};
  std::string out =
      "| settings | found loosely, clean and all pictures: e-RST % | RST % | e-RST/RST, mean times (medians): small | "
      "medium | large |\n|---|---|---|---|---|---|\n";
  for (const Variant& v : variants) {
    if (v.settings.empty()) {
      out += row(v.words, by_default);
      continue;
    }
    auto table = measure_paper_table(set, v.settings);
    if (!table) return core::forward(table);
    out += row(v.words, *table);
  }
  return out + "\n";
}

}  // namespace pickcell::cli
