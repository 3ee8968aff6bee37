#include "pickcell/picks/planner.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <optional>

#include "pickcell/core/units.hpp"
#include "pickcell/picks/polygon.hpp"

namespace pickcell::picks {

namespace {

using core::Base;
using core::Tool;
using poses::GraspPose;
using poses::PartPose;

template <class... Args>
std::string words(const char* format, Args... args) {
  char text[200];
  std::snprintf(text, sizeof text, format, args...);
  return text;
}

/// The best part that this one is the same as: outlines overlap and the other scores higher (ties: the earlier one).
std::optional<std::size_t> better_twin(std::span<const PartPose> parts, std::size_t i, double merge_overlap) {
  for (std::size_t j = 0; j < parts.size(); ++j) {
    if (j == i || parts[j].score < parts[i].score || (parts[j].score == parts[i].score && j > i)) continue;
    if (overlap(parts[i].outline_m, parts[j].outline_m) > merge_overlap) return j;
  }
  return std::nullopt;
}

/// An ambiguity is harmless when the grasp has it too: half a turn, a two-finger gripper, at the part's own centre.
bool grasp_shares(const GraspPose& grasp, double ambiguous_deg, const PlannerSettings& settings) {
  const bool half_turn = std::abs(std::abs(core::wrap_deg(ambiguous_deg)) - 180) < 1;
  const bool centred = grasp.T_part_tool.translation_m().head<2>().norm() < settings.grasp_tolerance_m / 2;
  return grasp.sym180 && half_turn && centred;
}

std::optional<std::string> too_uncertain(const PartPose& part, const PlannerSettings& s) {
  const double sigma_m = std::sqrt(std::max(part.covariance(0, 0), part.covariance(1, 1)));
  const double sigma_rad = std::sqrt(part.covariance(2, 2));
  if (!(s.certainty * sigma_m <= s.grasp_tolerance_m))
    return words("place known to %.2f mm only, the grasp tolerates %.2f mm", core::mm_from_m(s.certainty * sigma_m),
                 core::mm_from_m(s.grasp_tolerance_m));
  if (!(s.certainty * sigma_rad <= s.grasp_tolerance_rad))
    return words("angle known to %.2f deg only, the grasp tolerates %.2f deg",
                 core::deg_from_rad(s.certainty * sigma_rad), core::deg_from_rad(s.grasp_tolerance_rad));
  return std::nullopt;
}

std::optional<std::string> outside_box(const core::Transform<Base, Tool>& T, const char* what,
                                       const PlannerSettings& s) {
  for (const double up_m : {0.0, s.approach_m}) {
    const Eigen::Vector3d p = T.translation_m() + Eigen::Vector3d(0, 0, up_m);
    if (!s.box.contains(p))
      return words("%s at %.1f, %.1f, %.1f mm lies outside the workspace box", what, core::mm_from_m(p.x()),
                   core::mm_from_m(p.y()), core::mm_from_m(p.z()));
  }
  return std::nullopt;
}

/// The open gripper's footprint must not touch another part's outline.
bool gripper_is_clear(const GraspPose& grasp, std::size_t self, std::span<const PartPose> parts,
                      const std::vector<bool>& is_twin, const PlannerSettings& s) {
  if (s.gripper_length_m <= 0 || s.gripper_width_m <= 0) return true;
  const Eigen::Vector2d at = grasp.T_base_tool.translation_m().head<2>();
  const Eigen::Vector2d x = grasp.T_base_tool.rotation().col(0).head<2>().normalized();
  const Eigen::Vector2d y(-x.y(), x.x());
  const Eigen::Vector2d l = x * s.gripper_length_m / 2, w = y * s.gripper_width_m / 2;
  const Polygon footprint{at - l - w, at + l - w, at + l + w, at - l + w};
  for (std::size_t j = 0; j < parts.size(); ++j)
    if (j != self && !is_twin[j] && overlap(footprint, parts[j].outline_m) > 0) return false;
  return true;
}

/// Turns a symmetric grasp by half a turn where that keeps the wrist nearer to the middle of its range: the tool's X
/// axis nearest to the direction from the base to the point, for grasp and place together.
core::Transform<Base, Tool> half_turned(const core::Transform<Base, Tool>& T) {
  return T * core::Transform<Tool, Tool>(core::rotation_z(core::kPi), Eigen::Vector3d::Zero());
}

double wrist_turn(const core::Transform<Base, Tool>& T) {
  const Eigen::Vector3d x = T.rotation().col(0), p = T.translation_m();
  return std::abs(core::wrap_rad(std::atan2(x.y(), x.x()) - std::atan2(p.y(), p.x())));
}

struct Proposal {
  std::optional<Pick> pick;
  RefusalReason reason = RefusalReason::no_grasp;
  std::string why = "the model has no grasp";
};

Proposal propose(std::size_t i, std::span<const PartPose> parts, const std::vector<bool>& is_twin, const PartPlan& plan,
                 int slot, const PlannerSettings& settings) {
  const PartPose& part = parts[i];
  Proposal out;
  for (const GraspPose& grasp : part.grasps) {
    const auto unshared = std::find_if(part.ambiguous_deg.begin(), part.ambiguous_deg.end(),
                                       [&](double deg) { return !grasp_shares(grasp, deg, settings); });
    if (unshared != part.ambiguous_deg.end()) {
      out.reason = RefusalReason::ambiguous;
      out.why = words("looks the same turned by %.1f deg, and the grasp does not", *unshared);
      continue;
    }
    if (!gripper_is_clear(grasp, i, parts, is_twin, settings)) {
      out.reason = RefusalReason::clearance;
      out.why = "the gripper would touch a neighbour";
      continue;
    }
    core::Transform<Base, Tool> T_base_grasp = grasp.T_base_tool;
    core::Transform<Base, Tool> T_base_place = plan.place.slot(slot) * grasp.T_part_tool;
    // Placed upright even where the measured plane leans by a fraction of a degree: keep the tool's heading, point it
    // down.
    const Eigen::Vector3d x = T_base_place.rotation().col(0);
    const Eigen::Matrix3d down = Eigen::AngleAxisd(core::kPi, Eigen::Vector3d::UnitX()).toRotationMatrix();
    T_base_place = {core::rotation_z(std::atan2(x.y(), x.x())) * down, T_base_place.translation_m()};
    if (grasp.sym180) {
      const auto turned_grasp = half_turned(T_base_grasp), turned_place = half_turned(T_base_place);
      if (wrist_turn(turned_grasp) + wrist_turn(turned_place) < wrist_turn(T_base_grasp) + wrist_turn(T_base_place)) {
        T_base_grasp = turned_grasp;
        T_base_place = turned_place;
      }
    }
    auto fault = outside_box(T_base_grasp, "grasp", settings);
    if (!fault) fault = outside_box(T_base_place, "place", settings);
    if (fault) {
      out.reason = RefusalReason::box;
      out.why = *fault;
      continue;
    }
    out.pick = Pick{part.detection_id, part.model, plan.part_class, T_base_grasp, T_base_place, slot};
    return out;
  }
  return out;
}

}  // namespace

const char* name(RefusalReason reason) {
  switch (reason) {
    case RefusalReason::duplicate:
      return "duplicate";
    case RefusalReason::ambiguous:
      return "ambiguous";
    case RefusalReason::uncertain:
      return "uncertain";
    case RefusalReason::no_grasp:
      return "no_grasp";
    case RefusalReason::box:
      return "box";
    case RefusalReason::clearance:
      return "clearance";
    case RefusalReason::pattern_full:
      return "pattern_full";
    case RefusalReason::unknown_part:
      return "unknown_part";
  }
  return "box";
}

Plan plan_picks(std::span<const PartPose> parts, const PlannerSettings& settings,
                const std::vector<std::set<int>>& taken) {
  Plan out;
  const auto refuse = [&](const PartPose& part, RefusalReason reason, std::string why) {
    out.refusals.push_back({part.detection_id, reason, std::move(why)});
  };
  std::vector<bool> is_twin(parts.size());
  for (std::size_t i = 0; i < parts.size(); ++i) is_twin[i] = better_twin(parts, i, settings.merge_overlap).has_value();
  std::vector<std::set<int>> slots = taken;
  slots.resize(settings.parts.size());

  for (std::size_t i = 0; i < parts.size(); ++i) {
    const PartPose& part = parts[i];
    if (is_twin[i]) {
      refuse(part, RefusalReason::duplicate, "lies on a part that was found with a better score");
      continue;
    }
    const auto kind = static_cast<std::size_t>(part.model_index);
    if (part.model_index < 0 || kind >= settings.parts.size()) {
      refuse(part, RefusalReason::unknown_part, "the recipe has no place for this model");
      continue;
    }
    if (const auto why = too_uncertain(part, settings)) {
      refuse(part, RefusalReason::uncertain, *why);
      continue;
    }
    const PartPlan& plan = settings.parts[kind];
    int slot = 0;
    while (slots[kind].contains(slot)) ++slot;
    if (slot >= plan.place.size()) {
      refuse(part, RefusalReason::pattern_full, "all places of the pattern are taken");
      continue;
    }
    const Proposal proposal = propose(i, parts, is_twin, plan, slot, settings);
    if (!proposal.pick) {
      refuse(part, proposal.reason, proposal.why);
      continue;
    }
    slots[kind].insert(slot);
    out.picks.push_back(*proposal.pick);
  }
  const auto way = [](const Pick& p) {
    return (p.T_base_grasp.translation_m() - p.T_base_place.translation_m()).norm();
  };
  std::stable_sort(out.picks.begin(), out.picks.end(), [&](const Pick& a, const Pick& b) { return way(a) < way(b); });
  return out;
}

}  // namespace pickcell::picks
