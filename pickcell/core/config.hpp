#pragma once
/// Configuration in TOML. Every key that is asked for is known; what is left over is an error that names the nearest
/// known key. Problems are collected, so that a reader asks for all its keys and then calls finish() once.

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "pickcell/core/result.hpp"

namespace pickcell::core {

/// One table of a configuration file. Copies share state. Not thread-safe.
class Config {
 public:
  [[nodiscard]] static Result<Config> load(const std::filesystem::path& path);
  /// name: how errors call the text.
  [[nodiscard]] static Result<Config> parse(std::string_view text, std::string name);

  [[nodiscard]] bool has(std::string_view key) const;

  /// A required value. When it is missing or of another type, the problem is noted and a neutral value returned.
  /// Numbers must be finite.
  double number(std::string_view key);
  std::int64_t integer(std::string_view key);
  std::string string(std::string_view key);
  std::vector<double> numbers(std::string_view key);
  /// Rows of equal length.
  std::vector<std::vector<double>> matrix(std::string_view key);

  double number_or(std::string_view key, double otherwise);
  std::int64_t integer_or(std::string_view key, std::int64_t otherwise);
  std::string string_or(std::string_view key, std::string otherwise);
  bool boolean_or(std::string_view key, bool otherwise);
  std::vector<double> numbers_or(std::string_view key, std::vector<double> otherwise);
  std::vector<std::string> strings_or(std::string_view key, std::vector<std::string> otherwise);

  /// A sub-table; empty when missing (required values in it are then missing too).
  Config table(std::string_view key);
  std::optional<Config> table_if(std::string_view key);
  /// `[[key]]`; empty when missing.
  std::vector<Config> tables(std::string_view key);

  /// A path value: relative ones start at the file's folder.
  std::filesystem::path path(std::string_view key);
  std::optional<std::filesystem::path> path_if(std::string_view key);

  /// Notes a problem with a value that was read (out of range, contradictory).
  void problem(std::string_view key, std::string why);

  /// A required value in words, for tables with free keys: a string as it is, numbers and booleans as written in TOML,
  /// a list of these with commas between them.
  std::string text(std::string_view key);
  /// Every key in the table, known or not (for tables with free keys).
  [[nodiscard]] std::vector<std::string> keys() const;

  /// The first problem of this file: missing key, wrong type, unknown key in any table that was opened.
  [[nodiscard]] Status finish() const;

 private:
  struct File;
  struct Table;
  Config(std::shared_ptr<File> file, std::shared_ptr<Table> table);
  std::shared_ptr<File> file_;
  std::shared_ptr<Table> table_;
};

/// The candidate closest to key by edit distance, or "" when none is near.
[[nodiscard]] std::string nearest(std::string_view key, const std::vector<std::string>& candidates);

}  // namespace pickcell::core
