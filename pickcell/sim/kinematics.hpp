#pragma once
/// Where the flange is for given joints, and back, in closed form for arms with a spherical wrist.

#include <optional>
#include <vector>

#include "pickcell/core/transform.hpp"
#include "pickcell/sim/arm.hpp"

namespace pickcell::sim {

using FlangePose = core::Transform<core::Base, core::Flange>;

/// Which of the ways to reach a pose. Bits as over TCP port 80 (docs/yaskawa-protocols 1.5); what counts as flip, elbow
/// below and back is the rule recalled from the manuals (R within +-90 is flip), not confirmed on a controller.
struct Form {
  bool no_flip = false;      ///< bit 0: R beyond +-90
  bool elbow_below = false;  ///< bit 1: U beyond the stretched arm
  bool back = false;         ///< bit 2: wrist behind the S axis
  bool r_180 = false;        ///< bit 3: R outside (-180, 180]
  bool t_180 = false;        ///< bit 4
  bool s_180 = false;        ///< bit 5

  [[nodiscard]] int bits() const;
  static Form from_bits(int bits);
  bool operator==(const Form&) const = default;
};

[[nodiscard]] FlangePose forward(const Arm& arm, const Joints& q);

[[nodiscard]] Form form_of(const Arm& arm, const Joints& q);

/// Up to eight ways to reach the pose, every angle the equivalent nearest to `near`, limits not yet looked at; empty
/// when out of reach. With the wrist stretched (R and T in line) R keeps the value it has in `near`.
[[nodiscard]] std::vector<Joints> inverse(const Arm& arm, const FlangePose& T_base_flange, const Joints& near);

/// The way with that form inside the limits; where two remain (T at +-190), the one nearest to `near`. Empty when out
/// of reach, against the limits, or not to be had in that form.
[[nodiscard]] std::optional<Joints> inverse_in_form(const Arm& arm, const FlangePose& T_base_flange, Form form,
                                                    const Joints& near);

/// The continuation of a path: same flip, elbow and front/back as `near`, angles nearest to it, turns as they come.
/// Limits are the caller's to check. Empty when out of reach.
[[nodiscard]] std::optional<Joints> inverse_continuing(const Arm& arm, const FlangePose& T_base_flange,
                                                       const Joints& near);

}  // namespace pickcell::sim
