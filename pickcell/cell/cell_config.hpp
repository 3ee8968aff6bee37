#pragma once
/// CELL.toml: everything that makes one cell (docs/interfaces.md). Units as the keys say; relative paths start at the
/// file.

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "pickcell/core/config.hpp"
#include "pickcell/core/result.hpp"
#include "pickcell/frames/camera_settings.hpp"

namespace pickcell::cell {

struct CameraConfig {
  std::string source;               ///< "sim" | "files:DIR" | "aravis:NAME" | "v4l2:/dev/videoN"
  std::string id;                   ///< empty: whatever the source says
  double fps = 0;                   ///< of "files:": pictures per second of the cell's clock; 0: as fast as asked
  bool loop = false;                ///< of "files:": begin again after the last picture
  frames::CameraSettings settings;  ///< of real cameras: the table [camera.settings]
};

struct RobotConfig {
  std::string link;   ///< "tcp80://host[:port]" | "sim" | ...
  std::string model;  ///< "gp7", ...
  int frame = 0;      ///< of the controller, that "base" means here: calibration points, box and places are all in it
  int tool = 1;
  bool allow_motion = false;
  /// Of the job: where the arm waits clear of the camera, tool straight down. Its first motion after Start goes there.
  std::array<double, 3> home_mm = {300, 0, 250};
  int gripper_output = 1;     ///< OT#(n): on closes
  int grip_sensor_input = 1;  ///< IN#(n): on when something is in the gripper
};

enum class VerifyAtStart {
  never,
  board_stays,          ///< the board is mounted in the picture
  board_is_taken_away,  ///< a person lays it down and takes it away again: a second Start begins the work
};

struct CalibrationConfig {
  std::filesystem::path camera;
  std::filesystem::path plane;       ///< of a fixed camera; empty with handeye
  std::filesystem::path handeye;     ///< empty with plane
  std::optional<double> plane_z_mm;  ///< with handeye: height of the level work plane in the robot's frame
  std::array<double, 6>
      flange_tool_mm_deg{};  ///< with handeye: x, y, z, rx, ry, rz of the tool whose poses the arm gives
  double max_age_days = 365;
  VerifyAtStart verify_at_start = VerifyAtStart::never;  ///< once after the cell comes up, before it picks
};

struct LimitsConfig {
  double place_mm = 1, place_deg = 1;  ///< a report with a worse place error fails
  double grasp_mm = 3, grasp_deg = 5;  ///< what the gripper tolerates: no pick whose 3 sigma exceed it
  double gripper_length_mm = 0,
         gripper_width_mm = 0;  ///< of the open gripper, along the tool's X and across; 0: not checked
  double speed_pct = 100;       ///< of the job's taught speeds
  std::array<double, 3> box_min_mm{}, box_max_mm{};  ///< where the tool may be sent, base frame
  double approach_mm = 80;  ///< the arm comes to grasp and place from so far straight above; in the box too
};

/// Slots of a tray: rows along its y, columns along its x; slot = row * cols + col.
struct PlaceConfig {
  std::array<double, 3> origin_mm{};  ///< of slot 0 in base: reference point of the part's lower face
  double angle_deg = 0;  ///< of the tray's x (and of the placed part's x) in base, counter-clockwise from above
  int rows = 1, cols = 1;
  double pitch_x_mm = 0, pitch_y_mm = 0;
};

struct PartConfig {
  std::filesystem::path model;
  std::optional<double> height_mm;  ///< of the matched surface above the work plane; unset: the model's
  PlaceConfig place;
};

enum class FeedKind {
  none,     ///< parts are laid down by somebody else: the cell waits and looks again
  indexed,  ///< a belt that moves one pitch on request and then stands (stop, look, pick)
};

struct FeedConfig {
  FeedKind kind = FeedKind::none;
  int advance_contact = 27010;  ///< network input: a rising edge asks for one pitch
  int moving_contact = 11;      ///< input contact: on while the belt moves
  double timeout_s = 30;        ///< a pitch takes no longer
  double look_again_s = 1;      ///< kind none: pause between looks when nothing is to be picked
  int empty_pitches_max = 20;   ///< stop after so many pitches (or looks) in a row without a part to pick; 0: never
};

struct CellConfig {
  std::filesystem::path file;
  std::string name;
  std::filesystem::path state_dir;  ///< journal.db and runs/
  int stop_after_refused = 5;       ///< picks in a row that the arm refused or missed; then fault
  int attempts_per_part = 2;        ///< picks of a part that stays where it is, before it is left alone
  double pick_timeout_s = 30;       ///< from hand-over to its end, on the cell's clock
  double camera_wait_s = 60;        ///< for a camera that got lost while the cell runs
  bool exchange_full_trays =
      false;                   ///< full trays are replaced while the cell runs on; otherwise it stands and says so
  bool record_frames = false;  ///< keep a PNG of every picture that was searched
  CameraConfig camera;
  RobotConfig robot;
  CalibrationConfig calibration;
  LimitsConfig limits;
  FeedConfig feed;
  std::vector<PartConfig> parts;
  std::string listen = "127.0.0.1:8080";  ///< of the HMI
};

/// Reads every key that belongs to the cell and notes what is wrong with the values in config; the caller reads tables
/// of its own ([sim]) and then calls finish(), which names the first problem or unknown key with its file.
[[nodiscard]] CellConfig read_cell_config(core::Config& config, const std::filesystem::path& file);

}  // namespace pickcell::cell
