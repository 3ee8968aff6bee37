#include "pickcell/sim/board_picture.hpp"

#include <cmath>

#include "pickcell/sim/sensor.hpp"

namespace pickcell::sim {

namespace {

constexpr float kGround = 0.45f, kWhite = 0.85f, kBlack = 0.06f;
constexpr int kSamples = 4;

float dot_at(const BoardPattern& p, double x, double y) {
  const bool staggered = p.kind == BoardPattern::Kind::staggered_dots;
  const double row = std::round(y);
  const double shift = staggered && std::fmod(row, 2) != 0 ? 1 : 0, step = staggered ? 2 : 1;
  const double col = std::round((x - shift) / step);
  const bool in_grid = col >= 0 && row >= 0 && col < p.cols && row < p.rows;
  return in_grid && std::hypot(x - shift - step * col, y - row) * p.spacing_m < p.dot_radius_m ? kBlack : kWhite;
}

/// In the white square number `index`, at a place in it from 0 to 1.
float marker_at(const BoardPattern& p, std::size_t index, double x, double y) {
  const double side = p.marker_m / p.spacing_m, u = (x - (1 - side) / 2) / side, v = (y - (1 - side) / 2) / side;
  if (index >= p.markers.size() || u < 0 || v < 0 || u >= 1 || v >= 1) return kWhite;
  const std::string& bits = p.markers[index];
  const auto n = static_cast<int>(std::lround(std::sqrt(static_cast<double>(bits.size()))));
  const int col = static_cast<int>(u * (n + 2)) - 1, row = static_cast<int>(v * (n + 2)) - 1;
  if (col < 0 || row < 0 || col >= n || row >= n) return kBlack;  // its border
  return bits[static_cast<std::size_t>(row * n + col)] == '1' ? kWhite : kBlack;
}

/// Light from a point of the board's plane, in units of its spacing.
float light_at(const BoardPattern& p, double x, double y) {
  const bool dots = p.kind == BoardPattern::Kind::dots || p.kind == BoardPattern::Kind::staggered_dots;
  const double margin = dots ? 1 : 2;  // white paper around the dots, or around the outer squares
  const double width = p.kind == BoardPattern::Kind::staggered_dots ? 2 * p.cols - 1 : p.cols - 1;
  if (x < -margin || y < -margin || x > width + margin || y > p.rows - 1 + margin) return kGround;
  if (dots) return dot_at(p, x, y);
  if (x < -1 || y < -1 || x > p.cols || y > p.rows) return kWhite;
  const int col = static_cast<int>(std::floor(x)) + 1, row = static_cast<int>(std::floor(y)) + 1;
  if ((col + row) % 2 == 0) return kBlack;
  if (p.kind == BoardPattern::Kind::chessboard) return kWhite;
  // White squares before this one; rows have cols + 1 squares, and begin with a black one in turn.
  const int squares = p.cols + 1;
  int before = 0;
  for (int r = 0; r < row; ++r) before += r % 2 == 0 ? squares / 2 : (squares + 1) / 2;
  before += row % 2 == 0 ? (col - 1) / 2 : col / 2;
  return marker_at(p, static_cast<std::size_t>(before), x - std::floor(x), y - std::floor(y));
}

}  // namespace

image::Image board_picture(const Intrinsics& camera, const BoardPattern& pattern,
                           const core::Transform<core::Camera, core::Board>& T_camera_board,
                           const BoardPictureSettings& settings) {
  const auto T_board_camera = T_camera_board.inverse();
  const Eigen::Vector3d from = T_board_camera.translation_m();
  const Eigen::Matrix3d R = T_board_camera.rotation();
  image::Plane<float> x(camera.width_px + 1, camera.height_px + 1), y(camera.width_px + 1, camera.height_px + 1);
  for (int v = 0; v < x.height(); ++v) {
    Eigen::Vector3d along = ray(camera, {-0.5, v - 0.5});
    for (int u = 0; u < x.width(); ++u) {  // at the pixels' corners
      along = ray(camera, {u - 0.5, v - 0.5}, &along);
      const Eigen::Vector3d d = R * along;
      const Eigen::Vector3d hit = (from - d * (from.z() / d.z())) / pattern.spacing_m;
      x.at(u, v) = static_cast<float>(hit.x());
      y.at(u, v) = static_cast<float>(hit.y());
    }
  }
  LightPlane light(camera.width_px, camera.height_px);
  for (int v = 0; v < light.height(); ++v)
    for (int u = 0; u < light.width(); ++u) {
      float sum = 0;
      for (int j = 0; j < kSamples; ++j)
        for (int i = 0; i < kSamples; ++i) {
          const float a = (static_cast<float>(i) + 0.5f) / kSamples, b = (static_cast<float>(j) + 0.5f) / kSamples;
          const auto mix = [&](const image::Plane<float>& p) {
            return (1 - b) * ((1 - a) * p.at(u, v) + a * p.at(u + 1, v)) +
                   b * ((1 - a) * p.at(u, v + 1) + a * p.at(u + 1, v + 1));
          };
          sum += light_at(pattern, mix(x), mix(y));
        }
      light.at(u, v) = sum / (kSamples * kSamples);
    }
  blur(light, settings.blur_px);
  SensorSettings sensor;
  sensor.noise_grey = settings.noise_grey;
  return expose(light, sensor, settings.seed);
}

}  // namespace pickcell::sim
