#pragma once
/// Looks over the shoulder of the simulated gripper: which command it closed for, and whether it took something.

#include <cstdint>
#include <map>
#include <mutex>

#include "pickcell/sim/controller.hpp"
#include "pickcell/sim/world.hpp"

namespace pickcell::cli {

/// Thread-safe.
class GripWatch final : public sim::Plant {
 public:
  struct Closings {
    int all = 0, took = 0;
    int placed = 0;  ///< opened where the part then lay in a tray
  };

  explicit GripWatch(sim::World& world) : world_(world) {}
  /// Whose registers say which command runs.
  void of(sim::Controller& controller) { controller_ = &controller; }
  /// The sensor sees nothing from now on, although there is a part.
  void blind(bool on) {
    const std::lock_guard lock(mutex_);
    blind_ = on;
  }
  /// By the sequence number that the job had accepted.
  [[nodiscard]] std::map<std::int32_t, Closings> closings() const {
    const std::lock_guard lock(mutex_);
    return closings_;
  }

  void output_changed(int n, bool on, const core::Transform<core::Base, core::Tool>& T_base_tool,
                      core::TimePoint t) override {
    const std::size_t placed_before = world_.placed().size();
    world_.output_changed(n, on, T_base_tool, t);
    if (n != sim::kGripperOutput) return;
    std::int32_t accepted = 0;
    controller_->with_state([&](sim::ControllerState& s) { accepted = s.D[12]; });
    const bool placed = world_.placed().size() > placed_before;
    const std::lock_guard lock(mutex_);
    if (placed) ++closings_[accepted].placed;
    if (!on) return;
    Closings& c = closings_[accepted];
    ++c.all;
    c.took += world_.held().has_value();
  }
  [[nodiscard]] bool input(int n, core::TimePoint t) override {
    const bool on = world_.input(n, t);
    const std::lock_guard lock(mutex_);
    return on && !(n == sim::kGripSensorInput && blind_);
  }
  void contact_written(int contact, bool on, core::TimePoint t) override { world_.contact_written(contact, on, t); }

 private:
  sim::World& world_;
  sim::Controller* controller_ = nullptr;
  mutable std::mutex mutex_;
  bool blind_ = false;
  std::map<std::int32_t, Closings> closings_;
};

}  // namespace pickcell::cli
