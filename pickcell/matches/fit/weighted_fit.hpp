#pragma once
/// The linear fit behind robust Gauss-Newton: scene = offset + gain t + gain J d, each point with its weight.

#include <Eigen/Core>
#include <vector>

#include "pickcell/image/image.hpp"
#include "pickcell/matches/fit/grey_points.hpp"
#include "pickcell/matches/similarity.hpp"

namespace pickcell::matches {

/// The picture at the points of one place, and the weight of each; padded like GreyPoints, with weight 0.
struct WeightedSamples {
  std::vector<float> scene;
  std::vector<float> weight;
  std::vector<float> residual;  ///< of the last robust_noise: |scene - offset - gain t|
};

/// Reads the points: weight 1 inside the picture, 0 outside. Returns the share inside.
double read_samples(image::ImageView level, const GreyPoints& points, const LevelMap& map, WeightedSamples& out);

using Matrix6 = Eigen::Matrix<double, 6, 6>;
using Vector6 = Eigen::Matrix<double, 6, 1>;

/// Normal matrix of the columns (1, t, J) and, in right, its right side for the scene less 128.
[[nodiscard]] Matrix6 weighted_normal(const GreyPoints& points, const WeightedSamples& samples, Vector6& right);

struct WeightedSolution {
  bool ok = false;
  double offset = 0;
  double gain = 0;
  Eigen::Vector4d step = Eigen::Vector4d::Zero();  ///< gain * d
};
[[nodiscard]] WeightedSolution solve_weighted(const GreyPoints& points, const WeightedSamples& samples);

/// 1.48 times the median of |scene - offset - gain t| over points of weight > 0, at least a little; in grey values.
/// Leaves the residuals in the samples.
[[nodiscard]] float robust_noise(const GreyPoints& points, const WeightedSolution& fit, WeightedSamples& samples);

/// Tukey's biweight of the residuals that robust_noise left: weight (1 - (residual / cut)^2)^2 for points inside the
/// picture; outliers keep a trace, so that they still count as inside.
void weigh_by_residual(const GreyPoints& points, float cut, WeightedSamples& samples);

}  // namespace pickcell::matches
