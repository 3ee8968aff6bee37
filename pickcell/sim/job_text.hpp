#pragma once
/// Small readers for INFORM text: words, numbers, variables, conditions. Every function takes the whole word and says
/// no instead of reading a part of it.

#include <optional>
#include <string_view>
#include <vector>

#include "pickcell/sim/job_program.hpp"

namespace pickcell::sim::job_text {

[[nodiscard]] std::vector<std::string_view> words(std::string_view line);
[[nodiscard]] std::optional<double> number(std::string_view word);
[[nodiscard]] std::optional<int> whole(std::string_view word);
/// `V=100.0` with key "V".
[[nodiscard]] std::optional<double> setting(std::string_view word, std::string_view key);
/// B012, P021, C00000, IN#(1), OT#(1), ON, OFF, "text", -12.5.
[[nodiscard]] std::optional<Operand> operand(std::string_view word);
/// `B010=1`, `I021 > I011 AND IN#(1)=ON`.
[[nodiscard]] std::optional<Condition> condition(std::string_view text);
/// `(3)`.
[[nodiscard]] std::optional<int> bracketed(std::string_view word);
/// `300.000,0.000,250.000,180.0000,0.0000,0.0000` with the given decimals per place.
[[nodiscard]] std::optional<std::array<std::int32_t, 6>> six(std::string_view text, int decimals_xyz,
                                                             int decimals_rxyz);
[[nodiscard]] bool job_name(std::string_view name);

}  // namespace pickcell::sim::job_text
