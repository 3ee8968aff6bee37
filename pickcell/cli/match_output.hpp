#pragma once
/// What `pickcell match` says about a picture (docs/interfaces.md, match --json).

#include <iosfwd>
#include <string>

#include "pickcell/core/json.hpp"
#include "pickcell/matches/engine.hpp"

namespace pickcell::cli {

struct MatchedPicture {
  std::string file;
  int width = 0;
  int height = 0;
  std::string engine;
  double time_ms = 0;  ///< wall time of matching alone
  const matches::FindResult& found;
};

/// explain: with what was rejected and the stages' figures.
[[nodiscard]] core::Json to_json(const MatchedPicture& picture, bool explain);
void print_words(const MatchedPicture& picture, bool explain, std::ostream& out);

}  // namespace pickcell::cli
