#pragma once
/// From a match in the picture to a part in the robot's base frame: pixel, undistorted ray, plane at the part's height.

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "pickcell/core/result.hpp"
#include "pickcell/core/transform.hpp"
#include "pickcell/matches/match.hpp"
#include "pickcell/matches/model.hpp"
#include "pickcell/poses/lens.hpp"
#include "pickcell/poses/part_pose.hpp"

namespace pickcell::poses {

/// Where the camera and the plane stand at the moment of exposure, and how well that is known.
struct View {
  Lens lens;
  core::Transform<core::Base, core::Camera> T_base_camera;
  core::Transform<core::Base, core::Plane> T_base_plane;
  double sigma_position_m = 0;                              ///< of the calibration, per axis
  double sigma_turn_rad = 0;                                ///< of directions on the plane, by the calibration
  Eigen::Vector2d turns_about_m = Eigen::Vector2d::Zero();  ///< plane frame: places shift as they turn about this
};

/// Point of the plane z = height_m (plane frame) seen at a pixel; nothing when the ray misses it.
[[nodiscard]] std::optional<Eigen::Vector2d> plane_point(const View& view, const Eigen::Vector2d& pixel,
                                                         double height_m);

/// Turns matches of one model into part poses. A match is a similarity, but what the camera sees of a flat part is bent
/// by lens and perspective: the pose reported here is the one whose predicted picture, fitted by a similarity over the
/// model's own pixels, gives exactly the match. So neither the angle nor the place carries the local stretch of the
/// lens. The metre per template pixel comes out of the same equations. Thread-safe after construction.
class Locator {
 public:
  explicit Locator(const matches::Model& model);

  /// Errors: negative, when the ray through the match does not meet the plane or the lens model is not valid there.
  [[nodiscard]] core::Result<PartPose> locate(const matches::Match& match, const View& view) const;

 private:
  std::vector<Eigen::Vector2d> samples_px_;  ///< template pixels of the part relative to the reference point, y down
  std::vector<matches::Grasp> grasps_;       ///< relative to the reference point
  double height_m_;
  std::vector<Eigen::Vector2d> corners_px_;  ///< of the template, relative to the reference point
};

}  // namespace pickcell::poses
