#include "pickcell/matches/engine.hpp"

#include "pickcell/core/config.hpp"
#include "pickcell/matches/best_engine.hpp"

namespace pickcell::matches {

core::Result<std::unique_ptr<Engine>> make_engine(std::string_view name, const Settings& settings) {
  if (name == "best") {
    auto parsed = parse_best_settings(settings);
    if (!parsed) return core::forward(parsed);
    return std::unique_ptr<Engine>(std::make_unique<BestEngine>(*parsed));
  }
  const std::string what = "engine " + std::string(name);
  if (name == "rst" || name == "erst")
    return core::failure(core::ErrorCode::usage, what, "it is not built yet", "use --engine best");
  return core::failure(core::ErrorCode::usage, what, "there is no such engine", "known engines: best");
}

}  // namespace pickcell::matches
