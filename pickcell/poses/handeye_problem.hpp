#pragma once
/// The pieces of hand-eye calibration on plain transforms, for the files handeye*.cpp.

#include <Eigen/Geometry>
#include <array>
#include <optional>
#include <string>
#include <vector>

#include "pickcell/poses/handeye.hpp"

namespace pickcell::poses::detail {

/// One picture: the arm's move M, the board's pose in the camera B, and what was seen.
struct Station {
  Eigen::Isometry3d move = Eigen::Isometry3d::Identity();
  Eigen::Isometry3d T_camera_board = Eigen::Isometry3d::Identity();
  BoardView view;
  double picture_rms_px = 0;
};
using Stations = std::vector<Station>;

struct HandEye {
  Eigen::Isometry3d X = Eigen::Isometry3d::Identity();
  Eigen::Isometry3d Y = Eigen::Isometry3d::Identity();
};

/// The five closed-form solvers of OpenCV.
enum class Solver { park, horaud, tsai, andreff, daniilidis };
constexpr std::array<Solver, 5> kSolvers{Solver::park, Solver::horaud, Solver::tsai, Solver::andreff,
                                         Solver::daniilidis};
[[nodiscard]] const char* name(Solver solver);

/// X by one solver and Y as the mean over the stations; nothing when the solver fails.
[[nodiscard]] std::optional<HandEye> solve(const Stations& stations, Solver solver);

/// Chordal mean of rotations, mean of translations.
[[nodiscard]] Eigen::Isometry3d mean_pose(const std::vector<Eigen::Isometry3d>& poses);
[[nodiscard]] std::vector<Eigen::Isometry3d> board_places(const Stations& stations, const Eigen::Isometry3d& X);
[[nodiscard]] Spread spread_of(const std::vector<Eigen::Isometry3d>& places);
[[nodiscard]] double angle_deg(const Eigen::Matrix3d& rotation);

/// Seen minus predicted, per point of a station. Points that fall behind the camera count as 1e4 px off.
[[nodiscard]] std::vector<Eigen::Vector2d> residuals_px(const Lens& lens, const std::vector<Eigen::Vector2d>& board_m,
                                                        const Station& station, const HandEye& result);
[[nodiscard]] double rms(const std::vector<Eigen::Vector2d>& residuals);
/// Of every station.
[[nodiscard]] std::vector<double> station_rms_px(const Lens& lens, const std::vector<Eigen::Vector2d>& board_m,
                                                 const Stations& stations, const HandEye& result);

/// Minimises the squared reprojection error over X and Y with Ceres.
[[nodiscard]] HandEye refine(const Lens& lens, const std::vector<Eigen::Vector2d>& board_m, const Stations& stations,
                             const HandEye& start);

/// The best of random subsets by the median of the stations' errors, with the board numbered by its symmetries so that
/// it fits; stands up to almost half of the poses being wrong. Changes T_camera_board and view of stations.
[[nodiscard]] std::optional<HandEye> solve_robustly(const Lens& lens, const Board& board, Stations& stations,
                                                    int subsets = 60);

/// Why these motions cannot be solved, or "": hardly any rotation, or rotations about one axis only.
[[nodiscard]] std::string unsolvable(const Stations& stations);

/// The motion in the arm's own frame that would turn its pose into the one that the station's picture asks for.
[[nodiscard]] Eigen::Isometry3d asked_of_arm(const Station& station, const Eigen::Isometry3d& move,
                                             const HandEye& result, Mounting mounting);

/// Sizes of an error of the arm's pose: its position, and the turn about it.
struct ArmError {
  double mm = 0, deg = 0;
};

/// RMS over the stations, and the likeliest error of every station's pose.
struct ArmErrors {
  ArmError rms;
  std::vector<ArmError> each;
};
/// What the pictures ask of the arm's poses, less what noise makes the pictures ask (maximum likelihood): a picture
/// knows place and direction of the board together far better than each alone.
[[nodiscard]] ArmErrors arm_errors(const Lens& lens, const std::vector<Eigen::Vector2d>& board_m,
                                   const Stations& stations, const HandEye& result, Mounting mounting);

/// One picture on the board's plane: mean distance between the points cast by arm, X and Y and their nominal places,
/// and the rigid motion that they share.
struct OnPlane {
  std::size_t points = 0;
  double mean_mm = 0, shift_mm = 0, turn_deg = 0;
};
[[nodiscard]] std::vector<OnPlane> on_plane(const Lens& lens, const std::vector<Eigen::Vector2d>& board_m,
                                            const Stations& stations, const HandEye& result);
/// Over all points of all pictures.
[[nodiscard]] double mean_mm(const std::vector<OnPlane>& pictures);
/// Standard deviations of what a further picture would be off by, from the motions of these.
[[nodiscard]] PickSigma pick_sigma(const std::vector<OnPlane>& pictures);

/// Another reading of the input that explains it better.
struct Explanation {
  std::string fault;     ///< the kind, for a person
  double median_px = 0;  ///< of the stations' errors under this reading
};

/// Tries other readings of the poses (units, order of angles and quaternions, direction, mirrored pictures, shifted or
/// scaled) and gives the one that fits far better than median_px; nothing when there is none.
[[nodiscard]] std::optional<Explanation> explain(const HandeyeInput& input, const Stations& stations, double median_px);
/// What the magnitudes of the poses alone say, or "".
[[nodiscard]] std::string suspicious_units(const std::vector<ArmView>& views);

/// The whole of calibrate_handeye with the lens as given.
[[nodiscard]] core::Result<HandeyeFit> fit_with_lens(const HandeyeInput& input);

/// M of a pose.
[[nodiscard]] Eigen::Isometry3d move_of(const HandeyeInput& input, const Eigen::Isometry3d& pose);

}  // namespace pickcell::poses::detail
