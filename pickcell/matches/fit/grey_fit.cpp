#include "pickcell/matches/fit/grey_fit.hpp"

#include <algorithm>
#include <cmath>

#include "pickcell/matches/fit/point_kernels.hpp"

namespace pickcell::matches {
namespace {

constexpr double kLeastContrast = 1.0;  // grey values; flatter scenes have no correlation
constexpr double kLeastGain = 0.02;
constexpr int kReweighings = 2;
constexpr float kOutlierSigmas = 4;

bool inside(image::ImageView p, float x, float y) {
  return x >= kInsideMargin_px && y >= kInsideMargin_px && x <= static_cast<float>(p.width() - 1) - kInsideMargin_px &&
         y <= static_cast<float>(p.height() - 1) - kInsideMargin_px;
}

bool all_inside(image::ImageView level, const GreyPoints& p, const LevelMap& m) {
  for (const float qx : {p.x_lo, p.x_hi})
    for (const float qy : {p.y_lo, p.y_hi})
      if (!inside(level, m.x + m.a * qx + m.b * qy, m.y - m.b * qx + m.a * qy)) return false;
  return true;
}

/// Everything inside: sums against the centred columns, and the constant inverse.
GreyFit fit_constant(image::ImageView level, const GreyPoints& p, const LevelMap& m) {
  const PointSums sums = sum_points(level, p.columns(), m);
  const double n = p.size();
  const double variance = std::max(0.0, sums.ss / n - sums.s / n * (sums.s / n));
  GreyFit fit;
  fit.inside = 1;
  fit.contrast = std::sqrt(variance);
  if (fit.contrast < kLeastContrast || p.energy <= 0) return fit;  // a flat template has no correlation either
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
void correlate(const GreyPoints& p, const WeightedSamples& scratch, GreyFit& fit) {
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

void take_step(const WeightedSolution& s, GreyFit& fit) {
  fit.gain = s.ok ? s.gain : 0;
  fit.can_step = fit.gain > kLeastGain;
  if (fit.can_step) fit.step = {s.step[0] / s.gain, s.step[1] / s.gain, s.step[2] / s.gain, s.step[3] / s.gain};
}

}  // namespace

GreyFit fit_grey(image::ImageView level, const GreyPoints& p, const LevelMap& m, WeightedSamples& scratch) {
  if (all_inside(level, p, m)) return fit_constant(level, p, m);
  GreyFit fit;
  fit.inside = read_samples(level, p, m, scratch);
  correlate(p, scratch, fit);
  if (fit.ncc > -1) take_step(solve_weighted(p, scratch), fit);
  return fit;
}

GreyFit fit_grey_robust(image::ImageView level, const GreyPoints& p, const LevelMap& m, WeightedSamples& scratch) {
  GreyFit fit;
  fit.inside = read_samples(level, p, m, scratch);
  WeightedSolution s = solve_weighted(p, scratch);
  for (int round = 0; round < kReweighings && s.ok; ++round) {
    weigh_by_residual(p, kOutlierSigmas * robust_noise(p, s, scratch), scratch);
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

}  // namespace pickcell::matches
