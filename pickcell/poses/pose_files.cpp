#include "pickcell/poses/pose_files.hpp"

#include <charconv>
#include <cmath>
#include <map>
#include <set>

#include "pickcell/core/file.hpp"
#include "pickcell/core/units.hpp"
#include "pickcell/poses/csv_table.hpp"

namespace pickcell::poses {

namespace {

using core::ErrorCode;
using core::failure;

constexpr std::size_t kMaxPoses = 10'000;
constexpr double kQuaternionTolerance = 0.01;

/// A row of numbers under the given columns.
core::Result<Eigen::VectorXd> numbers(const CsvTable& table, std::size_t row, const std::vector<std::size_t>& columns) {
  Eigen::VectorXd out(static_cast<Eigen::Index>(columns.size()));
  for (std::size_t i = 0; i < columns.size(); ++i) {
    const auto value = table.number(row, columns[i]);
    if (!value) return tl::unexpected(value.error());
    out[static_cast<Eigen::Index>(i)] = *value;
  }
  return out;
}

/// What the header says of poses.
struct PoseColumns {
  std::size_t image = 0;
  std::vector<std::size_t> position, rotation;
  double position_unit_m = 1;
  double angle_unit_deg = 1;  ///< of Euler angles
  bool euler = false;
};

core::Result<PoseColumns> pose_columns(const CsvTable& table) {
  PoseColumns out;
  const bool mm = table.column("x_mm").has_value(), rad = table.column("rx_rad").has_value();
  out.euler = table.column("qw").has_value() ? false : (rad || table.column("rx_deg") || mm);
  out.position_unit_m = mm ? 1e-3 : 1;
  out.angle_unit_deg = rad ? core::deg_from_rad(1) : 1;
  std::vector<std::string> titles{"image"};
  for (const char* axis : {"x", "y", "z"}) titles.push_back(std::string(axis) + (mm ? "_mm" : "_m"));
  if (out.euler)
    for (const char* axis : {"rx", "ry", "rz"}) titles.push_back(std::string(axis) + (rad ? "_rad" : "_deg"));
  else
    for (const char* part : {"qx", "qy", "qz", "qw"}) titles.emplace_back(part);
  const auto columns = table.columns(titles);
  if (!columns) return tl::unexpected(columns.error());
  out.image = (*columns)[0];
  out.position.assign(columns->begin() + 1, columns->begin() + 4);
  out.rotation.assign(columns->begin() + 4, columns->end());
  return out;
}

core::Result<ArmPose> pose_of_row(const CsvTable& table, std::size_t row, const PoseColumns& columns) {
  ArmPose out;
  out.image = table.text(row, columns.image);
  if (out.image.empty()) return table.bad_row(row, "names no image", "name the picture taken at this pose");
  const auto position = numbers(table, row, columns.position);
  if (!position) return tl::unexpected(position.error());
  const auto rotation = numbers(table, row, columns.rotation);
  if (!rotation) return tl::unexpected(rotation.error());
  out.position_m = *position * columns.position_unit_m;
  out.euler = columns.euler;
  if (columns.euler) {
    out.angles_deg = *rotation * columns.angle_unit_deg;
    return out;
  }
  const double length = rotation->norm();
  if (std::abs(length - 1) > kQuaternionTolerance)
    return table.bad_row(row, "its quaternion has length " + std::to_string(length) + " instead of 1",
                         "check the columns qx,qy,qz,qw");
  out.quaternion = Eigen::Quaterniond((*rotation)[3], (*rotation)[0], (*rotation)[1], (*rotation)[2]).normalized();
  return out;
}

std::string_view trimmed(std::string_view text) {
  const std::size_t begin = text.find_first_not_of(" \t\r\"'");
  if (begin == std::string_view::npos) return {};
  return text.substr(begin, text.find_last_not_of(" \t\r\"'") - begin + 1);
}

/// One `key: value` of the small part of YAML that rct writes; item: the line began with "- ".
struct YamlLine {
  bool item = false;
  std::string key, value;
};

/// Lines without comments and blank lines; nothing else of YAML is understood.
core::Result<std::vector<YamlLine>> yaml_lines(std::string_view text, const std::string& name) {
  std::vector<YamlLine> out;
  if (text.starts_with("\xEF\xBB\xBF")) text.remove_prefix(3);
  for (int number = 1; !text.empty(); ++number) {
    const std::size_t end = text.find('\n');
    std::string_view line = text.substr(0, end);
    text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
    line = trimmed(line.substr(0, line.find('#')));
    if (line.empty() || line == "---" || line.starts_with("%")) continue;
    YamlLine entry;
    if (line.starts_with("- ")) {
      entry.item = true;
      line = trimmed(line.substr(2));
    }
    const std::size_t colon = line.find(':');
    if (colon == std::string_view::npos)
      return failure(ErrorCode::unreadable, name + " line " + std::to_string(number), "is no 'key: value'",
                     "expected the files that rct writes");
    entry.key = trimmed(line.substr(0, colon));
    entry.value = trimmed(line.substr(colon + 1));
    out.push_back(std::move(entry));
    if (out.size() > 4 * kMaxPoses) return failure(ErrorCode::unreadable, name, "is too long");
  }
  return out;
}

core::Status images_differ(const std::vector<ArmPose>& poses, const std::string& name) {
  std::set<std::string> seen;
  for (const ArmPose& p : poses)
    if (!seen.insert(p.image).second)
      return failure(ErrorCode::unreadable, name, "names the image " + p.image + " twice",
                     "give each picture one pose");
  if (poses.empty()) return failure(ErrorCode::unreadable, name, "holds no pose", "give at least three");
  return {};
}

}  // namespace

Eigen::Matrix3d rotation_zyx(const Eigen::Vector3d& angles_deg) {
  const auto turn = [&](int i, const Eigen::Vector3d& axis) {
    return Eigen::AngleAxisd(core::rad_from_deg(angles_deg[i]), axis);
  };
  return (turn(2, Eigen::Vector3d::UnitZ()) * turn(1, Eigen::Vector3d::UnitY()) * turn(0, Eigen::Vector3d::UnitX()))
      .toRotationMatrix();
}

Eigen::Isometry3d ArmPose::pose() const {
  Eigen::Isometry3d out = Eigen::Isometry3d::Identity();
  out.linear() = euler ? rotation_zyx(angles_deg) : quaternion.toRotationMatrix();
  out.translation() = position_m;
  return out;
}

core::Result<std::vector<ArmPose>> parse_pose_csv(std::string_view text, const std::string& name) {
  const auto table = CsvTable::parse(text, name);
  if (!table) return tl::unexpected(table.error());
  const auto columns = pose_columns(*table);
  if (!columns) return tl::unexpected(columns.error());
  std::vector<ArmPose> out;
  for (std::size_t row = 0; row < table->rows(); ++row) {
    auto pose = pose_of_row(*table, row, *columns);
    if (!pose) return core::forward(pose);
    out.push_back(std::move(*pose));
  }
  if (auto fine = images_differ(out, name); !fine) return core::forward(fine);
  return out;
}

core::Result<std::vector<TouchedPixel>> parse_points_csv(std::string_view text, const std::string& name) {
  const auto table = CsvTable::parse(text, name);
  if (!table) return tl::unexpected(table.error());
  const auto columns = table->columns({"u_px", "v_px", "x_mm", "y_mm", "z_mm"});
  if (!columns) return tl::unexpected(columns.error());
  std::vector<TouchedPixel> out;
  for (std::size_t row = 0; row < table->rows(); ++row) {
    const auto v = numbers(*table, row, *columns);
    if (!v) return tl::unexpected(v.error());
    out.push_back({v->head<2>(), v->tail<3>() * 1e-3});
  }
  return out;
}

core::Result<std::vector<TouchedCorner>> parse_touched_csv(std::string_view text, const std::string& name) {
  const auto table = CsvTable::parse(text, name);
  if (!table) return tl::unexpected(table.error());
  const auto columns = table->columns({"col", "row", "x_mm", "y_mm", "z_mm"});
  if (!columns) return tl::unexpected(columns.error());
  std::vector<TouchedCorner> out;
  for (std::size_t row = 0; row < table->rows(); ++row) {
    const auto at_col = table->whole_number(row, (*columns)[0]), at_row = table->whole_number(row, (*columns)[1]);
    if (!at_col) return tl::unexpected(at_col.error());
    if (!at_row) return tl::unexpected(at_row.error());
    const auto v = numbers(*table, row, {columns->begin() + 2, columns->end()});
    if (!v) return tl::unexpected(v.error());
    out.push_back({*at_col, *at_row, *v * 1e-3});
  }
  return out;
}

core::Result<std::vector<RctEntry>> parse_rct_list(std::string_view text, const std::string& name) {
  const auto lines = yaml_lines(text, name);
  if (!lines) return tl::unexpected(lines.error());
  std::vector<RctEntry> out;
  for (const YamlLine& line : *lines) {
    if (line.item) out.emplace_back();
    if (out.empty() || (line.key != "pose" && line.key != "image"))
      return failure(ErrorCode::unreadable, name, "has an unexpected key '" + line.key + "'",
                     "expected a list of pose and image");
    (line.key == "pose" ? out.back().pose : out.back().image) = line.value;
  }
  for (const RctEntry& e : out)
    if (e.pose.empty() || e.image.empty())
      return failure(ErrorCode::unreadable, name, "has an entry without pose or image", "name both in every entry");
  if (out.size() > kMaxPoses) return failure(ErrorCode::unreadable, name, "has more than 10000 entries");
  return out;
}

core::Result<ArmPose> parse_rct_pose(std::string_view text, const std::string& name) {
  const auto lines = yaml_lines(text, name);
  if (!lines) return tl::unexpected(lines.error());
  std::map<std::string, double> values;
  for (const YamlLine& line : *lines) {
    double value = 0;
    const char* end = line.value.data() + line.value.size();
    const auto [used, error] = std::from_chars(line.value.data(), end, value);
    if (error != std::errc{} || used != end || !std::isfinite(value))
      return failure(ErrorCode::unreadable, name, line.key + " is '" + line.value + "', which is no finite number",
                     "record this pose again");
    values[line.key] = value;
  }
  for (const char* key : {"x", "y", "z", "qx", "qy", "qz", "qw"})
    if (!values.contains(key))
      return failure(ErrorCode::unreadable, name, std::string("has no ") + key, "x, y, z, qx, qy, qz, qw are needed");
  ArmPose out;
  out.position_m = {values["x"], values["y"], values["z"]};
  const Eigen::Vector4d q(values["qx"], values["qy"], values["qz"], values["qw"]);
  if (std::abs(q.norm() - 1) > kQuaternionTolerance)
    return failure(ErrorCode::unreadable, name,
                   "its quaternion has length " + std::to_string(q.norm()) + " instead of 1", "record this pose again");
  out.quaternion = Eigen::Quaterniond(q[3], q[0], q[1], q[2]).normalized();
  return out;
}

core::Result<std::vector<ArmPose>> load_poses(const std::filesystem::path& path) {
  const auto text = core::read_text_file(path);
  if (!text) return tl::unexpected(text.error());
  if (path.extension() != ".yaml" && path.extension() != ".yml") return parse_pose_csv(*text, path.string());
  const auto entries = parse_rct_list(*text, path.string());
  if (!entries) return tl::unexpected(entries.error());
  std::vector<ArmPose> out;
  for (const RctEntry& entry : *entries) {
    const auto file = path.parent_path() / entry.pose;
    const auto pose_text = core::read_text_file(file, 1 << 16);
    if (!pose_text) return tl::unexpected(pose_text.error());
    auto pose = parse_rct_pose(*pose_text, file.string());
    if (!pose) return core::forward(pose);
    pose->image = entry.image;
    out.push_back(std::move(*pose));
  }
  if (auto fine = images_differ(out, path.string()); !fine) return core::forward(fine);
  return out;
}

}  // namespace pickcell::poses
