#include "pickcell/poses/calibration.hpp"

#include <Eigen/LU>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <sstream>

#include "pickcell/core/config.hpp"
#include "pickcell/core/file.hpp"

namespace pickcell::poses {

namespace {

using core::Config;
using core::ErrorCode;
using core::failure;

constexpr double kRotationTolerance = 1e-4;
constexpr double kClocksDifferDays = 2;  ///< time zones, and a date without a time

Verdict read_verdict(Config& file) {
  const std::string text = file.string("verdict");
  for (const Verdict v : {Verdict::excellent, Verdict::good, Verdict::usable, Verdict::reject})
    if (text == name(v)) return v;
  file.problem("verdict", "must be excellent, good, usable or reject");
  return Verdict::reject;
}

template <class To, class From>
core::Transform<To, From> read_transform(Config& file, std::string_view key) {
  const auto rows = file.matrix(key);
  Eigen::Isometry3d iso = Eigen::Isometry3d::Identity();
  if (rows.size() != 4 || rows.front().size() != 4) {
    if (!rows.empty()) file.problem(key, "must have 4 rows of 4 numbers");
    return core::Transform<To, From>(iso);
  }
  for (int r = 0; r < 4; ++r)
    for (int c = 0; c < 4; ++c) iso.matrix()(r, c) = rows[static_cast<std::size_t>(r)][static_cast<std::size_t>(c)];
  const Eigen::Matrix3d R = iso.linear();
  const bool rigid = (R * R.transpose() - Eigen::Matrix3d::Identity()).norm() < kRotationTolerance &&
                     R.determinant() > 0 && (iso.matrix().row(3) - Eigen::RowVector4d(0, 0, 0, 1)).norm() < 1e-9;
  if (!rigid) file.problem(key, "is no rigid transform (rotation, translation in metres, last row 0 0 0 1)");
  return core::Transform<To, From>(iso);
}

template <class To, class From>
std::optional<core::Transform<To, From>> read_transform_if(Config& file, std::string_view key) {
  if (!file.has(key)) return std::nullopt;
  return read_transform<To, From>(file, key);
}

/// Files of before had none: the error of the fit stands for the place's.
PickSigma read_sigma(Config& file, double else_mm) {
  return {file.number_or("sigma_place_mm", else_mm), file.number_or("sigma_turn_deg", 0)};
}

std::string quoted(const std::string& text) {
  std::string out = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') out += '\\';
    if (static_cast<unsigned char>(c) >= 0x20) out += c;
  }
  return out + "\"";
}

void write_matrix(std::ostream& out, const char* key, const Eigen::Matrix4d& M) {
  out << key << " = [\n";
  for (int r = 0; r < 4; ++r)
    out << "  [" << M(r, 0) << ", " << M(r, 1) << ", " << M(r, 2) << ", " << M(r, 3) << "],\n";
  out << "]\n";
}

/// TOML wants a decimal point or an exponent nowhere: integers are read as numbers too, so plain stream output will do.
std::ostringstream toml_stream() {
  std::ostringstream out;
  out.precision(17);
  return out;
}

void write_sigma(std::ostream& out, const PickSigma& sigma) {
  out << "sigma_place_mm = " << sigma.place_mm << "\nsigma_turn_deg = " << sigma.turn_deg << "\n";
}

std::string checksum_of(std::string_view text) {
  char hex[32];
  std::snprintf(hex, sizeof hex, "crc32:%08X", core::crc32(std::as_bytes(std::span(text))));
  return hex;
}

/// Days between an ISO 8601 date (YYYY-MM-DD, time ignored) and now; nothing when it is no date.
std::optional<double> age_days(const std::string& date, std::int64_t now_unix_us) {
  int y = 0, m = 0, d = 0;
  if (std::sscanf(date.c_str(), "%4d-%2d-%2d", &y, &m, &d) != 3) return std::nullopt;
  using namespace std::chrono;
  const year_month_day day{year(y), month(static_cast<unsigned>(m)), std::chrono::day(static_cast<unsigned>(d))};
  if (!day.ok()) return std::nullopt;
  return static_cast<double>(now_unix_us) / 86400e6 - static_cast<double>(sys_days(day).time_since_epoch().count());
}

}  // namespace

const char* name(Verdict verdict) {
  switch (verdict) {
    case Verdict::excellent:
      return "excellent";
    case Verdict::good:
      return "good";
    case Verdict::usable:
      return "usable";
    case Verdict::reject:
      return "reject";
  }
  return "reject";
}

