#pragma once
/// What a replay found (docs/interfaces.md, replay).

#include <string>

#include "pickcell/cli/replay/run.hpp"
#include "pickcell/core/json.hpp"

namespace pickcell::cli {

/// One object with the documented keys; figures that do not exist are null.
[[nodiscard]] core::Json to_json(const Replay& replay);

/// For people: the figures, then what changed, worst first.
[[nodiscard]] std::string to_words(const Replay& replay);

}  // namespace pickcell::cli
