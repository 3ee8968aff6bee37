#pragma once
/// What the matcher found, and what it turned down.

#include <Eigen/Core>
#include <string>
#include <vector>

namespace pickcell::matches {

/// Place of a model's reference point in the scene: scene = c + s*R(a)*(t - t_ref), R(a) = [[cos a, sin a],[-sin a, cos
/// a]]. Pixels of the searched picture, centres at integers; degrees counter-clockwise on the screen, (-180, 180];
/// scale 1 is the taught size.
struct Pose2d {
  double x_px = 0;
  double y_px = 0;
  double angle_deg = 0;
  double scale = 1;
};

struct Match {
  std::string model;    ///< Model::name
  int model_index = 0;  ///< place in the list that was searched for
  Pose2d pose;
  double score = 0;  ///< 0..1, of the reported pose
  /// Of (x_px, y_px, angle_deg, scale), from the final fit and the residual noise.
  Eigen::Matrix4d covariance = Eigen::Matrix4d::Zero();
  double visible = 1;  ///< fraction of the part that is in the picture and agrees
  std::vector<double>
      ambiguous_deg;  ///< other angles (offsets, degrees) that fit as well; empty when the angle is certain
};

enum class RejectReason { score, overlap, contrast, border, budget, scale, limit };
[[nodiscard]] const char* name(RejectReason reason);

/// best: coarse, fine, final. rst and erst: the filters of the paper in their order, and the merging.
enum class Stage { coarse, fine, final, circular, radial, templates, robust, merge };
[[nodiscard]] const char* name(Stage stage);

struct Rejected {
  Match match;
  RejectReason reason = RejectReason::score;
  Stage stage = Stage::coarse;
};

}  // namespace pickcell::matches
