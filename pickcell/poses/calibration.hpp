#pragma once
/// The calibration files of a cell (docs/interfaces.md, Files): camera.toml, plane.toml, handeye.toml. Read strictly,
/// written atomically, and held against the camera they are used with.

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include "pickcell/core/result.hpp"
#include "pickcell/core/transform.hpp"
#include "pickcell/poses/lens.hpp"

namespace pickcell::poses {

enum class Verdict { excellent, good, usable, reject };
[[nodiscard]] const char* name(Verdict verdict);

struct CameraCalibration {
  Lens lens;
  std::string model;  ///< "pinhole", "k1k2", "brown5", "rational"
  double rms_px = 0;
  double holdout_rms_px = 0;
  std::string camera_id;  ///< may be empty: any camera
  Verdict verdict = Verdict::reject;
  std::string date;      ///< ISO 8601 UTC
  std::string checksum;  ///< "crc32:XXXXXXXX" of the file; set by loading and saving
};

/// Standard deviations that a calibration adds to a place on the work plane: per axis, and of the direction there,
/// which turns places about the middle of what was calibrated.
struct PickSigma {
  double place_mm = 0, turn_deg = 0;
};

/// A fixed camera over a work plane. The file holds, beside the keys of interfaces.md, T_camera_plane: the camera
/// stands where it stands over the plane, so that whoever corrects T_base_plane moves what is seen with it.
struct PlaneCalibration {
  core::Transform<core::Base, core::Plane> T_base_plane;
  core::Transform<core::Base, core::Camera> T_base_camera;
  std::string camera;  ///< checksum of the camera.toml it was made with
  double rms_mm = 0;
  PickSigma sigma;  ///< about the origin of the plane's frame
  Verdict verdict = Verdict::reject;
  std::string date;
  bool board_frame_only =
      false;          ///< made from a board picture alone: no robot frame, refused by a cell that moves an arm
  std::string board;  ///< BOARD of the reference picture for verify; may be empty
  std::optional<core::Transform<core::Camera, core::Board>> T_camera_board;  ///< the reference, with board
};

/// A camera on the arm (T_flange_camera) or beside it (T_base_camera): one of the two is set. The places of the board
/// are keys of our own.
struct HandeyeCalibration {
  std::optional<core::Transform<core::Flange, core::Camera>> T_flange_camera;
  std::optional<core::Transform<core::Base, core::Camera>> T_base_camera;
  std::optional<core::Transform<core::Base, core::Board>> T_base_board;      ///< with T_flange_camera
  std::optional<core::Transform<core::Flange, core::Board>> T_flange_board;  ///< with T_base_camera
  std::string board;                                                         ///< BOARD it was made with; may be empty
  std::string camera;  ///< checksum of the camera.toml it was made with
  double spread_mm = 0;
  double plane_error_mm = 0;
  PickSigma sigma;  ///< about the middle of the picture
  Verdict verdict = Verdict::reject;
  std::string date;
};

[[nodiscard]] core::Result<CameraCalibration> load_camera(const std::filesystem::path& path);
[[nodiscard]] core::Result<PlaneCalibration> load_plane(const std::filesystem::path& path);
[[nodiscard]] core::Result<HandeyeCalibration> load_handeye(const std::filesystem::path& path);

/// Writes the file and returns what load_camera would: with its checksum.
[[nodiscard]] core::Result<CameraCalibration> save_camera(const std::filesystem::path& path, CameraCalibration camera);
[[nodiscard]] core::Status save_plane(const std::filesystem::path& path, const PlaneCalibration& plane);
[[nodiscard]] core::Status save_handeye(const std::filesystem::path& path, const HandeyeCalibration& handeye);

/// What the running cell is; calibrations that do not fit it are refused.
struct CalibrationUse {
  int width_px = 0, height_px = 0;
  std::string camera_id;
  double max_age_days = 365;
  std::int64_t now_unix_us = 0;
};

/// Refuses, naming the file's fault and the remedy: verdict reject, another picture size, another non-empty camera_id,
/// a differing camera checksum, a board frame, older than max_age_days, an unreadable date.
[[nodiscard]] core::Status check_fits(const CameraCalibration& camera, const PlaneCalibration& plane,
                                      const CalibrationUse& use);
/// The same for a hand-eye calibration.
[[nodiscard]] core::Status check_fits(const CameraCalibration& camera, const HandeyeCalibration& handeye,
                                      const CalibrationUse& use);

}  // namespace pickcell::poses