core::Result<CameraCalibration> load_camera(const std::filesystem::path& path) {
  auto text = core::read_text_file(path);
  if (!text) return core::forward(text);
  auto parsed = Config::parse(*text, path.string());
  if (!parsed) return core::forward(parsed);
  Config& file = *parsed;
  CameraCalibration out;
  out.model = file.string("model");
  out.lens.width_px = static_cast<int>(file.integer("width_px"));
  out.lens.height_px = static_cast<int>(file.integer("height_px"));
  out.lens.fx_px = file.number("fx_px");
  out.lens.fy_px = file.number("fy_px");
  out.lens.cx_px = file.number("cx_px");
  out.lens.cy_px = file.number("cy_px");
  const auto distortion = file.numbers("distortion");
  if (distortion.size() > out.lens.distortion.size()) file.problem("distortion", "has more than 8 coefficients");
  for (std::size_t i = 0; i < std::min(distortion.size(), out.lens.distortion.size()); ++i)
    out.lens.distortion[i] = distortion[i];
  if (!(out.lens.fx_px > 0)) file.problem("fx_px", "must be positive");
  if (!(out.lens.fy_px > 0)) file.problem("fy_px", "must be positive");
  out.rms_px = file.number("rms_px");
  out.holdout_rms_px = file.number("holdout_rms_px");
  out.camera_id = file.string_or("camera_id", "");
  out.verdict = read_verdict(file);
  out.date = file.string("date");
  out.checksum = checksum_of(*text);
  auto status = file.finish();
  if (!status) return core::forward(status);
  return out;
}

core::Result<PlaneCalibration> load_plane(const std::filesystem::path& path) {
  auto parsed = Config::load(path);
  if (!parsed) return core::forward(parsed);
  Config& file = *parsed;
  PlaneCalibration out;
  out.T_base_plane = read_transform<core::Base, core::Plane>(file, "T_base_plane");
  out.T_base_camera = out.T_base_plane * read_transform<core::Camera, core::Plane>(file, "T_camera_plane").inverse();
  out.camera = file.string("camera");
  out.rms_mm = file.number("rms_mm");
  out.sigma = read_sigma(file, out.rms_mm);
  out.verdict = read_verdict(file);
  out.date = file.string("date");
  out.board_frame_only = file.boolean_or("board_frame_only", false);
  out.board = file.string_or("board", "");
  out.T_camera_board = read_transform_if<core::Camera, core::Board>(file, "T_camera_board");
  auto status = file.finish();
  if (!status) return core::forward(status);
  return out;
}

core::Result<CameraCalibration> save_camera(const std::filesystem::path& path, CameraCalibration camera) {
  auto out = toml_stream();
  const Lens& lens = camera.lens;
  out << "model = " << quoted(camera.model) << "\nwidth_px = " << lens.width_px << "\nheight_px = " << lens.height_px
      << "\nfx_px = " << lens.fx_px << "\nfy_px = " << lens.fy_px << "\ncx_px = " << lens.cx_px
      << "\ncy_px = " << lens.cy_px << "\ndistortion = [";
  const std::size_t used = lens.distortion[5] != 0 || lens.distortion[6] != 0 || lens.distortion[7] != 0 ? 8 : 5;
  for (std::size_t i = 0; i < used; ++i) out << (i ? ", " : "") << lens.distortion[i];
  out << "]\nrms_px = " << camera.rms_px << "\nholdout_rms_px = " << camera.holdout_rms_px
      << "\ncamera_id = " << quoted(camera.camera_id) << "\nverdict = " << quoted(name(camera.verdict))
      << "\ndate = " << quoted(camera.date) << "\n";
  auto status = core::write_file_atomically(path, out.str());
  if (!status) return core::forward(status);
  camera.checksum = checksum_of(out.str());
  return camera;
}

core::Status save_plane(const std::filesystem::path& path, const PlaneCalibration& plane) {
  auto out = toml_stream();
  write_matrix(out, "T_base_plane", plane.T_base_plane.matrix());
  write_matrix(out, "T_camera_plane", (plane.T_base_camera.inverse() * plane.T_base_plane).matrix());
  out << "camera = " << quoted(plane.camera) << "\nrms_mm = " << plane.rms_mm
      << "\nverdict = " << quoted(name(plane.verdict)) << "\ndate = " << quoted(plane.date) << "\n";
  write_sigma(out, plane.sigma);
  if (plane.board_frame_only) out << "board_frame_only = true\n";
  if (!plane.board.empty()) out << "board = " << quoted(plane.board) << "\n";
  if (plane.T_camera_board) write_matrix(out, "T_camera_board", plane.T_camera_board->matrix());
  return core::write_file_atomically(path, out.str());
}

core::Result<HandeyeCalibration> load_handeye(const std::filesystem::path& path) {
  auto parsed = Config::load(path);
  if (!parsed) return core::forward(parsed);
  Config& file = *parsed;
  HandeyeCalibration out;
  out.T_flange_camera = read_transform_if<core::Flange, core::Camera>(file, "T_flange_camera");
  out.T_base_camera = read_transform_if<core::Base, core::Camera>(file, "T_base_camera");
  out.T_base_board = read_transform_if<core::Base, core::Board>(file, "T_base_board");
  out.T_flange_board = read_transform_if<core::Flange, core::Board>(file, "T_flange_board");
  if (out.T_flange_camera.has_value() == out.T_base_camera.has_value())
    file.problem("T_flange_camera", "or T_base_camera must be given, one of them");
  out.camera = file.string("camera");
  out.board = file.string_or("board", "");
  out.spread_mm = file.number("spread_mm");
  out.plane_error_mm = file.number_or("plane_error_mm", out.spread_mm);
  out.sigma = read_sigma(file, out.plane_error_mm);
  out.verdict = read_verdict(file);
  out.date = file.string("date");
  auto status = file.finish();
  if (!status) return core::forward(status);
  return out;
}

