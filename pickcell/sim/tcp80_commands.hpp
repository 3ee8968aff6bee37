#pragma once
/// The commands of the Ethernet Server (docs/yaskawa-protocols 1.3-1.6) on a controller state: operands in, answer out.
/// Pure text, no sockets.

#include <string>
#include <string_view>

#include "pickcell/sim/controller_state.hpp"

namespace pickcell::sim {

/// How an answer ends on the wire (section 1.2).
struct Tcp80Answer {
  enum class Kind { accepted, error, data };
  Kind kind = Kind::data;
  std::string text;  ///< without its line end
  /// CRLF after 0000 and ERROR, CR alone after data.
  [[nodiscard]] std::string bytes() const;
};

/// Carries out one command. `operands` as they came, with or without their CR; blanks around fields do not matter.
/// Commands that the reference marks as not certain (PMOVL, JWAIT, RGROUP, RUFRAME, WUFRAME, CGROUP, CTASK, CVTRJ,
/// CVTSJ) are refused as unknown, 1010.
[[nodiscard]] Tcp80Answer execute_tcp80(ControllerState& state, std::string_view command, std::string_view operands);

/// One that is carried out, as opposed to refused as unknown.
[[nodiscard]] bool is_tcp80_command(std::string_view name);

}  // namespace pickcell::sim
