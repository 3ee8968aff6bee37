/// By how much the arm's poses are wrong: what the pictures ask of them, less what the pictures themselves do not know.

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>

#include "pickcell/core/units.hpp"
#include "pickcell/poses/handeye_problem.hpp"

namespace pickcell::poses::detail {

namespace {

using Vector6 = Eigen::Matrix<double, 6, 1>;  ///< translation (m), rotation vector (rad), in the arm's own frame
using Matrix6 = Eigen::Matrix<double, 6, 6>;

/// One picture's demand on the arm's pose and the covariance of the picture's part in it.
struct Demand {
  Vector6 error = Vector6::Zero();
  Matrix6 covariance = Matrix6::Zero();
};

Eigen::Isometry3d small_motion(const Vector6& d) {
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  const Eigen::Vector3d w = d.tail<3>();
  if (w.norm() > 0) T.linear() = Eigen::AngleAxisd(w.norm(), w.normalized()).toRotationMatrix();
  T.translation() = d.head<3>();
  return T;
}

/// Derivatives of the board's pixels by an error of the arm's pose, around the pose that the picture asks for.
Eigen::MatrixXd derivatives(const Lens& lens, const std::vector<Eigen::Vector2d>& board_m, const Station& s,
                            const HandEye& result, Mounting mounting) {
  const bool on_arm = mounting == Mounting::eye_in_hand;
  // The pixel of p is that of A^-1 * exp(-d) * A * B * p; beside the arm the board moves instead, with +d.
  const Eigen::Isometry3d A = on_arm ? result.X : result.Y * s.T_camera_board.inverse();
  const Eigen::Isometry3d to = A * s.T_camera_board, back = A.inverse();
  const auto pixel = [&](const Vector6& d, int id) {
    const Eigen::Vector2d& b = board_m[static_cast<std::size_t>(id)];
    const Eigen::Vector3d p = back * (small_motion(on_arm ? Vector6(-d) : d) * (to * Eigen::Vector3d(b.x(), b.y(), 0)));
    return project(lens, {p.x() / p.z(), p.y() / p.z()});
  };
  constexpr double kStep = 1e-6;
  Eigen::MatrixXd J(2 * static_cast<Eigen::Index>(s.view.ids.size()), 6);
  for (Eigen::Index i = 0; i < J.rows() / 2; ++i)
    for (int k = 0; k < 6; ++k) {
      const int id = s.view.ids[static_cast<std::size_t>(i)];
      const Vector6 step = kStep * Vector6::Unit(k);
      J.block<2, 1>(2 * i, k) = (pixel(step, id) - pixel(-step, id)) / (2 * kStep);
    }
  return J;
}

/// Variance of a pixel's coordinate, from what the boards' own poses leave over.
double pixel_variance(const Stations& stations) {
  double sum = 0, freedom = 0;
  for (const Station& s : stations) {
    const double n = static_cast<double>(s.view.ids.size());
    sum += n * s.picture_rms_px * s.picture_rms_px;
    freedom += 2 * n - 6;
  }
  return std::max(1e-6, sum / std::max(1.0, freedom));
}

std::vector<Demand> demands(const Lens& lens, const std::vector<Eigen::Vector2d>& board_m, const Stations& stations,
                            const HandEye& result, Mounting mounting) {
  const double variance = pixel_variance(stations);
  const double n = static_cast<double>(stations.size());
  const double taken_by_fit = std::sqrt(6 * n / std::max(6.0, 6 * n - 12));
  std::vector<Demand> out;
  for (const Station& s : stations) {
    Demand d;
    const Eigen::Isometry3d off = asked_of_arm(s, s.move, result, mounting);
    const Eigen::AngleAxisd turn(off.linear());
    d.error << off.translation(), turn.angle() * turn.axis();
    d.error *= taken_by_fit;
    const Eigen::MatrixXd J = derivatives(lens, board_m, s, result, mounting);
    Matrix6 H = J.transpose() * J / variance;
    H.diagonal() *= 1 + 1e-9;
    d.covariance = H.ldlt().solve(Matrix6::Identity());
    out.push_back(d);
  }
  return out;
}

/// Variances of an error of this RMS length.
Vector6 prior(const ArmError& size) {
  Vector6 v;
  v.head<3>().setConstant(std::pow(core::m_from_mm(size.mm), 2) / 3);
  v.tail<3>().setConstant(std::pow(core::rad_from_deg(size.deg), 2) / 3);
  return v;
}

/// What explains the demands: errors of the arm, and how much worse than their pixels' noise the pictures are (a lens
/// or a board that is not quite as calibrated bends a board's pose where no residual shows it).
struct Account {
  ArmError arm;
  double pictures = 1;  ///< factor of standard deviations
};

double minus_log_likelihood(const std::vector<Demand>& demands, const Account& account) {
  const Vector6 variances = prior(account.arm);
  double sum = 0;
  for (const Demand& d : demands) {
    Matrix6 S = account.pictures * account.pictures * d.covariance;
    S.diagonal() += variances;
    const Eigen::LLT<Matrix6> llt(S);
    const Vector6 whitened = llt.matrixL().solve(d.error);
    sum += whitened.squaredNorm() + 2 * llt.matrixLLT().diagonal().array().log().sum();
  }
  return sum;
}

/// The likeliest account: a coarse grid, then ever smaller steps. The factor of the pictures is sought where allowed.
Account likeliest(const std::vector<Demand>& demands, double most_pictures) {
  const auto sizes = [](double least, double most) {
    std::vector<double> out;
    for (double s = least; s <= most; s *= 2) out.push_back(s);
    return out;
  };
  Account best;
  double least = std::numeric_limits<double>::max();
  const auto consider = [&](const Account& account) {
    const double cost = minus_log_likelihood(demands, account);
    if (cost >= least) return;
    least = cost;
    best = account;
  };
  for (const double mm : sizes(0.005, 300))
    for (const double deg : sizes(0.0005, 60))
      for (const double pictures : sizes(1, most_pictures)) consider({{mm, deg}, pictures});
  for (double factor = 1.4; factor > 1.02; factor = std::sqrt(factor)) {
    const Account around = best;
    for (const double a : {1 / factor, 1.0, factor})
      for (const double b : {1 / factor, 1.0, factor})
        for (const double c : {1 / factor, 1.0, factor}) {
          const double pictures = std::clamp(around.pictures * c, 1.0, most_pictures);
          consider({{around.arm.mm * a, around.arm.deg * b}, pictures});
        }
  }
  return best;
}

}  // namespace

Eigen::Isometry3d asked_of_arm(const Station& station, const Eigen::Isometry3d& move, const HandEye& result,
                               Mounting mounting) {
  const Eigen::Isometry3d wanted = result.Y * (result.X * station.T_camera_board).inverse();
  return mounting == Mounting::eye_in_hand ? move.inverse() * wanted : move * wanted.inverse();
}

ArmErrors arm_errors(const Lens& lens, const std::vector<Eigen::Vector2d>& board_m, const Stations& stations,
                     const HandEye& result, Mounting mounting) {
  constexpr std::size_t kEnough = 6;  // to tell an error of the pictures from one of the arm
  constexpr double kMostPictures = 64;
  const auto all = demands(lens, board_m, stations, result, mounting);
  const Account account = likeliest(all, all.size() < kEnough ? 1 : kMostPictures);
  ArmErrors out;
  out.rms = account.arm;
  for (Demand d : all) {
    d.covariance *= account.pictures * account.pictures;
    const Vector6 variances = prior(likeliest({d}, 1).arm);
    Matrix6 S = d.covariance;
    S.diagonal() += variances;
    const Vector6 error = variances.asDiagonal() * S.ldlt().solve(d.error);
    out.each.push_back({core::mm_from_m(error.head<3>().norm()), core::deg_from_rad(error.tail<3>().norm())});
  }
  return out;
}

}  // namespace pickcell::poses::detail
