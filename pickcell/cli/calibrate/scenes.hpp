#pragma once
/// Simulated calibrations with known truth: what tests and the experiment judge poses' calibrations by. The pictures
/// come from sim, whose projection is its own.

#include <cstdint>
#include <string>
#include <vector>

#include "pickcell/poses/handeye.hpp"
#include "pickcell/poses/plane_calibration.hpp"
#include "pickcell/sim/board_picture.hpp"

namespace pickcell::cli {

/// A camera on an arm that looks at a board from all around.
struct HandeyeScene {
  sim::Intrinsics camera;
  core::Transform<core::Flange, core::Camera> T_flange_camera;
  core::Transform<core::Base, core::Board> T_base_board;
  poses::Board board;
  sim::BoardPattern pattern;
  std::vector<core::Transform<core::Base, core::Flange>> T_base_flange;

  [[nodiscard]] core::Transform<core::Camera, core::Board> T_camera_board(std::size_t i) const;
};

/// board: of any kind, as `--board` names it, some 150 to 250 mm large.
[[nodiscard]] HandeyeScene handeye_scene(std::uint64_t seed, int stations,
                                         const std::string& board = "chessboard:9x6:25mm");
[[nodiscard]] poses::Lens lens_of(const sim::Intrinsics& camera);

/// Corners by sim's projection with normal noise, and the arm's poses as a CSV of Euler angles would have them.
[[nodiscard]] poses::HandeyeInput with_noisy_corners(const HandeyeScene& scene, double noise_px, std::uint64_t seed);
/// Corners found in rendered pictures.
[[nodiscard]] poses::HandeyeInput with_pictures(const HandeyeScene& scene, std::uint64_t seed);

struct TransformError {
  double mm = 0, deg = 0;
};
[[nodiscard]] TransformError error_of(const Eigen::Isometry3d& found, const Eigen::Isometry3d& truth);

/// Normal errors of every pose: per axis, and about one skew axis.
void scatter(poses::HandeyeInput& input, double mm, double deg, std::uint64_t seed);

/// A fault that somebody makes in a set of poses: its name, the words that name it in a report, and what it does.
struct PoseFault {
  std::string name;
  std::vector<std::string> words;  ///< one of them must stand in `why`
  void (*apply)(poses::HandeyeInput& input, std::uint64_t seed);
};
[[nodiscard]] std::vector<PoseFault> pose_faults();

/// Of a plane calibrated from one picture of the board whose corners carry noise, and all corners touched exactly: the
/// errors in mm at the corners.
struct PlaneError {
  double mean_mm = 0, worst_mm = 0;
};
[[nodiscard]] PlaneError plane_error(double noise_px, std::uint64_t seed);

/// Standard deviations of X that the corner noise alone causes (Cramer-Rao bound, linearised at the truth).
[[nodiscard]] TransformError expected_error(const HandeyeScene& scene, double noise_px);

}  // namespace pickcell::cli
