#pragma once
/// pickcell ARGS... as a user runs it, with what it says as JSON.

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <optional>
#include <sstream>
#include <string>
#include <vector>

#include "pickcell/cli/subcommand.hpp"
#include "pickcell/core/json.hpp"

namespace pickcell {

struct Said {
  int code = 0;
  core::Json json;
  std::string err;
};

inline Said pickcell(std::vector<std::string> args) {
  std::ostringstream out, err;
  Said said;
  said.code = cli::run(std::move(args), {out, err});
  said.err = err.str();
  if (auto parsed = core::parse_json(out.str(), "stdout")) said.json = std::move(*parsed);
  return said;
}

/// A data set that is not shipped: PICKCELL_DATA, or shared/data beside the checkout; nothing when it is not there.
inline std::optional<std::filesystem::path> shared_data(const std::string& set) {
  const char* named = std::getenv("PICKCELL_DATA");
  const std::filesystem::path root =
      named ? std::filesystem::path(named) : std::filesystem::path(PICKCELL_SOURCE_DIR) / "../shared/data";
  if (std::filesystem::exists(root / set)) return root / set;
  return std::nullopt;
}

inline std::string say_failures(const core::Json& report) {
  std::string out;
  for (const core::Json& f : report["failures"].items()) out += f["image"].string() + ": " + f["why"].string() + "\n";
  return out;
}

}  // namespace pickcell