core::Status save_handeye(const std::filesystem::path& path, const HandeyeCalibration& handeye) {
  auto out = toml_stream();
  if (handeye.T_flange_camera) write_matrix(out, "T_flange_camera", handeye.T_flange_camera->matrix());
  if (handeye.T_base_camera) write_matrix(out, "T_base_camera", handeye.T_base_camera->matrix());
  if (handeye.T_base_board) write_matrix(out, "T_base_board", handeye.T_base_board->matrix());
  if (handeye.T_flange_board) write_matrix(out, "T_flange_board", handeye.T_flange_board->matrix());
  if (!handeye.board.empty()) out << "board = " << quoted(handeye.board) << "\n";
  out << "camera = " << quoted(handeye.camera) << "\nspread_mm = " << handeye.spread_mm
      << "\nplane_error_mm = " << handeye.plane_error_mm << "\nverdict = " << quoted(name(handeye.verdict))
      << "\ndate = " << quoted(handeye.date) << "\n";
  write_sigma(out, handeye.sigma);
  return core::write_file_atomically(path, out.str());
}

namespace {

tl::unexpected<core::Error> refuse(const std::string& what, std::string why, const char* remedy) {
  return failure(ErrorCode::unreadable, what, std::move(why), remedy);
}

core::Status camera_fits(const CameraCalibration& camera, const CalibrationUse& use) {
  if (camera.verdict == Verdict::reject)
    return refuse("camera calibration", "its verdict is reject", "calibrate the camera again");
  if (camera.lens.width_px != use.width_px || camera.lens.height_px != use.height_px)
    return refuse("camera calibration",
                  "made for pictures of " + std::to_string(camera.lens.width_px) + "x" +
                      std::to_string(camera.lens.height_px) + ", the camera delivers " + std::to_string(use.width_px) +
                      "x" + std::to_string(use.height_px),
                  "set the camera to the calibrated size or calibrate again");
  if (!camera.camera_id.empty() && !use.camera_id.empty() && camera.camera_id != use.camera_id)
    return refuse("camera calibration", "made with camera '" + camera.camera_id + "', this is '" + use.camera_id + "'",
                  "calibrate this camera");
  return {};
}

core::Status made_with(const std::string& what, const std::string& checksum, const CameraCalibration& camera) {
  if (checksum == camera.checksum) return {};
  return refuse(what, "made with another camera.toml (" + checksum + ", now " + camera.checksum + ")",
                "calibrate it again with this camera calibration");
}

core::Status young_enough(const std::string& what, const std::string& date, const CalibrationUse& use) {
  const auto age = age_days(date, use.now_unix_us);
  if (!age) return refuse(what, "its date '" + date + "' is no date", "calibrate again");
  if (*age < -kClocksDifferDays)
    return refuse(what, "its date lies in the future (" + date + ")", "set the clock, or calibrate again");
  if (*age > use.max_age_days)
    return refuse(what, "older than " + std::to_string(static_cast<int>(use.max_age_days)) + " days (" + date + ")",
                  "verify or calibrate again");
  return {};
}

}  // namespace

core::Status check_fits(const CameraCalibration& camera, const PlaneCalibration& plane, const CalibrationUse& use) {
  const std::string what = "plane calibration";
  if (auto fits = camera_fits(camera, use); !fits) return fits;
  if (plane.verdict == Verdict::reject) return refuse(what, "its verdict is reject", "calibrate the plane again");
  if (auto fits = made_with(what, plane.camera, camera); !fits) return fits;
  if (plane.board_frame_only)
    return refuse(what, "made from a board picture alone: it knows no robot frame",
                  "touch board corners with the tool and give them with --touched");
  if (auto fits = young_enough("camera calibration", camera.date, use); !fits) return fits;
  return young_enough(what, plane.date, use);
}

core::Status check_fits(const CameraCalibration& camera, const HandeyeCalibration& handeye, const CalibrationUse& use) {
  const std::string what = "hand-eye calibration";
  if (auto fits = camera_fits(camera, use); !fits) return fits;
  if (handeye.verdict == Verdict::reject) return refuse(what, "its verdict is reject", "calibrate hand and eye again");
  if (auto fits = made_with(what, handeye.camera, camera); !fits) return fits;
  if (auto fits = young_enough("camera calibration", camera.date, use); !fits) return fits;
  return young_enough(what, handeye.date, use);
}

}  // namespace pickcell::poses
