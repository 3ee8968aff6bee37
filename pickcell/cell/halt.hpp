#pragma once
/// Why the cell stops working: how its inner steps end when they cannot go on.

#include <string>
#include <tl/expected.hpp>

#include "pickcell/cell/cell_port.hpp"
#include "pickcell/cell/robot_watch.hpp"
#include "pickcell/core/result.hpp"

namespace pickcell::cell {

struct Halt {
  Mode next = Mode::fault;  ///< idle: nothing is wrong, a person may just press Start again
  std::string code;         ///< "LINK_LOST", "OPERATOR", "PICK_TIMEOUT", ...
  std::string why;
  std::string remedy;
  bool person_must_look = false;  ///< the next Reset says that somebody has looked at the arm and its gripper
};

/// A value, or the reason to stop.
template <class T>
using Or = tl::expected<T, Halt>;

[[nodiscard]] inline tl::unexpected<Halt> fault(std::string code, std::string why, std::string remedy) {
  return tl::unexpected(Halt{Mode::fault, std::move(code), std::move(why), std::move(remedy), false});
}

[[nodiscard]] inline tl::unexpected<Halt> stand(std::string code, std::string why, std::string remedy = {}) {
  return tl::unexpected(Halt{Mode::idle, std::move(code), std::move(why), std::move(remedy), false});
}

/// doing: "picking bracket": begins the sentence.
[[nodiscard]] Halt halt_from(const core::Error& error, const std::string& doing);
[[nodiscard]] Halt halt_from(const Hindrance& hindrance);

}  // namespace pickcell::cell
