#pragma once
/// Values of options that several commands share. All errors are usage errors that name the option.

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "pickcell/core/result.hpp"
#include "pickcell/matches/engine.hpp"
#include "pickcell/matches/model.hpp"

namespace pickcell::cli {

/// Comma-separated finite numbers, `1,-2.5`.
[[nodiscard]] core::Result<std::vector<double>> parse_numbers(const std::string& option, const std::string& text);
/// The same, least..most of them.
[[nodiscard]] core::Result<std::vector<double>> parse_numbers(const std::string& option, const std::string& text,
                                                              std::size_t least, std::size_t most);

/// `lo,hi` with lo <= hi.
[[nodiscard]] core::Result<matches::Range> parse_range(const std::string& option, const std::string& text);

/// Value of --threads: `all` (0 in the answer: as many as the machine has) or 1 to 1024.
[[nodiscard]] core::Result<int> parse_threads(const std::string& text);

/// `x,y,w,h`, whole numbers, w and h at least 1.
[[nodiscard]] core::Result<matches::SearchOptions::Roi> parse_roi(const std::string& option, const std::string& text);

/// Engine settings from a TOML file (--params, "" for none) and KEY=VALUE (--set), which win.
[[nodiscard]] core::Result<matches::Settings> parse_settings(const std::vector<std::string>& key_values,
                                                             const std::string& params_file);

/// Refuses an output file that is one of the inputs (empty ones are left out): a command never overwrites what it
/// reads.
[[nodiscard]] core::Status check_not_input(const std::filesystem::path& output, const std::vector<std::string>& inputs);

}  // namespace pickcell::cli
