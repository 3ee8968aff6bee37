#include "pickcell/cell/cell_config.hpp"

#include <algorithm>

namespace pickcell::cell {

using core::Config;

namespace {

double positive(Config& table, const char* key, double otherwise) {
  const double v = table.number_or(key, otherwise);
  if (v <= 0) table.problem(key, "must be above 0");
  return v;
}

int whole(Config& table, const char* key, int otherwise, int lo, int hi) {
  const std::int64_t v = table.integer_or(key, otherwise);
  if (v < lo || v > hi) table.problem(key, "must be within " + std::to_string(lo) + " and " + std::to_string(hi));
  return static_cast<int>(v);
}

/// Contacts are counted in groups of eight: 27010..27017, 27020..27027, ...
int contact(Config& table, const char* key, int otherwise) {
  const int v = whole(table, key, otherwise, 10, 99999);
  if (v % 10 > 7) table.problem(key, "is no contact: their numbers end in 0 to 7");
  return v;
}

std::array<double, 3> triple(Config& table, const char* key) {
  const std::vector<double> v = table.numbers(key);
  if (v.size() == 3) return {v[0], v[1], v[2]};
  if (!v.empty()) table.problem(key, "must have three numbers: x, y, z");
  return {};
}

CameraConfig read_camera(Config table) {
  CameraConfig out;
  out.source = table.string("source");
  out.id = table.string_or("id", "");
  out.fps = table.number_or("fps", 0);
  out.loop = table.boolean_or("loop", false);
  if (out.fps < 0) table.problem("fps", "must not be negative");
  if (auto settings = table.table_if("settings"))
    for (const std::string& key : settings->keys())
      if (auto set = frames::set(out.settings, key, settings->text(key)); !set)
        settings->problem(key, set.error().why + (set.error().remedy.empty() ? "" : "; " + set.error().remedy));
  return out;
}

RobotConfig read_robot(Config table) {
  RobotConfig out;
  out.link = table.string("link");
  out.model = table.string_or("model", "gp7");
  out.frame = whole(table, "frame", 0, 0, 65);
  out.tool = whole(table, "tool", 1, 0, 63);
  out.allow_motion = table.boolean_or("allow_motion", false);
  if (table.has("home_mm")) out.home_mm = triple(table, "home_mm");
  out.gripper_output = whole(table, "gripper_output", out.gripper_output, 1, 4096);
  out.grip_sensor_input = whole(table, "grip_sensor_input", out.grip_sensor_input, 1, 4096);
  return out;
}

CalibrationConfig read_calibration(Config table) {
  CalibrationConfig out;
  out.camera = table.path("camera");
  if (table.has("handeye")) {
    out.handeye = table.path("handeye");
    if (table.has("plane")) table.problem("handeye", "and plane are given: one of them says where the camera stands");
    if (table.path_if("plane")) return out;
    if (table.has("plane_z_mm")) out.plane_z_mm = table.number("plane_z_mm");
    const std::vector<double> tool = table.numbers_or("flange_tool_mm_deg", std::vector<double>(6, 0.0));
    if (tool.size() == 6)
      std::copy(tool.begin(), tool.end(), out.flange_tool_mm_deg.begin());
    else
      table.problem("flange_tool_mm_deg", "must have six numbers: x, y, z in mm, rx, ry, rz in degrees");
  } else {
    out.plane = table.path("plane");
  }
  out.max_age_days = positive(table, "max_age_days", 365);
  const std::string verify = table.string_or("verify_at_start", "never");
  if (verify == "board_stays")
    out.verify_at_start = VerifyAtStart::board_stays;
  else if (verify == "board_is_taken_away")
    out.verify_at_start = VerifyAtStart::board_is_taken_away;
  else if (verify != "never")
    table.problem("verify_at_start", "must be \"never\", \"board_stays\" or \"board_is_taken_away\"");
  return out;
}

LimitsConfig read_limits(Config table) {
  LimitsConfig out;
  out.place_mm = positive(table, "place_mm", out.place_mm);
  out.place_deg = positive(table, "place_deg", out.place_deg);
  out.grasp_mm = positive(table, "grasp_mm", out.grasp_mm);
  out.grasp_deg = positive(table, "grasp_deg", out.grasp_deg);
  for (const auto& [key, value] :
       {std::pair{"gripper_length_mm", &out.gripper_length_mm}, std::pair{"gripper_width_mm", &out.gripper_width_mm}}) {
    *value = table.number_or(key, 0);
    if (*value < 0) table.problem(key, "must not be negative");
  }
  if ((out.gripper_length_mm > 0) != (out.gripper_width_mm > 0))
    table.problem("gripper_length_mm", "and gripper_width_mm belong together: one of them is missing");
  out.speed_pct = positive(table, "speed_pct", out.speed_pct);
  if (out.speed_pct > 100) table.problem("speed_pct", "must be at most 100");
  out.box_min_mm = triple(table, "box_min_mm");
  out.box_max_mm = triple(table, "box_max_mm");
  for (std::size_t i = 0; i < 3; ++i)
    if (table.has("box_min_mm") && table.has("box_max_mm") && out.box_min_mm[i] >= out.box_max_mm[i]) {
      table.problem("box_max_mm", "must be above box_min_mm in every direction");
      break;
    }
  out.approach_mm = positive(table, "approach_mm", out.approach_mm);
  return out;
}

PlaceConfig read_place(Config table) {
  PlaceConfig out;
  out.origin_mm = triple(table, "origin_mm");
  out.angle_deg = table.number_or("angle_deg", 0);
  out.rows = whole(table, "rows", 1, 1, 1000);
  out.cols = whole(table, "cols", 1, 1, 1000);
  out.pitch_x_mm = table.number_or("pitch_x_mm", 0);
  out.pitch_y_mm = table.number_or("pitch_y_mm", 0);
  if (out.cols > 1 && out.pitch_x_mm == 0) table.problem("pitch_x_mm", "is needed for more than one column");
  if (out.rows > 1 && out.pitch_y_mm == 0) table.problem("pitch_y_mm", "is needed for more than one row");
  return out;
}

PartConfig read_part(Config table) {
  PartConfig out;
  out.model = table.path("model");
  if (table.has("height_mm")) {
    out.height_mm = table.number("height_mm");
    if (*out.height_mm < 0) table.problem("height_mm", "must not be negative");
  }
  out.place = read_place(table.table("place"));
  return out;
}

FeedConfig read_feed(Config table) {
  FeedConfig out;
  const std::string kind = table.string_or("kind", "none");
  if (kind == "indexed")
    out.kind = FeedKind::indexed;
  else if (kind != "none")
    table.problem("kind", "must be \"none\" or \"indexed\"");
  out.advance_contact = contact(table, "advance_contact", out.advance_contact);
  out.moving_contact = contact(table, "moving_contact", out.moving_contact);
  out.timeout_s = positive(table, "timeout_s", out.timeout_s);
  out.look_again_s = positive(table, "look_again_s", out.look_again_s);
  out.empty_pitches_max = whole(table, "empty_pitches_max", out.empty_pitches_max, 0, 1'000'000);
  return out;
}

}  // namespace

CellConfig read_cell_config(Config& config, const std::filesystem::path& file) {
  CellConfig out;
  out.file = file;
  Config cell = config.table("cell");
  out.name = cell.string_or("name", file.stem().string());
  out.state_dir = cell.path_if("state_dir").value_or(std::filesystem::absolute(file).parent_path() / "state");
  out.stop_after_refused = whole(cell, "stop_after_refused", out.stop_after_refused, 1, 1000);
  out.attempts_per_part = whole(cell, "attempts_per_part", out.attempts_per_part, 1, 100);
  out.pick_timeout_s = positive(cell, "pick_timeout_s", out.pick_timeout_s);
  out.camera_wait_s = positive(cell, "camera_wait_s", out.camera_wait_s);
  out.exchange_full_trays = cell.boolean_or("exchange_full_trays", out.exchange_full_trays);
  out.record_frames = cell.boolean_or("record_frames", false);
  out.camera = read_camera(config.table("camera"));
  out.robot = read_robot(config.table("robot"));
  out.calibration = read_calibration(config.table("calibration"));
  if (out.robot.frame != 0 && !out.calibration.handeye.empty())
    config.problem("robot", "frame must be 0 with a hand-eye calibration, whose arm poses are in the base frame");
  out.limits = read_limits(config.table("limits"));
  out.feed = read_feed(config.table("feed"));
  for (const Config& part : config.tables("part")) out.parts.push_back(read_part(part));
  if (out.parts.empty()) config.problem("part", "is missing: at least one [[part]] is needed");
  out.listen = config.table("server").string_or("listen", out.listen);
  return out;
}

}  // namespace pickcell::cell
