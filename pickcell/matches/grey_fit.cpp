#include "pickcell/matches/grey_fit.hpp"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "pickcell/matches/point_kernels.hpp"
#include "pickcell/matches/sampling.hpp"

namespace pickcell::matches {
namespace {

constexpr double kLeastContrast = 1.0;  // grey values; flatter scenes have no correlation
constexpr double kLeastGain = 0.02;
constexpr float kLeastNoise = 1.0f;
using Matrix6 = Eigen::Matrix<double, 6, 6>;
using Vector6 = Eigen::Matrix<double, 6, 1>;

bool all_inside(image::ImageView level, const GreyPoints& p, const LevelMap& m) {
  for (const float qx : {p.x_lo, p.x_hi})
    for (const float qy : {p.y_lo, p.y_hi})
      if (!inside(level, m.x + m.a * qx + m.b * qy, m.y - m.b * qx + m.a * qy)) return false;
  return true;
}

/// Fills scratch.scene, and scratch.weight with 1 inside and 0 outside the picture. Returns the share inside.
double sample(image::ImageView level, const GreyPoints& p, const LevelMap& m, GreyScratch& scratch) {
  scratch.scene.resize(p.qx.size());
  scratch.weight.resize(p.qx.size());
  sample_points(level, p.columns(), m, scratch.scene.data(), scratch.weight.data());
  int in = 0;
  for (std::size_t i = 0; i < static_cast<std::size_t>(p.size()); ++i) in += scratch.weight[i] > 0 ? 1 : 0;
  return static_cast<double>(in) / p.size();
}

/// Everything inside: sums against the centred columns, and the constant inverse.
GreyFit fit_constant(image::ImageView level, const GreyPoints& p, const LevelMap& m) {
  const PointSums sums = sum_points(level, p.columns(), m);
  const double n = p.size();
  const double variance = std::max(0.0, sums.ss / n - sums.s / n * (sums.s / n));
  GreyFit fit;
  fit.inside = 1;
  fit.contrast = std::sqrt(variance);
  if (fit.contrast < kLeastContrast) return fit;
  fit.ncc = sums.st / std::sqrt(variance * n * p.energy);
  Eigen::Matrix<double, 5, 1> v;
  v << sums.st, sums.sj[0], sums.sj[1], sums.sj[2], sums.sj[3];
  const Eigen::Matrix<double, 5, 1> s = p.inverse * v;
  fit.gain = s[0];
  fit.can_step = fit.gain > kLeastGain;
  if (fit.can_step) fit.step = {s[1] / s[0], s[2] / s[0], s[3] / s[0], s[4] / s[0]};
  return fit;
}

/// Weighted correlation of the samples with t.
void correlate(const GreyPoints& p, const GreyScratch& scratch, GreyFit& fit) {
  double w = 0, s = 0, ss = 0, t = 0, tt = 0, st = 0;
  for (std::size_t i = 0; i < static_cast<std::size_t>(p.size()); ++i) {
    if (scratch.weight[i] == 0.f) continue;
    const double a = scratch.scene[i];
    const double b = p.t[i];
    w += 1;
    s += a;
    ss += a * a;
    t += b;
    tt += b * b;
    st += a * b;
  }
  if (w < 12) return;
  const double var_s = std::max(0.0, ss / w - s / w * (s / w));
  const double var_t = std::max(0.0, tt / w - t / w * (t / w));
  fit.contrast = std::sqrt(var_s);
  if (fit.contrast < kLeastContrast || var_t < 1e-6) return;
  fit.ncc = (st / w - s / w * (t / w)) / std::sqrt(var_s * var_t);
}

struct Solution {
  bool ok = false;
  Vector6 x;  ///< offset, gain, gain * d
};

Matrix6 weighted_normal(const GreyPoints& p, const GreyScratch& scratch, Vector6& right) {
  Matrix6 A = Matrix6::Zero();
  right.setZero();
  for (std::size_t i = 0; i < static_cast<std::size_t>(p.size()); ++i) {
    const double w = scratch.weight[i];
    if (w == 0) continue;
    const double row[6] = {1, p.t[i], p.j[0][i], p.j[1][i], p.j[2][i], p.j[3][i]};
    for (int a = 0; a < 6; ++a) {
      const double wa = w * row[a];
      for (int b = 0; b <= a; ++b) A(a, b) += wa * row[b];
      right[a] += wa * static_cast<double>(scratch.scene[i]);
    }
  }
  A.triangularView<Eigen::StrictlyUpper>() = A.transpose();
  return A;
}

Solution solve_weighted(const GreyPoints& p, const GreyScratch& scratch) {
  Vector6 right;
  Matrix6 A = weighted_normal(p, scratch, right);
  for (int k = 2; k < 6; ++k) A(k, k) *= 1.0001;
  const Eigen::LDLT<Matrix6> ldlt(A);
  Solution s;
  if (ldlt.info() != Eigen::Success || ldlt.rcond() < 1e-14) return s;
  s.x = ldlt.solve(right);
  s.ok = s.x.allFinite();
  return s;
}

void take_step(const Solution& s, GreyFit& fit) {
  fit.gain = s.ok ? s.x[1] : 0;
  fit.can_step = fit.gain > kLeastGain;
  if (fit.can_step) fit.step = {s.x[2] / s.x[1], s.x[3] / s.x[1], s.x[4] / s.x[1], s.x[5] / s.x[1]};
}

/// Residuals against gain * t + offset (without the step), absolute; 1.48 times their median over points inside.
float robust_noise(const GreyPoints& p, const GreyScratch& scratch, double offset, double gain,
                   std::vector<float>& absolute) {
  absolute.clear();
  for (std::size_t i = 0; i < static_cast<std::size_t>(p.size()); ++i)
    if (scratch.weight[i] > 0)
      absolute.push_back(std::abs(scratch.scene[i] - static_cast<float>(offset) - static_cast<float>(gain) * p.t[i]));
  if (absolute.empty()) return kLeastNoise;
  const auto middle = absolute.begin() + static_cast<std::ptrdiff_t>(absolute.size() / 2);
  std::nth_element(absolute.begin(), middle, absolute.end());
  return std::max(kLeastNoise, 1.4826f * *middle);
}

void tukey(const GreyPoints& p, double offset, double gain, float cut, GreyScratch& scratch) {
  for (std::size_t i = 0; i < static_cast<std::size_t>(p.size()); ++i) {
    if (scratch.weight[i] == 0.f) continue;
    const float r = (scratch.scene[i] - static_cast<float>(offset) - static_cast<float>(gain) * p.t[i]) / cut;
    const float u = 1 - r * r;
    scratch.weight[i] = u > 0 ? std::max(1e-6f, u * u) : 1e-6f;
  }
}

}  // namespace

GreyFit fit_grey(image::ImageView level, const GreyPoints& p, const LevelMap& m, GreyScratch& scratch) {
  if (all_inside(level, p, m)) return fit_constant(level, p, m);
  GreyFit fit;
  fit.inside = sample(level, p, m, scratch);
  correlate(p, scratch, fit);
  if (fit.ncc > -1) take_step(solve_weighted(p, scratch), fit);
  return fit;
}

GreyFit fit_grey_robust(image::ImageView level, const GreyPoints& p, const LevelMap& m, GreyScratch& scratch) {
  GreyFit fit;
  fit.inside = sample(level, p, m, scratch);
  correlate(p, scratch, fit);
  if (fit.ncc <= -1) return fit;
  Solution s = solve_weighted(p, scratch);
  std::vector<float> absolute;
  for (int round = 0; round < 3 && s.ok; ++round) {
    const float noise = robust_noise(p, scratch, s.x[0], s.x[1], absolute);
    tukey(p, s.x[0], s.x[1], 4 * noise, scratch);
    s = solve_weighted(p, scratch);
  }
  take_step(s, fit);
  return fit;
}

double rim_movement(const Increment& d, float radius) {
  return std::hypot(d.dx, d.dy) + std::hypot(d.turn_rad, d.growth) * static_cast<double>(radius) * 0.7;
}

Increment limited(const Increment& d, float radius, double limit_px) {
  const double rim = rim_movement(d, radius);
  if (rim <= limit_px) return d;
  const double k = limit_px / rim;
  return {d.dx * k, d.dy * k, d.turn_rad * k, d.growth * k};
}

FitQuality judge_fit(image::ImageView level, const GreyPoints& p, const LevelMap& m, GreyScratch& scratch) {
  FitQuality q;
  sample(level, p, m, scratch);
  Solution s = solve_weighted(p, scratch);
  if (!s.ok) return q;
  std::vector<float> absolute;
  for (int round = 0; round < 2; ++round) {
    tukey(p, s.x[0], s.x[1], 4 * robust_noise(p, scratch, s.x[0], s.x[1], absolute), scratch);
    const Solution better = solve_weighted(p, scratch);
    if (better.ok) s = better;
  }
  const double gain = s.x[1];
  const float noise = robust_noise(p, scratch, s.x[0], gain, absolute);
  // A point agrees when its residual is explained by the noise, or is small against the part's own contrast.
  const double contrast = std::abs(gain) * std::sqrt(p.energy / p.size());
  const auto limit = static_cast<float>(std::max(3.0 * static_cast<double>(noise), 0.5 * contrast));
  std::size_t agree = 0;
  double square = 0;
  for (std::size_t i = 0; i < static_cast<std::size_t>(p.size()); ++i) {
    if (scratch.weight[i] == 0.f) continue;
    const float r = scratch.scene[i] - static_cast<float>(s.x[0]) - static_cast<float>(gain) * p.t[i];
    scratch.weight[i] = std::abs(r) <= limit ? 1.f : 0.f;
    if (std::abs(r) > limit) continue;
    ++agree;
    square += static_cast<double>(r) * r;
  }
  q.visible = static_cast<double>(agree) / p.size();
  if (agree < 12 || gain <= kLeastGain) return q;
  q.noise = std::sqrt(square / static_cast<double>(agree - 6));
  Vector6 unused;
  const Matrix6 A = weighted_normal(p, scratch, unused);
  const Eigen::FullPivLU<Matrix6> lu(A);
  if (!lu.isInvertible()) return q;
  // Neighbouring samples share pixels when the points are dense: fewer independent values than points.
  const double shared = 1 + 1.25 / p.pixels_per_point;
  q.covariance = lu.inverse().bottomRightCorner<4, 4>() * (q.noise * q.noise * shared / (gain * gain));
  return q;
}

}  // namespace pickcell::matches
