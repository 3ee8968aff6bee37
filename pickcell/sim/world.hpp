#pragma once
/// The truth of the simulated cell: work plane, parts, gripper, and a record of where every part ended. The cell never
/// sees it; it acts through the controller's contacts and looks through the camera.

#include <cstdint>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "pickcell/core/clock.hpp"
#include "pickcell/core/transform.hpp"
#include "pickcell/sim/feed.hpp"
#include "pickcell/sim/plant.hpp"

namespace pickcell::sim {

struct GripperSettings {
  double reach_mm = 3;  ///< takes a part whose grasp is at most this far from the tool, in the plane
  double turn_deg = 5;  ///< and turned, or the tool inclined, by at most this much
  double depth_mm = 4;  ///< and whose top is at most this far above or below the tool
  double drop_mm = 15;  ///< a part let go with its lower face higher above the floor than this is dropped
  double crush_mm = 3;  ///< or deeper below the floor than this
};

struct WorldSettings {
  std::uint64_t seed = 1;
  core::Transform<core::Base, core::Plane> T_base_plane;  ///< the tray's floor lies in the same plane
  FeedSettings feed;
  GripperSettings gripper;
};

/// The simulated cell as it is built: the work plane 0.45 m in front of the robot, the belt along base +y.
[[nodiscard]] WorldSettings default_world(std::uint64_t seed);

struct PartTruth {
  std::uint64_t id = 0;
  std::string kind;
  core::Transform<core::Base, core::Part> T_base_part;
};

struct PlacedPart {
  std::uint64_t id = 0;
  std::string kind;
  core::Transform<core::Base, core::Part> T_base_part;  ///< when the gripper let go
  core::TimePoint picked{}, placed{};
};

struct WorldCounts {
  int taken = 0;  ///< closings of the gripper that took a part
  int empty = 0;  ///< closings that took none
  int placed = 0;
  int dropped = 0;   ///< let go in the air, or pushed into the floor
  int returned = 0;  ///< put back where parts are fed
  int missed = 0;    ///< left the area without being taken
};

/// What lies on the plane at one moment, in the plane's frame, for a camera.
struct WorldView {
  std::vector<std::pair<std::uint64_t, LaidPart>> parts;
  double surface_shift_mm = 0;  ///< the belt's surface has moved so far along +x
};

/// Thread-safe. Deterministic for a seed and a sequence of calls.
class World final : public Plant {
 public:
  /// Throws std::invalid_argument for unknown kinds and impossible sizes.
  explicit World(WorldSettings settings);

  void output_changed(int n, bool on, const core::Transform<core::Base, core::Tool>& T_base_tool,
                      core::TimePoint t) override;
  [[nodiscard]] bool input(int n, core::TimePoint t) override;
  void contact_written(int contact, bool on, core::TimePoint t) override;

  [[nodiscard]] WorldView view(core::TimePoint t);
  /// The parts on the plane at t.
  [[nodiscard]] std::vector<PartTruth> parts(core::TimePoint t);
  [[nodiscard]] std::optional<std::string> held() const;
  /// In the order of placing.
  [[nodiscard]] std::vector<PlacedPart> placed() const;
  [[nodiscard]] WorldCounts counts(core::TimePoint t);
  [[nodiscard]] double belt_mm(core::TimePoint t);
  [[nodiscard]] const WorldSettings& settings() const { return settings_; }

  /// Pose in base of a part that lies on the plane.
  [[nodiscard]] core::Transform<core::Base, core::Part> pose(const LaidPart& laid) const;

 private:
  struct Held {
    std::uint64_t id = 0;
    const PartTexture* part = nullptr;
    core::Transform<core::Tool, core::Part> T_tool_part;  ///< stays as it was when the fingers closed
    core::TimePoint picked{};
  };
  void close(const core::Transform<core::Base, core::Tool>& T_base_tool, core::TimePoint t);
  void open(const core::Transform<core::Base, core::Tool>& T_base_tool, core::TimePoint t);

  const WorldSettings settings_;
  mutable std::mutex mutex_;
  Feed feed_;
  bool closed_ = false;
  bool contact_on_ = false;
  std::optional<Held> held_;
  std::vector<PlacedPart> placed_;
  WorldCounts counts_;
};

/// T_part_tool of a taught grasp: the tool's Z down into the part, its X along the grasp, its origin on the top face.
[[nodiscard]] core::Transform<core::Part, core::Tool> grasp_pose(const TaughtGrasp& grasp);

struct PlaceError {
  std::size_t slot = 0;  ///< of the wanted poses
  double mm = 0;         ///< in the base frame's x-y plane
  double deg = 0;        ///< about base z, 0..180
};

struct WantedPlace {
  std::string kind;
  core::Transform<core::Base, core::Part> T_base_part;
};

/// The distance of a placed part from the nearest wanted place of its kind; none when no place is wanted for that kind.
[[nodiscard]] std::optional<PlaceError> place_error(const PlacedPart& part, std::span<const WantedPlace> wanted);

}  // namespace pickcell::sim
