#include "pickcell/matches/weighted_fit.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>

#include "pickcell/matches/point_kernels.hpp"

namespace pickcell::matches {
namespace {

constexpr float kLeastNoise = 4.f;  // grey values; below it a residual is no reason to mistrust a point
constexpr float kTrace = 1e-6f;

float residual(const GreyPoints& p, const WeightedSamples& samples, const WeightedSolution& fit, std::size_t i) {
  return samples.scene[i] - static_cast<float>(fit.offset) - static_cast<float>(fit.gain) * p.t[i];
}

}  // namespace

double read_samples(image::ImageView level, const GreyPoints& p, const LevelMap& m, WeightedSamples& out) {
  out.scene.resize(p.qx.size());
  out.weight.resize(p.qx.size());
  sample_points(level, p.columns(), m, out.scene.data(), out.weight.data());
  const auto n = static_cast<std::size_t>(p.size());
  std::fill(out.weight.begin() + p.size(), out.weight.end(), 0.f);
  std::size_t in = 0;
  for (std::size_t i = 0; i < n; ++i) in += out.weight[i] > 0 ? 1 : 0;
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

float robust_noise(const GreyPoints& p, const WeightedSamples& samples, const WeightedSolution& fit) {
  constexpr int kBins = 1024;
  constexpr float kPerGrey = 4;
  std::array<int, kBins> histogram{};
  int n = 0;
  for (std::size_t i = 0; i < static_cast<std::size_t>(p.size()); ++i) {
    if (samples.weight[i] == 0.f) continue;
    ++histogram[static_cast<std::size_t>(std::min(kBins - 1.f, kPerGrey * std::abs(residual(p, samples, fit, i))))];
    ++n;
  }
  int below = 0;
  std::size_t bin = 0;
  while (bin + 1 < kBins && 2 * (below + histogram[bin]) < n) below += histogram[bin++];
  const int here = std::max(1, histogram[bin]);
  const float median = (static_cast<float>(bin) +
                        (0.5f * static_cast<float>(n) - static_cast<float>(below)) / static_cast<float>(here)) /
                       kPerGrey;
  return std::max(kLeastNoise, 1.4826f * median);
}

void weigh_by_residual(const GreyPoints& p, const WeightedSolution& fit, float cut, WeightedSamples& samples) {
  for (std::size_t i = 0; i < static_cast<std::size_t>(p.size()); ++i) {
    if (samples.weight[i] == 0.f) continue;
    const float r = residual(p, samples, fit, i) / cut;
    const float u = std::max(0.f, 1 - r * r);
    samples.weight[i] = std::max(kTrace, u * u);
  }
}

}  // namespace pickcell::matches
