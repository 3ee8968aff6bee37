#pragma once
/// What the commands of the Ethernet Server have in common: fields in, data or a refusal out; poses as text.

#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "pickcell/sim/controller_commands.hpp"
#include "pickcell/sim/controller_state.hpp"

namespace pickcell::sim::tcp80 {

using Fields = std::vector<std::string_view>;

/// Data of a reading command, or the refusal.
struct Outcome {
  Refusal refusal = Refusal::none;
  std::optional<std::string> data;
  Outcome(Refusal r) : refusal(r) {}                    // NOLINT: every command returns one or the other
  Outcome(std::string text) : data(std::move(text)) {}  // NOLINT
};

constexpr double kAnyPulse = 2147483647;
constexpr int kFormBits = 63, kTools = 63;

/// As printf does; at most 255 characters.
[[gnu::format(printf, 1, 2)]] [[nodiscard]] std::string format(const char* pattern, ...);
/// With commas between.
[[nodiscard]] std::string joined(const std::vector<std::string>& parts);
/// X,Y,Z,Rx,Ry,Rz in mm and degrees, from field `from` on; empty when one is no such number.
[[nodiscard]] std::optional<Cartesian> cartesian(const Fields& fields, std::size_t from);
/// The same written.
[[nodiscard]] std::string cartesian_text(const Cartesian& axis, int angle_decimals);

// Variables and contacts (docs/yaskawa-protocols 1.6). The number of fields is checked by the caller, LOADV's and
// IOWRITE's own count by themselves.
[[nodiscard]] Outcome savev(ControllerState& state, const Fields& fields);
[[nodiscard]] Outcome loadv(ControllerState& state, const Fields& fields);
[[nodiscard]] Outcome ioread(ControllerState& state, const Fields& fields);
[[nodiscard]] Outcome iowrite(ControllerState& state, const Fields& fields);

}  // namespace pickcell::sim::tcp80
