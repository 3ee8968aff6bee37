#include "pickcell/matches/engine.hpp"

#include "pickcell/core/config.hpp"
#include "pickcell/matches/best/engine.hpp"
#include "pickcell/matches/rst/engine.hpp"

namespace pickcell::matches {

core::Result<std::unique_ptr<Engine>> make_engine(std::string_view name, const Settings& settings) {
  if (name == "best") {
    auto parsed = parse_best_settings(settings);
    if (!parsed) return core::forward(parsed);
    return std::unique_ptr<Engine>(std::make_unique<BestEngine>(*parsed));
  }
  if (name == "rst" || name == "erst") {
    auto parsed = parse_rst_settings(settings, name);
    if (!parsed) return core::forward(parsed);
    const RstVariant variant = name == "rst" ? RstVariant::rst : RstVariant::erst;
    return std::unique_ptr<Engine>(std::make_unique<RstEngine>(variant, std::move(*parsed)));
  }
  return core::failure(core::ErrorCode::usage, "engine " + std::string(name), "there is no such engine",
                       "known engines: best, rst, erst");
}

}  // namespace pickcell::matches
