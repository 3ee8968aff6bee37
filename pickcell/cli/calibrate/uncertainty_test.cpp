// What a pick's place and direction are said to be uncertain by, against the errors that they have.

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>

#include "pickcell/cli/calibrate/scenes.hpp"
#include "pickcell/core/units.hpp"
#include "pickcell/poses/locate.hpp"
#include "pickcell/poses/moving_view.hpp"
#include "pickcell/sim/random.hpp"

namespace pickcell::cli {
namespace {

/// Mean over places of the normalised squared error of (x, y, direction), over 3: 1 when the stated covariance is
/// right.
class PickErrors {
 public:
  /// A match at some place, with noise, seen by the true view and by the calibrated one.
  void add(const poses::View& truth, const poses::View& calibrated) {
    matches::Match match;
    match.pose = {random_.uniform(0.25, 0.75) * truth.lens.width_px, random_.uniform(0.25, 0.75) * truth.lens.height_px,
                  random_.uniform(-180, 180), 1};
    const auto expected = locator_.locate(match, truth);
    match.pose.x_px += kPlacePx * random_.normal();
    match.pose.y_px += kPlacePx * random_.normal();
    match.pose.angle_deg += kTurnDeg * random_.normal();
    match.covariance.diagonal() << kPlacePx * kPlacePx, kPlacePx * kPlacePx, kTurnDeg * kTurnDeg, 1e-8;
    const auto found = locator_.locate(match, calibrated);
    ASSERT_TRUE(expected && found);
    const Eigen::Vector3d shift = calibrated.T_base_plane.rotation().transpose() *
                                  (found->T_base_part.translation_m() - expected->T_base_part.translation_m());
    const Eigen::Matrix3d turn = expected->T_base_part.rotation().transpose() * found->T_base_part.rotation();
    const Eigen::Vector3d error(shift.x(), shift.y(), std::atan2(turn(1, 0), turn(0, 0)));
    sum_ += error.dot(found->covariance.inverse() * error) / 3;
    direction_ += error.z() * error.z() / found->covariance(2, 2);
    ++count_;
  }
  [[nodiscard]] double nees() const { return sum_ / count_; }
  [[nodiscard]] double nees_of_direction() const { return direction_ / count_; }

 private:
  static matches::Model model() {
    matches::Model out;
    out.picture = image::Image(81, 81);
    out.ref_x_px = out.ref_y_px = 40;
    return out;
  }
  static constexpr double kPlacePx = 0.05, kTurnDeg = 0.01;
  poses::Locator locator_{model()};
  sim::Random random_{5};
  double sum_ = 0, direction_ = 0;
  int count_ = 0;
};

poses::View view_of(const HandeyeScene& s, const core::Transform<core::Base, core::Camera>& T_base_camera) {
  poses::View out;
  out.lens = lens_of(s.camera);
  out.T_base_camera = T_base_camera;
  const Eigen::Matrix3d face_up = Eigen::Vector3d(1, -1, -1).asDiagonal();
  out.T_base_plane = s.T_base_board * core::Transform<core::Board, core::Plane>(face_up, Eigen::Vector3d::Zero());
  return out;
}

TEST(Uncertainty, OfAPickWithATouchedPlaneIsWhatItSays) {
  PickErrors errors;
  for (std::uint64_t seed = 1; seed <= 200; ++seed) {
    const HandeyeScene s = handeye_scene(seed, 1);
    sim::Random random(seed + 1000);
    std::vector<poses::TouchedCorner> touched;
    for (const int row : {0, 2, 5})
      for (const int col : {0, 3, 5, 8}) {
        const Eigen::Vector3d noise(random.normal(), random.normal(), random.normal());
        touched.push_back(
            {col, row, (s.T_base_board * core::Point<core::Board>{{0.025 * col, 0.025 * row, 0}}).m + 1e-4 * noise});
      }
    const auto seen = with_noisy_corners(s, 0.05, seed).views[0].picture.view;
    const auto fit = poses::plane_from_touched_board(lens_of(s.camera), s.board, seen, touched, 0);
    ASSERT_TRUE(fit);
    poses::View calibrated = view_of(s, fit->calibration.T_base_camera);
    calibrated.T_base_plane = fit->calibration.T_base_plane;
    calibrated.sigma_position_m = core::m_from_mm(fit->calibration.sigma.place_mm);
    calibrated.sigma_turn_rad = core::rad_from_deg(fit->calibration.sigma.turn_deg);
    errors.add(view_of(s, s.T_base_flange[0] * s.T_flange_camera), calibrated);
  }
  EXPECT_GT(errors.nees(), 0.7);
  EXPECT_LT(errors.nees(), 1.5);
  EXPECT_GT(errors.nees_of_direction(), 0.7);
  EXPECT_LT(errors.nees_of_direction(), 1.5);
}

TEST(Uncertainty, OfAPickWithACameraOnTheArmIsWhatItSays) {
  PickErrors errors;
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    const HandeyeScene s = handeye_scene(seed, 20);
    poses::HandeyeInput input = with_noisy_corners(s, 0.05, seed);
    scatter(input, 0.2, 0.01, seed);  // poses of the arm, those of the picks too
    poses::HandeyeInput some = input;
    some.views.clear();
    std::vector<std::size_t> picks;
    for (std::size_t i = 0; i < input.views.size(); ++i)
      i % 3 == 1 ? picks.push_back(i) : some.views.push_back(input.views[i]);
    const auto fit = poses::calibrate_handeye(some);
    ASSERT_TRUE(fit);
    poses::CameraCalibration camera;
    camera.lens = some.lens;
    for (const std::size_t i : picks) {
      const poses::View truth = view_of(s, s.T_base_flange[i] * s.T_flange_camera);
      const core::Transform<core::Base, core::Flange> arm(input.views[i].arm.pose());
      const auto view = poses::view_at_exposure(camera, fit->calibration, truth.T_base_plane, arm);
      ASSERT_TRUE(view);
      errors.add(truth, *view);
    }
  }
  EXPECT_GT(errors.nees(), 0.6);
  EXPECT_LT(errors.nees(), 1.7);
}

}  // namespace
}  // namespace pickcell::cli
