#pragma once
/// Rigid transforms that know their frames: `p_base = T_base_camera * p_camera`, and the wrong order does not compile.

#include <Eigen/Geometry>

namespace pickcell::core {

/// Frames of the cell. Right-handed, metres.
struct Base {};    ///< the robot controller's base frame
struct Flange {};  ///< the arm's flange (tool 0)
struct Tool {};    ///< the tool centre point; Z points out of the flange
struct Camera {};  ///< optical frame: x right, y down, z along the view
struct Plane {};   ///< work plane: z up, z = 0 on the table
struct Board {};   ///< calibration board
struct Part {};    ///< origin at the model's reference point on the part's top face, x along the template's x, z up

/// A point in the named frame, metres.
template <class Frame>
struct Point {
  Eigen::Vector3d m = Eigen::Vector3d::Zero();
};

/// T_to_from: maps coordinates in From to coordinates in To.
template <class To, class From>
class Transform {
 public:
  Transform() : iso_(Eigen::Isometry3d::Identity()) {}
  explicit Transform(const Eigen::Isometry3d& iso) : iso_(iso) {}
  Transform(const Eigen::Matrix3d& rotation, const Eigen::Vector3d& translation_m) : Transform() {
    iso_.linear() = rotation;
    iso_.translation() = translation_m;
  }

  [[nodiscard]] Transform<From, To> inverse() const { return Transform<From, To>(iso_.inverse(Eigen::Isometry)); }
  [[nodiscard]] const Eigen::Isometry3d& iso() const { return iso_; }
  [[nodiscard]] Eigen::Matrix3d rotation() const { return iso_.linear(); }
  [[nodiscard]] Eigen::Vector3d translation_m() const { return iso_.translation(); }
  [[nodiscard]] Eigen::Matrix4d matrix() const { return iso_.matrix(); }

  template <class G>
  [[nodiscard]] Transform<To, G> operator*(const Transform<From, G>& right) const {
    return Transform<To, G>(iso_ * right.iso());
  }
  [[nodiscard]] Point<To> operator*(const Point<From>& p) const { return {iso_ * p.m}; }

 private:
  Eigen::Isometry3d iso_;
};

/// Rotation about z, counter-clockwise seen from +z.
inline Eigen::Matrix3d rotation_z(double rad) {
  return Eigen::AngleAxisd(rad, Eigen::Vector3d::UnitZ()).toRotationMatrix();
}

}  // namespace pickcell::core
