#pragma once
/// For experiments on exactness: one part searched for in many pictures whose poses are known to any digit.

#include <Eigen/Core>
#include <cmath>
#include <memory>
#include <utility>

#include "pickcell/image/pyramid.hpp"
#include "pickcell/matches/engine.hpp"

namespace pickcell::cli {

using PoseError = Eigen::Vector4d;  ///< x px, y px, angle degrees, scale

/// One model and engine best.
class PoseFinder {
 public:
  explicit PoseFinder(matches::Model model) : model_(std::move(model)) {
    engine_ = std::move(*matches::make_engine("best", {}));
  }
  /// Whether it was found (within 3 px, 2 degrees, 3 %); error and covariance then.
  bool find(const image::Image& picture, const matches::Pose2d& truth, PoseError& error, Eigen::Matrix4d& covariance) {
    pyramid_.build(picture.view());
    matches::SearchOptions options;
    options.min_score = 0;
    const matches::Model* one[] = {&model_};
    const auto found = engine_->find(pyramid_, one, options);
    if (!found || found->matches.empty()) return false;
    const matches::Match& m = found->matches.front();
    error = {m.pose.x_px - truth.x_px, m.pose.y_px - truth.y_px,
             std::remainder(m.pose.angle_deg - truth.angle_deg, 360.0), m.pose.scale - truth.scale};
    covariance = m.covariance;
    return std::hypot(error[0], error[1]) < 3 && std::abs(error[2]) < 2 && std::abs(error[3]) < 0.03;
  }

 private:
  matches::Model model_;
  std::unique_ptr<matches::Engine> engine_;
  image::Pyramid pyramid_;
};

}  // namespace pickcell::cli
