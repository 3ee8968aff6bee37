#include "pickcell/poses/lens_fit.hpp"

#include <cmath>
#include <opencv2/calib3d.hpp>

#include "pickcell/core/units.hpp"
#include "pickcell/poses/board_pose.hpp"

namespace pickcell::poses {

namespace {

using core::ErrorCode;
using core::failure;

int flags_of(LensModel model) {
  constexpr int kNoTangential = cv::CALIB_ZERO_TANGENT_DIST;
  switch (model) {
    case LensModel::pinhole:
      return kNoTangential | cv::CALIB_FIX_K1 | cv::CALIB_FIX_K2 | cv::CALIB_FIX_K3;
    case LensModel::k1k2:
      return kNoTangential | cv::CALIB_FIX_K3;
    case LensModel::brown5:
      return 0;
    case LensModel::rational:
      return cv::CALIB_RATIONAL_MODEL;
  }
  return 0;
}

std::size_t coefficients(LensModel model) {
  switch (model) {
    case LensModel::pinhole:
      return 0;
    case LensModel::k1k2:
      return 2;
    case LensModel::brown5:
      return 5;
    case LensModel::rational:
      return 8;
  }
  return 0;
}

core::Transform<core::Camera, core::Board> transform(const cv::Mat& rvec, const cv::Mat& tvec) {
  cv::Matx33d R;
  cv::Rodrigues(rvec, R);
  Eigen::Matrix3d rotation;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) rotation(i, j) = R(i, j);
  return {rotation, {tvec.at<double>(0), tvec.at<double>(1), tvec.at<double>(2)}};
}

CameraView fitted_view(const Lens& lens, const Board& board, const NamedView& named,
                       const core::Transform<core::Camera, core::Board>& T_camera_board) {
  CameraView out;
  out.image = named.image;
  out.view = named.view;
  out.T_camera_board = T_camera_board;
  const auto predicted = predicted_pixels(lens, board, named.view.ids, T_camera_board);
  double sum = 0;
  for (std::size_t i = 0; i < predicted.size(); ++i) {
    out.residual_px.push_back(named.view.pixels[i] - predicted[i]);
    sum += out.residual_px.back().squaredNorm();
  }
  out.rms_px = std::sqrt(sum / static_cast<double>(predicted.size()));
  out.tilt_deg = core::deg_from_rad(std::acos(std::min(1.0, std::abs(T_camera_board.rotation()(2, 2)))));
  return out;
}

}  // namespace

const char* name(LensModel model) {
  switch (model) {
    case LensModel::pinhole:
      return "none";
    case LensModel::k1k2:
      return "k1k2";
    case LensModel::brown5:
      return "brown5";
    case LensModel::rational:
      return "rational";
  }
  return "";
}

core::Result<LensFit> fit_lens(const Board& board, const std::vector<NamedView>& views, LensModel model) {
  const auto nominal = board_points_m(board);
  std::vector<std::vector<cv::Point3f>> points;
  std::vector<std::vector<cv::Point2f>> pixels;
  for (const NamedView& v : views) {
    points.emplace_back();
    pixels.emplace_back();
    for (std::size_t i = 0; i < v.view.ids.size(); ++i) {
      const Eigen::Vector2d& p = nominal[static_cast<std::size_t>(v.view.ids[i])];
      points.back().emplace_back(static_cast<float>(p.x()), static_cast<float>(p.y()), 0.f);
      pixels.back().emplace_back(static_cast<float>(v.view.pixels[i].x()), static_cast<float>(v.view.pixels[i].y()));
    }
  }
  const auto failed = [] {
    return failure(ErrorCode::negative, "camera", "no lens fits the pictures",
                   "take pictures from more directions, with the board in every part of the picture");
  };
  LensFit fit;
  cv::Matx33d K = cv::Matx33d::eye();
  cv::Mat distortion = cv::Mat::zeros(1, 8, CV_64F), sigma_inner, sigma_outer, per_view;
  std::vector<cv::Mat> rvecs, tvecs;
  const cv::Size size(views.front().view.width_px, views.front().view.height_px);
  try {
    fit.rms_px =
        cv::calibrateCamera(points, pixels, size, K, distortion, rvecs, tvecs, sigma_inner, sigma_outer, per_view,
                            flags_of(model), {cv::TermCriteria::EPS | cv::TermCriteria::COUNT, 60, 1e-9});
  } catch (const cv::Exception&) {
    return failed();
  }
  fit.lens = {size.width, size.height, K(0, 0), K(1, 1), K(0, 2), K(1, 2), {}};
  for (std::size_t i = 0; i < coefficients(model); ++i) {
    fit.lens.distortion[i] = distortion.at<double>(static_cast<int>(i));
    fit.sigma.distortion.push_back(sigma_inner.at<double>(static_cast<int>(4 + i)));
  }
  fit.sigma.fx_px = sigma_inner.at<double>(0);
  fit.sigma.fy_px = sigma_inner.at<double>(1);
  fit.sigma.cx_px = sigma_inner.at<double>(2);
  fit.sigma.cy_px = sigma_inner.at<double>(3);
  const bool sane = std::isfinite(fit.rms_px) && fit.lens.fx_px > 1 && fit.lens.fy_px > 1 && fit.lens.fx_px < 1e7;
  if (!sane) return failed();
  double sum = 0;
  std::size_t count = 0;
  for (std::size_t i = 0; i < views.size(); ++i) {
    fit.views.push_back(fitted_view(fit.lens, board, views[i], transform(rvecs[i], tvecs[i])));
    sum += fit.views.back().rms_px * fit.views.back().rms_px * static_cast<double>(views[i].view.ids.size());
    count += views[i].view.ids.size();
  }
  fit.rms_px = std::sqrt(sum / static_cast<double>(count));
  return fit;
}

}  // namespace pickcell::poses
