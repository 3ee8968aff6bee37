#include "pickcell/matches/fit/fit_quality.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

namespace pickcell::matches {
namespace {

constexpr double kAgreeSigmas = 3;
constexpr double kAgreeContrast = 0.5;  // a residual below half the part's own contrast agrees in any case
constexpr int kFewestPoints = 12;
constexpr double kLeastGain = 0.02;

/// The fit without outliers at a place that is not moved any more.
WeightedSolution robust_solution(const GreyPoints& p, WeightedSamples& samples) {
  WeightedSolution s = solve_weighted(p, samples);
  for (int round = 0; round < 2 && s.ok; ++round) {
    weigh_by_residual(p, 4 * robust_noise(p, s, samples), samples);
    const WeightedSolution better = solve_weighted(p, samples);
    if (better.ok) s = better;
  }
  return s;
}

}  // namespace

FitQuality judge_fit(image::ImageView level, const GreyPoints& p, const GreyPoints& few, const LevelMap& m,
                     WeightedSamples& samples) {
  FitQuality q;
  const GreyPoints& enough = few.size() > 0 ? few : p;  // for gain, offset and noise
  read_samples(level, enough, m, samples);
  const WeightedSolution s = robust_solution(enough, samples);
  if (!s.ok) return q;
  const double contrast = std::abs(s.gain) * std::sqrt(p.energy / p.size());
  const double noise = static_cast<double>(robust_noise(enough, s, samples));
  const auto limit = static_cast<float>(std::max(kAgreeSigmas * noise, kAgreeContrast * contrast));
  read_samples(level, p, m, samples);
  const Agreement agree = keep_agreeing(p.columns(), samples.scene.data(), static_cast<float>(s.offset),
                                        static_cast<float>(s.gain), limit, samples.weight.data());
  q.visible = static_cast<double>(agree.points) / p.size();
  if (agree.points < kFewestPoints || s.gain <= kLeastGain) return q;
  q.noise = std::sqrt(agree.square / (agree.points - 6));
  Vector6 right;
  const Eigen::FullPivLU<Matrix6> lu(weighted_normal(p, samples, right));
  if (!lu.isInvertible()) return q;
  // Samples of dense points share pixels: they are fewer independent values than points.
  const double shared = 1 + 1.25 / p.pixels_per_point;
  const Vector6 best = lu.solve(right);
  if (best[1] > kLeastGain) q.step = {best[2] / best[1], best[3] / best[1], best[4] / best[1], best[5] / best[1]};
  q.covariance = lu.inverse().bottomRightCorner<4, 4>() * (q.noise * q.noise * shared / (s.gain * s.gain));
  return q;
}

}  // namespace pickcell::matches
