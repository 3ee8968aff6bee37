#pragma once
/// What engines did on a set of pictures, by size of the template: the tables of experiment table2.

#include <array>
#include <map>
#include <string>
#include <vector>

#include "pickcell/cli/bench/run.hpp"
#include "pickcell/cli/experiment/paper_set.hpp"
#include "pickcell/core/json.hpp"

namespace pickcell::cli {

/// One stage of all searches of a cell.
struct StageFigures {
  std::vector<double> population;  ///< by picture
  std::vector<double> ms;          ///< thread CPU time, by picture
  double ncc = 0;                  ///< correlations of the template, all pictures
  double features = 0;             ///< comparisons of feature vectors, all pictures
};

/// One engine on one size.
struct EngineFigures {
  std::vector<double> ms;  ///< of one search, its pyramid included
  int images = 0, loose = 0, correct = 0;
  std::map<std::string, StageFigures> stages;

  void add(const ImageOutcome& outcome);
  [[nodiscard]] double loose_pct() const { return images > 0 ? 100.0 * loose / images : 0; }
  [[nodiscard]] double mean_ms() const;
  [[nodiscard]] double median_ms() const;
  [[nodiscard]] double ncc() const;
};
using SizeFigures = std::array<EngineFigures, kPaperSizes.size()>;

/// A picture in which an engine did not find the target loosely.
struct Miss {
  std::string engine, image, size, kind;
  Loss loss;
};

/// Pictures of one condition, and how many of them each engine found loosely.
struct KindFigures {
  std::map<std::string, int> images, loose;  ///< by engine
};

struct PaperTable {
  std::map<std::string, SizeFigures> all;    ///< by engine
  std::map<std::string, SizeFigures> split;  ///< the first templates of each size, as many as Table I has
  std::map<std::string, KindFigures> kinds;  ///< by condition
  std::vector<Miss> misses;
  std::vector<double> yardstick_ms;
};

/// The paper's engines and ours, in the order of the tables.
constexpr std::array<const char*, 3> kPaperEngines = {"erst", "rst", "best"};

/// Searches every picture with every engine: template by template, the engines in turn, so that a machine that changes
/// its pace does so for all of them. With settings (those of the paper's engines), `best` is left out.
[[nodiscard]] core::Result<PaperTable> measure_paper_table(const Dataset& set, const matches::Settings& settings = {});

/// What the paper leaves open, as other settings have it: accuracy and ratios of the paper's engines on a set that was
/// measured as it is by default.
[[nodiscard]] core::Result<std::string> variant_table(const Dataset& set, const PaperTable& by_default);

/// Tables in Markdown: time and accuracy beside the paper's; by condition; stages; misses by stage; every miss.
[[nodiscard]] std::string time_table(std::map<std::string, SizeFigures> figures);
[[nodiscard]] std::string kind_table(const PaperTable& table);
[[nodiscard]] std::string stage_table(std::map<std::string, SizeFigures> figures);
[[nodiscard]] std::string miss_counts(const PaperTable& table);
[[nodiscard]] std::string miss_list(const PaperTable& table);
[[nodiscard]] core::Json to_json(const PaperTable& table);

}  // namespace pickcell::cli
