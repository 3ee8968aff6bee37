#pragma once
/// The figures of a bench run, for people and as JSON (docs/interfaces.md, bench).

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "pickcell/cli/bench/match.hpp"
#include "pickcell/core/json.hpp"

namespace pickcell::cli {

/// Pictures of one size or kind, or all.
struct ClassFigures {
  std::string name;
  std::size_t images = 0;
  std::size_t correct = 0;
  std::size_t strict = 0;
  std::size_t loose = 0;
  double median_ms = 0;
  double mean_ms = 0;
  std::int64_t ncc_count = 0;  ///< sum over the pictures

  [[nodiscard]] double accuracy() const { return static_cast<double>(correct) / static_cast<double>(images); }
  [[nodiscard]] double loose_rate() const { return static_cast<double>(loose) / static_cast<double>(images); }
  [[nodiscard]] double strict_rate() const { return static_cast<double>(strict) / static_cast<double>(images); }
};

/// Median and 95 % of one kind of error over what was found correctly; empty when nothing was.
struct ErrorFigures {
  std::optional<double> median;
  std::optional<double> p95;
};

/// Of a set whose pictures show any number of parts.
struct InstanceFigures {
  std::size_t instances = 0;  ///< true poses
  std::size_t found = 0;
  std::size_t reported = 0;
};

struct AbsentFigures {
  std::size_t images = 0;
  std::size_t false_accepts = 0;
  double recall_at_threshold = 0;
};

struct Failure {
  std::string image;
  std::string why;
  std::optional<Loss> loss;
};

struct BenchReport {
  std::string dataset;
  std::string engine;
  int threads = 1;
  std::string isa;
  bool loose = false;  ///< loose figures exist: one pose per picture
  ClassFigures all;
  double p95_ms = 0;
  std::optional<double> teach_ms;  ///< median per template
  ErrorFigures px;
  ErrorFigures deg;
  ErrorFigures scale_pct;
  std::optional<double> yardstick_ms;
  std::vector<ClassFigures> by_size;
  std::vector<ClassFigures> by_kind;
  std::vector<Failure> failures;
  std::optional<InstanceFigures> instances;
  std::optional<AbsentFigures> absent;
};

[[nodiscard]] BenchReport summarise(const Dataset& set, const BenchRun& run);

/// One object with the documented keys; figures that do not exist are null.
[[nodiscard]] core::Json to_json(const BenchReport& report);

/// A table for people, several lines.
[[nodiscard]] std::string to_table(const BenchReport& report);

}  // namespace pickcell::cli
