#include "pickcell/matches/fit/weighted_fit.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>

#include "pickcell/matches/fit/histogram_median.hpp"
#include "pickcell/matches/fit/point_kernels.hpp"

namespace pickcell::matches {
namespace {

constexpr float kLeastNoise = 4.f;  // grey values; below it a residual is no reason to mistrust a point
constexpr float kTrace = 1e-6f;
constexpr float kBinsPerGrey = 4;
constexpr int kEnoughForNoise = 2000;  // points: of more, every fourth tells the median

/// The points lie at scattered places: asked for row by row, the pixels come from far memory many at a time.
void fetch_under(image::ImageView level, const GreyPoints& p, const LevelMap& m) {
  constexpr int kLine = 64;
  const PixelBox box = box_under(p.x_lo, p.x_hi, p.y_lo, p.y_hi, m);
  const int x0 = std::max(0, box.x0), x1 = std::min(level.width() - 1, box.x1);
  for (int y = std::max(0, box.y0); y <= std::min(level.height() - 1, box.y1); ++y)
    for (int x = x0; x < x1 + kLine; x += kLine) __builtin_prefetch(level.row(y) + std::min(x, x1));
}

}  // namespace

double read_samples(image::ImageView level, const GreyPoints& p, const LevelMap& m, WeightedSamples& out) {
  out.scene.resize(p.qx.size());
  out.weight.resize(p.qx.size());
  fetch_under(level, p, m);
  const int in = sample_points(level, p.columns(), m, out.scene.data(), out.weight.data());
  std::fill(out.weight.begin() + p.size(), out.weight.end(), 0.f);
  return static_cast<double>(in) / p.size();
}

Matrix6 weighted_normal(const GreyPoints& p, const WeightedSamples& samples, Vector6& right) {
  std::array<float, 27> sums{};
  sum_weighted(p.columns(), samples.scene.data(), samples.weight.data(), sums.data());
  Matrix6 A;
  std::size_t k = 0;
  for (int a = 0; a < 6; ++a)
    for (int b = a; b < 6; ++b) A(a, b) = A(b, a) = static_cast<double>(sums[k++]);
  for (int a = 0; a < 6; ++a) right[a] = static_cast<double>(sums[k++]);
  return A;
}

WeightedSolution solve_weighted(const GreyPoints& p, const WeightedSamples& samples) {
  Vector6 right;
  Matrix6 A = weighted_normal(p, samples, right);
  for (int k = 2; k < 6; ++k) A(k, k) *= 1.0001;  // round parts (no torque) stay solvable
  const Eigen::LDLT<Matrix6> ldlt(A);
  WeightedSolution s;
  if (ldlt.info() != Eigen::Success || ldlt.rcond() < 1e-14) return s;
  const Vector6 x = ldlt.solve(right);
  s.ok = x.allFinite();
  s.offset = x[0] + 128;
  s.gain = x[1];
  s.step = x.tail<4>();
  return s;
}

float robust_noise(const GreyPoints& p, const WeightedSolution& fit, WeightedSamples& samples) {
  samples.residual.resize(samples.scene.size());
  residual_sizes(p.columns(), samples.scene.data(), static_cast<float>(fit.offset), static_cast<float>(fit.gain),
                 samples.residual.data());
  HistogramMedian<1024> sizes(kBinsPerGrey);
  const std::size_t stride = p.size() > kEnoughForNoise ? 4 : 1;
  for (std::size_t i = 0; i < static_cast<std::size_t>(p.size()); i += stride)
    if (samples.weight[i] != 0.f) sizes.add(samples.residual[i]);
  return std::max(kLeastNoise, 1.4826f * sizes.median());
}

void weigh_by_residual(const GreyPoints& p, float cut, WeightedSamples& samples) {
  weigh_points(samples.residual.data(), cut, kTrace, p.size(), samples.weight.data());
}

}  // namespace pickcell::matches
