#pragma once
/// The picture a user would take to teach a part: it alone, in the middle of the field of view.

#include <string>
#include <vector>

#include "pickcell/image/image.hpp"
#include "pickcell/sim/camera.hpp"

namespace pickcell::sim {

/// A grasp in pixels of the picture; angle counter-clockwise on the screen.
struct GraspPixel {
  double x_px = 0;
  double y_px = 0;
  double angle_deg = 0;
  bool sym180 = false;
};

/// Everything `pickcell teach` asks for; pixels of the whole picture.
struct TeachPicture {
  std::string kind;
  image::Image picture;
  image::Image mask;  ///< of the picture's size, 255 on the part's top face
  int roi_x = 0, roi_y = 0, roi_w = 0, roi_h = 0;
  double ref_x_px = 0, ref_y_px = 0;  ///< the part's origin
  std::vector<GraspPixel> grasps;
  double height_mm = 0;
};

/// Takes one picture per kind. The part lies so that its x axis is the picture's x axis at the reference point, as
/// core::Part demands of a taught part: true poses of the world and poses found with this template then mean the same
/// frame. surface: what it lies on; by default another piece of the belt. Unknown kinds throw std::invalid_argument.
[[nodiscard]] std::vector<TeachPicture> take_teach_pictures(
    const std::vector<std::string>& kinds, const CameraSettings& camera,
    const core::Transform<core::Base, core::Plane>& T_base_plane, Surface surface = Surface::belt);

}  // namespace pickcell::sim
