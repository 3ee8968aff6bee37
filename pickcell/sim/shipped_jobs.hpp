#pragma once
/// Job texts that a simulated controller holds when it is switched on.

#include <string>
#include <vector>

namespace pickcell::sim {

/// VISPICK (docs/inform/VISPICK.JBI, built in), TEST1 and TEST2 (NOP and END only).
[[nodiscard]] std::vector<std::string> shipped_jobs();

}  // namespace pickcell::sim
