#include <ceres/ceres.h>
#include <ceres/rotation.h>

#include "pickcell/poses/handeye_problem.hpp"

namespace pickcell::poses::detail {

namespace {

/// Angle-axis and translation.
using Parameters = std::array<double, 6>;

Parameters parameters_of(const Eigen::Isometry3d& T) {
  Parameters out;
  const Eigen::Matrix3d R = T.linear();
  ceres::RotationMatrixToAngleAxis(R.data(), out.data());
  for (std::size_t i = 0; i < 3; ++i) out[3 + i] = T.translation()[static_cast<Eigen::Index>(i)];
  return out;
}

Eigen::Isometry3d transform_of(const Parameters& p) {
  Eigen::Isometry3d out = Eigen::Isometry3d::Identity();
  Eigen::Matrix3d R;
  ceres::AngleAxisToRotationMatrix(p.data(), R.data());
  out.linear() = R;
  out.translation() = Eigen::Vector3d(p[3], p[4], p[5]);
  return out;
}

/// All points of one station: p_camera = X^-1 * M^-1 * Y * p_board, through the lens.
struct StationCost {
  const Lens& lens;
  const std::vector<Eigen::Vector2d>& board_m;
  const Station& station;

  template <class T>
  bool operator()(const T* X, const T* Y, T* residual) const {
    const Eigen::Isometry3d back = station.move.inverse();
    const T minus_X[3] = {-X[0], -X[1], -X[2]};
    for (std::size_t i = 0; i < station.view.ids.size(); ++i) {
      const Eigen::Vector2d& b = board_m[static_cast<std::size_t>(station.view.ids[i])];
      const T p_board[3] = {T(b.x()), T(b.y()), T(0)};
      T p[3], q[3], camera[3];
      ceres::AngleAxisRotatePoint(Y, p_board, p);
      for (int k = 0; k < 3; ++k) p[k] += Y[3 + k];
      for (int r = 0; r < 3; ++r)
        q[r] = back.linear()(r, 0) * p[0] + back.linear()(r, 1) * p[1] + back.linear()(r, 2) * p[2] +
               back.translation()[r] - X[3 + r];
      ceres::AngleAxisRotatePoint(minus_X, q, camera);
      if (camera[2] < T(1e-6)) return false;
      project_onto(camera, station.view.pixels[i], residual + 2 * i);
    }
    return true;
  }

  template <class T>
  void project_onto(const T* camera, const Eigen::Vector2d& seen, T* residual) const {
    const auto& [k1, k2, p1, p2, k3, k4, k5, k6] = lens.distortion;
    const T x = camera[0] / camera[2], y = camera[1] / camera[2], r2 = x * x + y * y;
    const T radial = (1.0 + r2 * (k1 + r2 * (k2 + r2 * k3))) / (1.0 + r2 * (k4 + r2 * (k5 + r2 * k6)));
    const T u = x * radial + 2.0 * p1 * x * y + p2 * (r2 + 2.0 * x * x);
    const T v = y * radial + p1 * (r2 + 2.0 * y * y) + 2.0 * p2 * x * y;
    residual[0] = lens.fx_px * u + lens.cx_px - seen.x();
    residual[1] = lens.fy_px * v + lens.cy_px - seen.y();
  }
};

}  // namespace

HandEye refine(const Lens& lens, const std::vector<Eigen::Vector2d>& board_m, const Stations& stations,
               const HandEye& start) {
  // Ceres complains on stderr about a start that cannot be evaluated: points behind the camera.
  for (const Station& s : stations) {
    const Eigen::Isometry3d T_camera_board = (s.move * start.X).inverse() * start.Y;
    for (const int id : s.view.ids) {
      const Eigen::Vector2d& b = board_m[static_cast<std::size_t>(id)];
      if ((T_camera_board * Eigen::Vector3d(b.x(), b.y(), 0)).z() < 1e-5) return start;
    }
  }
  Parameters X = parameters_of(start.X), Y = parameters_of(start.Y);
  ceres::Problem problem;
  for (const Station& s : stations) {
    using Cost = ceres::AutoDiffCostFunction<StationCost, ceres::DYNAMIC, 6, 6>;
    problem.AddResidualBlock(new Cost(new StationCost{lens, board_m, s}, static_cast<int>(2 * s.view.ids.size())),
                             nullptr, X.data(), Y.data());
  }
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_QR;
  options.max_num_iterations = 100;
  options.function_tolerance = 1e-12;
  options.parameter_tolerance = 1e-12;
  options.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  if (!summary.IsSolutionUsable()) return start;
  return {transform_of(X), transform_of(Y)};
}

}  // namespace pickcell::poses::detail
