/// What a recorded run says, checked key by key and column by column (recorded_run.hpp).

#include <cmath>
#include <limits>
#include <utility>

#include "pickcell/cell/recorded_run.hpp"
#include "pickcell/core/json.hpp"
#include "pickcell/core/units.hpp"
#include "pickcell/image/codec.hpp"

namespace pickcell::cell {

using core::ErrorCode;

namespace {

constexpr double kFarthestPx = 1e6;  ///< of anything from a picture's corner
constexpr double kFarthestMm = 1e6;  ///< of anything from the robot
constexpr double kRotationTolerance = 1e-6;

/// Columns one after the other. The first that is not what it should be is kept, and neutral values follow.
class Columns {
 public:
  Columns(const SqlRow& row, std::string where) : row_(row), where_(std::move(where)) {}

  std::int64_t integer(const char* name, std::int64_t lo, std::int64_t hi) {
    const auto* value = std::get_if<std::int64_t>(next());
    if (value && *value >= lo && *value <= hi) return *value;
    wrong(name, "is no whole number within " + std::to_string(lo) + " and " + std::to_string(hi));
    return lo;
  }
  double real(const char* name, double lo, double hi) {
    const SqlValue* value = next();
    const auto* number = std::get_if<double>(value);
    const auto* whole = std::get_if<std::int64_t>(value);
    const double v = number ? *number : whole ? static_cast<double>(*whole) : std::numeric_limits<double>::quiet_NaN();
    if (v >= lo && v <= hi) return v;
    wrong(name, "is no number within " + core::Json(lo).dump() + " and " + core::Json(hi).dump());
    return lo;
  }
  std::string text(const char* name) {
    if (const auto* value = std::get_if<std::string>(next())) return *value;
    wrong(name, "is no text");
    return {};
  }
  /// Steps over a column that holds nothing.
  bool empty() {
    const bool nothing = at_ >= row_.size() || std::holds_alternative<std::monostate>(row_[at_]);
    if (nothing) ++at_;
    return nothing;
  }
  void wrong(const std::string& name, const std::string& why) {
    if (!error_)
      error_ = core::Error{ErrorCode::unreadable,
                           where_,
                           "'" + name + "' " + why,
                           "the run's log is damaged or was changed by hand: restore it from its archive",
                           {}};
  }
  [[nodiscard]] const std::optional<core::Error>& error() const { return error_; }

 private:
  const SqlValue* next() {
    static const SqlValue nothing;
    return at_ < row_.size() ? &row_[at_++] : &nothing;
  }

