#pragma once
/// How parts come: an indexed belt that moves one pitch on request, or a table that is laid anew.

#include <cstdint>
#include <string>
#include <vector>

#include "pickcell/core/clock.hpp"
#include "pickcell/sim/layout.hpp"

namespace pickcell::sim {

enum class Supply { belt, table };

struct FeedSettings {
  Supply supply = Supply::belt;
  std::vector<std::string> kinds = {"bracket_l", "gear_18", "label_box"};
  /// Where parts may be taken, mm in the plane's frame: they are laid wholly inside. The belt moves along +x.
  Box2 area_mm{{-180, -130}, {180, 130}};
  double pitch_mm = 180;
  double speed_mm_s = 250;
  double relay_s = 1;       ///< table: how long it takes to lay new parts
  int parts_per_pitch = 4;  ///< on each pitch of belt, or on half of a table; fewer when they do not fit
  double gap_mm = 24;       ///< between outlines, for the gripper's fingers
};

/// A part somewhere on the belt or table.
struct FedPart {
  std::uint64_t id = 0;  ///< unique in a run, from 1
  LaidPart laid;         ///< on the belt itself: the belt's offset is still to be added to x
  bool missed = false;   ///< has left the area
};

/// The belt or table with its parts. Deterministic for a seed. Times given to one object must not go back, except to
/// offset_mm. Not thread-safe.
class Feed {
 public:
  Feed(FeedSettings settings, std::uint64_t seed);

  /// Asks for one pitch (or new parts on the table); ignored while it moves.
  void advance(core::TimePoint t);
  [[nodiscard]] bool moving(core::TimePoint t) const { return t >= began_ && t < ends_; }
  /// How far the belt has run, mm.
  [[nodiscard]] double offset_mm(core::TimePoint t) const;
  /// Brings counts and parts up to t.
  void settle(core::TimePoint t);

  /// Call settle first.
  [[nodiscard]] const std::vector<FedPart>& parts() const { return parts_; }
  /// The part where it is on the plane at t.
  [[nodiscard]] LaidPart on_plane(const FedPart& part, core::TimePoint t) const;
  /// The part with the id, taken away; it must be there.
  FedPart take(std::uint64_t id);
  /// Puts a part (back) on the belt as it lies on the plane at t.
  void put(std::uint64_t id, LaidPart on_plane, core::TimePoint t);
  [[nodiscard]] int missed() const { return missed_; }
  [[nodiscard]] const FeedSettings& settings() const { return settings_; }

 private:
  void lay(const Box2& region, int count);
  void leave_behind(double beyond_x_mm, double offset);

  FeedSettings settings_;
  Random random_;
  std::vector<FedPart> parts_;
  std::uint64_t next_id_ = 1;
  int missed_ = 0;
  double base_mm_ = 0;  ///< belt offset before the last move
  core::TimePoint began_{}, ends_{};
  bool settled_ = true;
};

}  // namespace pickcell::sim
