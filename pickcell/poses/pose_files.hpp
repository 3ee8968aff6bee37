#pragma once
/// Files of arm poses and touched points (docs/interfaces.md, Files). Pure parsers: text in, values out; lengths and
/// counts are checked first. All errors are of kind unreadable and name the line.

#include <Eigen/Geometry>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "pickcell/core/result.hpp"

namespace pickcell::poses {

/// A pose as its file states it, in metres and degrees, so that another reading of it can be tried.
struct ArmPose {
  std::string image;
  Eigen::Vector3d position_m = Eigen::Vector3d::Zero();
  bool euler = false;  ///< rx_deg, ry_deg, rz_deg were given (R = Rz * Ry * Rx); otherwise the quaternion
  Eigen::Vector3d angles_deg = Eigen::Vector3d::Zero();
  Eigen::Quaterniond quaternion = Eigen::Quaterniond::Identity();

  /// T_base_flange (or T_base_tool).
  [[nodiscard]] Eigen::Isometry3d pose() const;
};

/// R = Rz(rz) * Ry(ry) * Rx(rx).
[[nodiscard]] Eigen::Matrix3d rotation_zyx(const Eigen::Vector3d& angles_deg);

/// A line of POINTS.csv: a pixel and the touched place, base frame.
struct TouchedPixel {
  Eigen::Vector2d pixel;
  Eigen::Vector3d touched_m;
};

/// A line of TOUCHED.csv: a point of the board and the touched place, base frame.
struct TouchedCorner {
  int col = 0, row = 0;
  Eigen::Vector3d touched_m;
};

/// CSV with a header that names units: image, x_mm|x_m (y, z alike), rx_deg|rx_rad (ry, rz) or qx, qy, qz, qw; columns
/// in any order. Every row needs finite numbers, images must differ, quaternions must have length 1.
[[nodiscard]] core::Result<std::vector<ArmPose>> parse_pose_csv(std::string_view text, const std::string& name);
[[nodiscard]] core::Result<std::vector<TouchedPixel>> parse_points_csv(std::string_view text, const std::string& name);
[[nodiscard]] core::Result<std::vector<TouchedCorner>> parse_touched_csv(std::string_view text,
                                                                         const std::string& name);

/// One entry of an rct cal_data.yaml: paths relative to it.
struct RctEntry {
  std::string pose, image;
};
[[nodiscard]] core::Result<std::vector<RctEntry>> parse_rct_list(std::string_view text, const std::string& name);
/// An rct pose file: x, y, z (m), qx, qy, qz, qw.
[[nodiscard]] core::Result<ArmPose> parse_rct_pose(std::string_view text, const std::string& name);

/// A CSV, or a cal_data.yaml with the pose files it names. At most 10000 poses.
[[nodiscard]] core::Result<std::vector<ArmPose>> load_poses(const std::filesystem::path& path);

}  // namespace pickcell::poses