  const SqlRow& row_;
  std::string where_;
  std::size_t at_ = 0;
  std::optional<core::Error> error_;
};

/// A run from elsewhere names no file outside of its own frames.
bool is_frame_file(const std::string& name) {
  constexpr std::string_view folder = "frames/";
  return name.starts_with(folder) && name.size() > folder.size() &&
         name.find('/', folder.size()) == std::string::npos && name.find('\0') == std::string::npos &&
         name.substr(folder.size()) != "..";
}

std::optional<core::Transform<core::Base, core::Flange>> transform_from(const std::string& text) {
  const auto rows = core::parse_json(text, "T_base_flange");
  if (!rows || rows->items().size() != 16) return std::nullopt;
  Eigen::Isometry3d iso = Eigen::Isometry3d::Identity();
  for (int i = 0; i < 16; ++i) {
    const auto number = rows->items()[static_cast<std::size_t>(i)].number();
    if (!number || !std::isfinite(*number)) return std::nullopt;
    iso.matrix()(i / 4, i % 4) = *number;
  }
  const Eigen::Matrix3d R = iso.linear();
  const bool rigid = (R * R.transpose() - Eigen::Matrix3d::Identity()).norm() < kRotationTolerance &&
                     R.determinant() > 0 && (iso.matrix().row(3) - Eigen::RowVector4d(0, 0, 0, 1)).norm() < 1e-9;
  if (!rigid) return std::nullopt;
  return core::Transform<core::Base, core::Flange>(iso);
}

/// Runs of format 1 tell reasons in words only. Those that the replay must not hold against the picture are known by
/// what was written then.
std::optional<std::string> code_of_format_1(bool rejected, const std::string& why) {
  if (!rejected) return "";
  if (why == "all places of the pattern are taken") return "pattern_full";
  if (why.starts_with("picking it failed")) return "gave_up";
  return std::nullopt;
}

template <class T>
core::Result<T> whole(T value, const Columns& columns) {
  if (columns.error()) return tl::unexpected(*columns.error());
  return value;
}

}  // namespace

RecordedInfo read_run_toml(core::Config& file, const std::filesystem::path& run) {
  RecordedInfo info;
  info.format = static_cast<int>(file.integer_or("format", 1));
  info.started = file.string("started");
  info.cell_name = file.string("cell");
  info.cell_file = file.string("cell_file");
  info.camera_id = file.string("camera_id");
  info.robot_link = file.string("robot_link");
  info.engine = file.string("engine");
  info.simulated = file.boolean_or("simulated", false);
  if (auto kept = file.table_if("kept")) info.kept = read_kept(*kept, run);
  return info;
}

RecordedPlace place_of(const poses::PartPose& part) {
  const Eigen::Vector3d p_m = part.T_base_part.translation_m();
  const Eigen::Matrix3d R = part.T_base_part.rotation();
  return {core::mm_from_m(p_m.x()), core::mm_from_m(p_m.y()), core::mm_from_m(p_m.z()),
          core::deg_from_rad(std::atan2(R(1, 0), R(0, 0)))};
}

core::Result<RecordedFrame> frame_from(const SqlRow& row, const std::string& where) {
  Columns columns(row, where);
  RecordedFrame out;
  out.sequence = columns.integer("sequence", 0, std::numeric_limits<std::int64_t>::max());
  out.exposed_unix_us = columns.integer("exposed_unix_us", 0, std::numeric_limits<std::int64_t>::max());
  out.camera_id = columns.text("camera_id");
  out.width_px = static_cast<int>(columns.integer("width_px", 1, image::kMaxSidePx));
  out.height_px = static_cast<int>(columns.integer("height_px", 1, image::kMaxSidePx));
  out.match_ms = columns.real("match_ms", 0, 1e9);
  if (!columns.empty()) {
    out.file = columns.text("file");
    if (!is_frame_file(out.file)) columns.wrong("file", "names no file of the run's folder frames");
  }
  if (!columns.empty()) {
    out.T_base_flange = transform_from(columns.text("T_base_flange"));
    if (!out.T_base_flange) columns.wrong("T_base_flange", "is no rigid transform of 16 numbers");
  }
  return whole(std::move(out), columns);
}

core::Result<RecordedFind> find_from(const SqlRow& row, const std::string& where) {
  Columns columns(row, where);
  RecordedFind out;
  out.id = columns.integer("id", 0, std::numeric_limits<std::int64_t>::max());
  out.part = columns.text("part");
  out.pose.x_px = columns.real("x_px", -kFarthestPx, kFarthestPx);
  out.pose.y_px = columns.real("y_px", -kFarthestPx, kFarthestPx);
  out.pose.angle_deg = columns.real("angle_deg", -360, 360);
  out.pose.scale = columns.real("scale", 1e-6, 1e6);
  out.score = columns.real("score", -1, 2);
  if (columns.empty()) {
    for (int i = 0; i < 3; ++i)
      if (!columns.empty()) columns.wrong("base_x_mm", "and the other three of the place are not all there or all not");
  } else {
    RecordedPlace place;
    place.x_mm = columns.real("base_x_mm", -kFarthestMm, kFarthestMm);
    place.y_mm = columns.real("base_y_mm", -kFarthestMm, kFarthestMm);
    place.z_mm = columns.real("base_z_mm", -kFarthestMm, kFarthestMm);
    place.angle_deg = columns.real("base_angle_deg", -360, 360);
    out.place = place;
  }
  out.rejected = columns.integer("rejected", 0, 1) != 0;
  out.why = columns.text("reason");
  out.code = columns.empty() ? code_of_format_1(out.rejected, out.why) : std::optional(columns.text("code"));
  if (out.code && out.code->empty() == out.rejected) columns.wrong("code", "and 'rejected' contradict each other");
  return whole(std::move(out), columns);
}

}  // namespace pickcell::cell
