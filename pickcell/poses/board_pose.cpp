#include "pickcell/poses/board_pose.hpp"

#include <Eigen/SVD>
#include <cmath>
#include <limits>
#include <opencv2/calib3d.hpp>

namespace pickcell::poses {

namespace {

using core::ErrorCode;
using core::failure;

cv::Matx33d matrix_of(const Lens& lens) { return {lens.fx_px, 0, lens.cx_px, 0, lens.fy_px, lens.cy_px, 0, 0, 1}; }

Eigen::Isometry3d isometry(const cv::Mat& rvec, const cv::Mat& tvec) {
  const Eigen::Vector3d r(rvec.at<double>(0), rvec.at<double>(1), rvec.at<double>(2));
  Eigen::Isometry3d out = Eigen::Isometry3d::Identity();
  if (r.norm() > 0) out.linear() = Eigen::AngleAxisd(r.norm(), r.normalized()).toRotationMatrix();
  out.translation() = Eigen::Vector3d(tvec.at<double>(0), tvec.at<double>(1), tvec.at<double>(2));
  return out;
}

/// The frame of the points' own axes, the flattest last, and how far they reach along each.
struct Spread {
  Eigen::Isometry3d T_points_own = Eigen::Isometry3d::Identity();
  Eigen::Vector3d reach_m = Eigen::Vector3d::Zero();
};

Spread spread_of(const std::vector<Eigen::Vector3d>& points_m) {
  Eigen::Matrix3Xd centred(3, static_cast<Eigen::Index>(points_m.size()));
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const auto& p : points_m) mean += p / static_cast<double>(points_m.size());
  for (Eigen::Index i = 0; i < centred.cols(); ++i) centred.col(i) = points_m[static_cast<std::size_t>(i)] - mean;
  const Eigen::JacobiSVD<Eigen::Matrix3Xd> svd(centred, Eigen::ComputeFullU);
  Spread out;
  Eigen::Matrix3d R = svd.matrixU();
  if (R.determinant() < 0) R.col(2) *= -1;
  out.T_points_own.linear() = R;
  out.T_points_own.translation() = mean;
  const Eigen::VectorXd s = svd.singularValues();
  for (Eigen::Index i = 0; i < std::min<Eigen::Index>(3, s.size()); ++i)
    out.reach_m[i] = s[i] / std::sqrt(static_cast<double>(points_m.size()));
  return out;
}

}  // namespace

core::Result<PointsPose> points_pose(const Lens& lens, const std::vector<Eigen::Vector3d>& points_m,
                                     const std::vector<Eigen::Vector2d>& pixels) {
  if (points_m.size() != pixels.size()) throw std::invalid_argument("points and pixels differ in number");
  const auto no_pose = [](const char* why) {
    return failure(ErrorCode::negative, "points", why, "give at least four points spread over the picture");
  };
  if (points_m.size() < 4) return no_pose("fewer than four fix no pose");
  const Spread spread = spread_of(points_m);
  if (spread.reach_m[1] < 1e-3 * spread.reach_m[0] || !(spread.reach_m[0] > 0)) return no_pose("they lie in one line");
  const bool flat = spread.reach_m[2] < 1e-2 * spread.reach_m[0];

  std::vector<cv::Point3d> own;
  std::vector<cv::Point2d> seen;
  const Eigen::Isometry3d T_own_points = spread.T_points_own.inverse();
  for (std::size_t i = 0; i < points_m.size(); ++i) {
    const Eigen::Vector3d p = T_own_points * points_m[i];
    own.emplace_back(p.x(), p.y(), p.z());
    seen.emplace_back(pixels[i].x(), pixels[i].y());
  }
  std::vector<cv::Point3d> start_points = own;
  if (flat)
    for (auto& p : start_points) p.z = 0;
  const cv::Matx33d K = matrix_of(lens);
  const cv::Mat distortion(1, 8, CV_64F, const_cast<double*>(lens.distortion.data()));
  std::vector<cv::Mat> rvecs, tvecs;
  try {
    cv::solvePnPGeneric(start_points, seen, K, distortion, rvecs, tvecs, false,
                        flat ? cv::SOLVEPNP_IPPE : cv::SOLVEPNP_SQPNP);
  } catch (const cv::Exception&) {
    return no_pose("they fix no pose");
  }
  PointsPose best;
  best.rms_px = std::numeric_limits<double>::max();
  for (std::size_t k = 0; k < rvecs.size(); ++k) {
    cv::Mat r = rvecs[k].clone(), t = tvecs[k].clone();
    cv::solvePnPRefineLM(own, seen, K, distortion, r, t, {cv::TermCriteria::EPS | cv::TermCriteria::COUNT, 60, 1e-10});
    PointsPose one;
    one.T_camera_points = isometry(r, t) * T_own_points;
    double sum = 0;
    bool in_front = true;
    for (std::size_t i = 0; i < points_m.size(); ++i) {
      const Eigen::Vector3d p = one.T_camera_points * points_m[i];
      in_front = in_front && p.z() > 0;
      one.residual_px.push_back(pixels[i] - project(lens, {p.x() / p.z(), p.y() / p.z()}));
      sum += one.residual_px.back().squaredNorm();
    }
    one.rms_px = std::sqrt(sum / static_cast<double>(points_m.size()));
    if (in_front && one.rms_px < best.rms_px) best = std::move(one);
  }
  if (!(best.rms_px < std::numeric_limits<double>::max())) return no_pose("they fix no pose before the camera");
  return best;
}

core::Result<BoardPose> board_pose(const Lens& lens, const Board& board, const BoardView& view) {
  const auto nominal = board_points_m(board);
  std::vector<Eigen::Vector3d> points_m;
  for (const int id : view.ids) {
    const Eigen::Vector2d& p = nominal[static_cast<std::size_t>(id)];
    points_m.emplace_back(p.x(), p.y(), 0);
  }
  auto pose = points_pose(lens, points_m, view.pixels);
  if (!pose) return core::forward(pose);
  return BoardPose{core::Transform<core::Camera, core::Board>(pose->T_camera_points), pose->rms_px};
}

std::vector<Eigen::Vector2d> predicted_pixels(const Lens& lens, const Board& board, const std::vector<int>& ids,
                                              const core::Transform<core::Camera, core::Board>& T_camera_board) {
  const auto nominal = board_points_m(board);
  std::vector<Eigen::Vector2d> out;
  for (const int id : ids) {
    const Eigen::Vector2d& b = nominal[static_cast<std::size_t>(id)];
    const Eigen::Vector3d p = (T_camera_board * core::Point<core::Board>{{b.x(), b.y(), 0}}).m;
    out.push_back(project(lens, {p.x() / p.z(), p.y() / p.z()}));
  }
  return out;
}

}  // namespace pickcell::poses
