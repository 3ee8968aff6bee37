#include "pickcell/sim/world.hpp"

#include <algorithm>
#include <cmath>

#include "pickcell/core/units.hpp"

namespace pickcell::sim {

namespace {

using core::Base;
using core::Part;
using core::Plane;
using core::Tool;
using core::Transform;

double heading_rad(const Eigen::Matrix3d& R) { return std::atan2(R(1, 0), R(0, 0)); }

/// How far the tool is from a grasp, and whether the gripper's tolerances hold.
struct Reach {
  double mm = 0;
  bool within = false;
};

Reach reach(const Transform<Part, Tool>& T_grasp, const Transform<Part, Tool>& T_tool, bool sym180,
            const GripperSettings& gripper) {
  const Eigen::Vector3d off = T_tool.translation_m() - T_grasp.translation_m();
  const Eigen::Matrix3d R = T_tool.rotation();
  double turn = core::deg_from_rad(heading_rad(R) - heading_rad(T_grasp.rotation()));
  turn = sym180 ? std::remainder(turn, 180.0) : std::remainder(turn, 360.0);
  const double incline = core::deg_from_rad(std::acos(std::clamp(-R(2, 2), -1.0, 1.0)));
  const double mm = core::mm_from_m(off.head<2>().norm());
  return {mm, mm <= gripper.reach_mm && std::abs(turn) <= gripper.turn_deg && incline <= gripper.turn_deg &&
                  std::abs(core::mm_from_m(off.z())) <= gripper.depth_mm};
}

}  // namespace

WorldSettings default_world(std::uint64_t seed) {
  WorldSettings settings;
  settings.seed = seed;
  settings.T_base_plane = Transform<Base, Plane>(core::rotation_z(core::kPi / 2), {0.45, 0, 0.01});
  return settings;
}

World::World(WorldSettings settings) : settings_(std::move(settings)), feed_(settings_.feed, mix(settings_.seed)) {}

Transform<Base, Part> World::pose(const LaidPart& laid) const {
  const Eigen::Vector3d at(laid.at_mm.x(), laid.at_mm.y(), laid.part->kind().height_mm);
  return settings_.T_base_plane *
         Transform<Plane, Part>(core::rotation_z(core::rad_from_deg(laid.angle_deg)), at * 1e-3);
}

void World::output_changed(int n, bool on, const Transform<Base, Tool>& T_base_tool, core::TimePoint t) {
  const std::lock_guard lock(mutex_);
  if (n != kGripperOutput || on == closed_) return;
  closed_ = on;
  feed_.settle(t);
  if (on)
    close(T_base_tool, t);
  else if (held_)
    open(T_base_tool, t);
}

void World::close(const Transform<Base, Tool>& T_base_tool, core::TimePoint t) {
  const FedPart* nearest = nullptr;
  double nearest_mm = 1e9;
  for (const FedPart& p : feed_.parts()) {
    const Transform<Part, Tool> T_part_tool = pose(feed_.on_plane(p, t)).inverse() * T_base_tool;
    for (const TaughtGrasp& grasp : p.laid.part->kind().grasps) {
      const Reach r = reach(grasp_pose(grasp), T_part_tool, grasp.sym180, settings_.gripper);
      if (r.within && r.mm < nearest_mm) nearest = &p, nearest_mm = r.mm;
    }
  }
  if (nearest == nullptr) {
    ++counts_.empty;
    return;
  }
  ++counts_.taken;
  const Transform<Tool, Part> T_tool_part = T_base_tool.inverse() * pose(feed_.on_plane(*nearest, t));
  held_ = Held{nearest->id, nearest->laid.part, T_tool_part, t};
  feed_.take(nearest->id);
}

void World::open(const Transform<Base, Tool>& T_base_tool, core::TimePoint t) {
  const Held held = *std::exchange(held_, std::nullopt);
  const Transform<Base, Part> T_base_part = T_base_tool * held.T_tool_part;
  const Transform<Plane, Part> T_plane_part = settings_.T_base_plane.inverse() * T_base_part;
  const Eigen::Vector3d at_mm = T_plane_part.translation_m() * 1e3;
  const double above_mm = at_mm.z() - held.part->kind().height_mm;
  if (above_mm > settings_.gripper.drop_mm || above_mm < -settings_.gripper.crush_mm) {
    ++counts_.dropped;
    return;
  }
  const LaidPart laid{held.part, at_mm.head<2>(), core::deg_from_rad(heading_rad(T_plane_part.rotation())), 1};
  const Box2& area = settings_.feed.area_mm;
  if ((laid.at_mm.array() >= area.lo.array()).all() && (laid.at_mm.array() <= area.hi.array()).all()) {
    ++counts_.returned;
    feed_.put(held.id, laid, t);
    return;
  }
  ++counts_.placed;
  placed_.push_back({held.id, held.part->kind().name, T_base_part, held.picked, t});
}

bool World::input(int n, core::TimePoint t) {
  const std::lock_guard lock(mutex_);
  feed_.settle(t);
  if (n == kGripSensorInput) return held_.has_value();
  return n == kFeedMovingInput && feed_.moving(t);
}

void World::contact_written(int contact, bool on, core::TimePoint t) {
  const std::lock_guard lock(mutex_);
  if (contact != kFeedAdvanceContact) return;
  if (on && !contact_on_) feed_.advance(t);
  contact_on_ = on;
}

WorldView World::view(core::TimePoint t) {
  const std::lock_guard lock(mutex_);
  feed_.settle(t);
  WorldView view;
  view.surface_shift_mm = feed_.offset_mm(t);
  for (const FedPart& p : feed_.parts()) view.parts.emplace_back(p.id, feed_.on_plane(p, t));
  return view;
}

std::vector<PartTruth> World::parts(core::TimePoint t) {
  std::vector<PartTruth> out;
  for (const auto& [id, laid] : view(t).parts) out.push_back({id, laid.part->kind().name, pose(laid)});
  return out;
}

std::optional<std::string> World::held() const {
  const std::lock_guard lock(mutex_);
  return held_ ? std::optional(held_->part->kind().name) : std::nullopt;
}

std::vector<PlacedPart> World::placed() const {
  const std::lock_guard lock(mutex_);
  return placed_;
}

WorldCounts World::counts(core::TimePoint t) {
  const std::lock_guard lock(mutex_);
  feed_.settle(t);
  WorldCounts counts = counts_;
  counts.missed = feed_.missed();
  return counts;
}

double World::belt_mm(core::TimePoint t) {
  const std::lock_guard lock(mutex_);
  return feed_.offset_mm(t);
}

Transform<Part, Tool> grasp_pose(const TaughtGrasp& grasp) {
  Eigen::Matrix3d down;
  down << 1, 0, 0, 0, -1, 0, 0, 0, -1;
  return {core::rotation_z(core::rad_from_deg(grasp.angle_deg)) * down,
          Eigen::Vector3d(grasp.x_mm, grasp.y_mm, 0) * 1e-3};
}

std::optional<PlaceError> place_error(const PlacedPart& part, std::span<const WantedPlace> wanted) {
  std::optional<PlaceError> nearest;
  for (std::size_t i = 0; i < wanted.size(); ++i) {
    if (wanted[i].kind != part.kind) continue;
    const Eigen::Vector3d off = part.T_base_part.translation_m() - wanted[i].T_base_part.translation_m();
    const double mm = core::mm_from_m(off.head<2>().norm());
    if (nearest && mm >= nearest->mm) continue;
    const double turn = heading_rad(part.T_base_part.rotation()) - heading_rad(wanted[i].T_base_part.rotation());
    nearest = PlaceError{i, mm, core::deg_from_rad(std::abs(core::wrap_rad(turn)))};
  }
  return nearest;
}

}  // namespace pickcell::sim
