#pragma once
/// The cell's eye: one picture in, parts in the robot's base frame out, and for everything else that was seen the
/// reason why it is not picked.

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "pickcell/cell/gate.hpp"
#include "pickcell/core/result.hpp"
#include "pickcell/frames/frame.hpp"
#include "pickcell/image/pyramid.hpp"
#include "pickcell/matches/engine.hpp"
#include "pickcell/matches/model.hpp"
#include "pickcell/poses/calibration.hpp"
#include "pickcell/poses/locate.hpp"
#include "pickcell/poses/part_pose.hpp"

namespace pickcell::cell {

/// What one picture holds.
struct Sight {
  struct Seen {
    std::uint64_t detection_id = 0;
    matches::Match match;
    std::optional<Rejection> rejection;  ///< unset: stands in parts
  };
  std::vector<Seen> seen;              ///< best score first
  std::vector<poses::PartPose> parts;  ///< those that may be picked
  double match_ms = 0;                 ///< wall time
  std::optional<core::Error> unfit;    ///< the calibration does not fit this picture (size, camera, age, verdict)
};

/// One thread at a time.
class Vision {
 public:
  struct Settings {
    poses::CameraCalibration camera;
    poses::PlaneCalibration plane;
    double max_age_days = 365;
    int threads = 0;  ///< of the matcher; 0: all
    int max_matches = 60;
    /// With it: plane holds the work plane only (T_base_plane), and the camera's place follows from this at exposure.
    std::optional<poses::HandeyeCalibration> handeye{};
  };

  /// models: in the order of the recipe; PartPose::model_index counts them. Their height_m is what the parts really
  /// have.
  Vision(std::unique_ptr<matches::Engine> engine, std::vector<matches::Model> models, Settings settings);

  /// Searches for every model at once, gates and locates. first_id: of the first detection, the others count on. A
  /// picture that the calibration does not fit is searched all the same, but everything in it is rejected, and unfit is
  /// set. Errors: those of the engine.
  [[nodiscard]] core::Result<Sight> look(const frames::Frame& frame, std::uint64_t first_id);

  [[nodiscard]] const std::vector<matches::Model>& models() const { return models_; }
  [[nodiscard]] std::string engine_name() const { return engine_->name(); }
  /// The camera is on the arm: frames must carry the arm's pose at their exposure.
  [[nodiscard]] bool rides_on_arm() const { return settings_.handeye && settings_.handeye->T_flange_camera; }

 private:
  [[nodiscard]] matches::SearchOptions search_options() const;
  [[nodiscard]] core::Result<poses::View> view_of(const frames::Frame& frame) const;
  void judge_one(Sight& sight, Sight::Seen& seen, const frames::Frame& frame,
                 const core::Result<poses::View>& view) const;

  std::unique_ptr<matches::Engine> engine_;
  std::vector<matches::Model> models_;
  std::vector<const matches::Model*> searched_;
  std::vector<poses::Locator> locators_;
  Settings settings_;
  poses::View fixed_view_;  ///< without a hand-eye calibration
  image::Pyramid pyramid_;
  matches::FindResult found_;  ///< its memory is used again: the search takes nothing from the heap
};

}  // namespace pickcell::cell
