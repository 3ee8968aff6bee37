#include "pickcell/cli/calibrate/demo.hpp"

#include <Eigen/Geometry>
#include <atomic>
#include <optional>
#include <thread>
#include <vector>

#include "pickcell/core/units.hpp"
#include "pickcell/image/codec.hpp"
#include "pickcell/poses/board_detect.hpp"
#include "pickcell/poses/camera_calibration.hpp"
#include "pickcell/poses/plane_calibration.hpp"
#include "pickcell/sim/board_picture.hpp"
#include "pickcell/sim/random.hpp"

namespace pickcell::cli {

using core::ErrorCode;
using core::failure;

namespace {

constexpr const char* kBoard = "chessboard:9x6:30mm";
constexpr int kPictures = 14;
constexpr double kTouchNoiseM = 0.05e-3;  ///< of the arm's reading at a touched corner, per axis
using BoardPlace = core::Transform<core::Camera, core::Board>;

const sim::BoardPattern kPattern{.cols = 9, .rows = 6, .spacing_m = 0.03};

/// Held before the camera: inclined, turned and moved so that the pictures together fill the field.
std::vector<BoardPlace> held_places(double distance_m, std::uint64_t seed) {
  sim::Random random(seed ^ 0xca11b);
  std::vector<BoardPlace> out;
  for (int i = 0; i < kPictures; ++i) {
    const double around = 2 * core::kPi * i / kPictures, tilt = 0.15 + 0.4 * random.unit();
    const Eigen::Matrix3d R = core::rotation_z(random.uniform(-0.2, 0.2)) *
                              Eigen::AngleAxisd(tilt, Eigen::Vector3d(std::cos(around), std::sin(around), 0)).matrix();
    const Eigen::Vector3d centre(random.uniform(-0.065, 0.065), random.uniform(-0.065, 0.065),
                                 distance_m * random.uniform(0.97, 1.15));
    out.push_back({R, centre - R * Eigen::Vector3d(0.12, 0.075, 0)});
  }
  return out;
}

image::Image picture_of(const sim::CameraSettings& camera, const BoardPlace& place, std::uint64_t seed) {
  return sim::board_picture(camera.intrinsics, kPattern, place,
                            {.blur_px = camera.psf_sigma_px, .noise_grey = camera.sensor.noise_grey, .seed = seed});
}

std::vector<poses::NamedView> see_board(const sim::CameraSettings& camera, const std::vector<BoardPlace>& places,
                                        const poses::Board& board) {
  std::vector<std::optional<poses::BoardView>> found(places.size());
  std::atomic<std::size_t> next{0};
  const auto work = [&] {
    for (std::size_t i = next++; i < places.size(); i = next++)
      if (auto view = poses::detect_board(picture_of(camera, places[i], camera.seed + i).view(), board, "picture"))
        found[i] = std::move(*view);
  };
  {
    std::vector<std::jthread> others(std::max(1u, std::thread::hardware_concurrency()) - 1);
    for (std::jthread& t : others) t = std::jthread(work);
    work();
  }
  std::vector<poses::NamedView> out;
  for (std::size_t i = 0; i < found.size(); ++i)
    if (found[i]) out.push_back({std::to_string(i + 1), std::move(*found[i])});
  return out;
}

tl::unexpected<core::Error> unusable(const char* what, const std::string& why) {
  return failure(ErrorCode::negative, what, "the simulated calibration is not usable: " + why,
                 "please report this with the seed");
}

core::Result<poses::CameraCalibration> calibrate_lens(const std::filesystem::path& folder,
                                                      const sim::CameraSettings& camera, double distance_m,
                                                      const poses::Board& board, const std::string& date) {
  auto fit = poses::calibrate_camera(board, see_board(camera, held_places(distance_m, camera.seed), board));
  if (!fit) return core::forward(fit);
  if (fit->calibration.verdict == poses::Verdict::reject) return unusable("camera", fit->why);
  fit->calibration.camera_id = camera.camera_id;
  fit->calibration.date = date;
  return poses::save_camera(folder / "camera.toml", fit->calibration);
}

/// The board on the plane under the camera, columns along the picture's x.
core::Transform<core::Plane, core::Board> board_on_plane() {
  const Eigen::Matrix3d face_up = Eigen::Vector3d(1, -1, -1).asDiagonal();
  return {face_up, {-0.12, 0.075, 0}};
}

std::vector<poses::TouchedCorner> touch_corners(const core::Transform<core::Base, core::Board>& T_base_board,
                                                std::uint64_t seed) {
  sim::Random random(seed ^ 0x70c4);
  std::vector<poses::TouchedCorner> out;
  for (const int row : {0, 2, 5})
    for (const int col : {0, 3, 5, 8}) {
      const auto p = T_base_board * core::Point<core::Board>{{0.03 * col, 0.03 * row, 0}};
      out.push_back(
          {col, row, p.m + kTouchNoiseM * Eigen::Vector3d(random.normal(), random.normal(), random.normal())});
    }
  return out;
}

}  // namespace

core::Status calibrate_demo(const std::filesystem::path& folder, const sim::CameraSettings& camera,
                            const sim::WorldSettings& world, const std::string& date) {
  const auto board = poses::parse_board(kBoard);
  const auto T_plane_camera = world.T_base_plane.inverse() * camera.T_base_camera;
  auto lens = calibrate_lens(folder, camera, T_plane_camera.translation_m().z(), *board, date);
  if (!lens) return core::forward(lens);
  const image::Image reference = picture_of(camera, T_plane_camera.inverse() * board_on_plane(), camera.seed + 100);
  if (auto saved = image::save_png(folder / "board.png", reference.view()); !saved) return saved;
  auto view = poses::detect_board(reference.view(), *board, "board.png");
  if (!view) return core::forward(view);
  const auto touched = touch_corners(world.T_base_plane * board_on_plane(), camera.seed);
  auto plane = poses::plane_from_touched_board(lens->lens, *board, *view, touched, 0);
  if (!plane) return core::forward(plane);
  if (plane->calibration.verdict == poses::Verdict::reject) return unusable("plane", plane->why);
  plane->calibration.camera = lens->checksum;
  plane->calibration.date = date;
  return poses::save_plane(folder / "plane.toml", plane->calibration);
}

}  // namespace pickcell::cli
