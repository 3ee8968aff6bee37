#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <opencv2/calib3d.hpp>

#include "pickcell/core/units.hpp"
#include "pickcell/poses/handeye_problem.hpp"

namespace pickcell::poses::detail {

namespace {

cv::HandEyeCalibrationMethod method_of(Solver solver) {
  switch (solver) {
    case Solver::park:
      return cv::CALIB_HAND_EYE_PARK;
    case Solver::horaud:
      return cv::CALIB_HAND_EYE_HORAUD;
    case Solver::tsai:
      return cv::CALIB_HAND_EYE_TSAI;
    case Solver::andreff:
      return cv::CALIB_HAND_EYE_ANDREFF;
    case Solver::daniilidis:
      return cv::CALIB_HAND_EYE_DANIILIDIS;
  }
  return cv::CALIB_HAND_EYE_PARK;
}

cv::Mat rotation_mat(const Eigen::Isometry3d& T) {
  cv::Mat R(3, 3, CV_64F);
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) R.at<double>(i, j) = T.linear()(i, j);
  return R;
}

cv::Mat translation_mat(const Eigen::Isometry3d& T) {
  cv::Mat t(3, 1, CV_64F);
  for (int i = 0; i < 3; ++i) t.at<double>(i) = T.translation()[i];
  return t;
}

Eigen::Matrix3d nearest_rotation(const Eigen::Matrix3d& M) {
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(M, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Eigen::Matrix3d U = svd.matrixU();
  if ((U * svd.matrixV().transpose()).determinant() < 0) U.col(2) *= -1;
  return U * svd.matrixV().transpose();
}

}  // namespace

const char* name(Solver solver) {
  switch (solver) {
    case Solver::park:
      return "PARK";
    case Solver::horaud:
      return "HORAUD";
    case Solver::tsai:
      return "TSAI";
    case Solver::andreff:
      return "ANDREFF";
    case Solver::daniilidis:
      return "DANIILIDIS";
  }
  return "";
}

double angle_deg(const Eigen::Matrix3d& rotation) {
  // Well conditioned near 0 and 180 degrees, where the arc cosine of the trace is not.
  const Eigen::Vector3d axis(rotation(2, 1) - rotation(1, 2), rotation(0, 2) - rotation(2, 0),
                             rotation(1, 0) - rotation(0, 1));
  return core::deg_from_rad(std::atan2(axis.norm(), rotation.trace() - 1));
}

Eigen::Isometry3d mean_pose(const std::vector<Eigen::Isometry3d>& poses) {
  Eigen::Matrix3d R = Eigen::Matrix3d::Zero();
  Eigen::Vector3d t = Eigen::Vector3d::Zero();
  for (const auto& p : poses) {
    R += p.linear();
    t += p.translation() / static_cast<double>(poses.size());
  }
  Eigen::Isometry3d out = Eigen::Isometry3d::Identity();
  out.linear() = nearest_rotation(R);
  out.translation() = t;
  return out;
}

std::vector<Eigen::Isometry3d> board_places(const Stations& stations, const Eigen::Isometry3d& X) {
  std::vector<Eigen::Isometry3d> out;
  for (const Station& s : stations) out.push_back(s.move * X * s.T_camera_board);
  return out;
}

Spread spread_of(const std::vector<Eigen::Isometry3d>& places) {
  const Eigen::Isometry3d mean = mean_pose(places);
  double m2 = 0, deg2 = 0;
  for (const auto& p : places) {
    m2 += (p.translation() - mean.translation()).squaredNorm();
    const double deg = angle_deg(mean.linear().transpose() * p.linear());
    deg2 += deg * deg;
  }
  const double n = static_cast<double>(places.size());
  return {core::mm_from_m(std::sqrt(m2 / n)), std::sqrt(deg2 / n)};
}

std::optional<HandEye> solve(const Stations& stations, Solver solver) {
  std::vector<cv::Mat> R_move, t_move, R_board, t_board;
  for (const Station& s : stations) {
    R_move.push_back(rotation_mat(s.move));
    t_move.push_back(translation_mat(s.move));
    R_board.push_back(rotation_mat(s.T_camera_board));
    t_board.push_back(translation_mat(s.T_camera_board));
  }
  cv::Mat R, t;
  try {
    cv::calibrateHandEye(R_move, t_move, R_board, t_board, R, t, method_of(solver));
  } catch (const cv::Exception&) {
    return std::nullopt;
  }
  HandEye out;
  Eigen::Matrix3d rotation;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) rotation(i, j) = R.at<double>(i, j);
    out.X.translation()[i] = t.at<double>(i);
  }
  if (!rotation.allFinite() || !out.X.translation().allFinite()) return std::nullopt;
  out.X.linear() = nearest_rotation(rotation);
  out.Y = mean_pose(board_places(stations, out.X));
  return out;
}

std::vector<Eigen::Vector2d> residuals_px(const Lens& lens, const std::vector<Eigen::Vector2d>& board_m,
                                          const Station& station, const HandEye& result) {
  constexpr double kFar = 1e4;
  const Eigen::Isometry3d T_camera_board = (station.move * result.X).inverse() * result.Y;
  std::vector<Eigen::Vector2d> out;
  for (std::size_t i = 0; i < station.view.ids.size(); ++i) {
    const Eigen::Vector2d& b = board_m[static_cast<std::size_t>(station.view.ids[i])];
    const Eigen::Vector3d p = T_camera_board * Eigen::Vector3d(b.x(), b.y(), 0);
    Eigen::Vector2d r(kFar, 0);
    if (p.z() > 1e-6) r = station.view.pixels[i] - project(lens, {p.x() / p.z(), p.y() / p.z()});
    if (!(r.norm() < kFar)) r = {kFar, 0};
    out.push_back(r);
  }
  return out;
}

double rms(const std::vector<Eigen::Vector2d>& residuals) {
  double sum = 0;
  for (const auto& r : residuals) sum += r.squaredNorm();
  return std::sqrt(sum / static_cast<double>(std::max<std::size_t>(1, residuals.size())));
}

std::vector<double> station_rms_px(const Lens& lens, const std::vector<Eigen::Vector2d>& board_m,
                                   const Stations& stations, const HandEye& result) {
  std::vector<double> out;
  for (const Station& s : stations) out.push_back(rms(residuals_px(lens, board_m, s, result)));
  return out;
}

}  // namespace pickcell::poses::detail
