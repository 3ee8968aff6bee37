#include "pickcell/cli/cell/start_demo.hpp"

#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <system_error>

#include "pickcell/cell/journal.hpp"
#include "pickcell/cli/calibrate/demo.hpp"
#include "pickcell/core/clock.hpp"
#include "pickcell/core/date.hpp"
#include "pickcell/core/file.hpp"
#include "pickcell/core/log.hpp"
#include "pickcell/core/units.hpp"
#include "pickcell/image/codec.hpp"
#include "pickcell/matches/model_file.hpp"
#include "pickcell/matches/teach.hpp"
#include "pickcell/poses/calibration.hpp"
#include "pickcell/sim/camera.hpp"
#include "pickcell/sim/teach_picture.hpp"
#include "pickcell/sim/world.hpp"

namespace pickcell::cli {

using core::ErrorCode;
using core::failure;
namespace fs = std::filesystem;

namespace {

/// Perspective and height change the size of a part over the field of view by about one per cent.
constexpr matches::Range kScale{0.95, 1.05};
constexpr std::size_t kKeptDemos = 10;

/// Trays beside the belt, out of the picture and within the job's window; angle and pitch in base.
struct TraySite {
  double x_mm, y_mm, angle_deg;
};
constexpr TraySite kTrays[] = {{150, 270, 0}, {675, 270, 90}, {150, -495, 0}, {675, -495, 90}};
constexpr int kRows = 4, kCols = 4;
constexpr double kPitchMm = 75;

template <class... Args>
std::string text(const char* format, Args... args) {
  char buffer[400];
  std::snprintf(buffer, sizeof buffer, format, args...);
  return buffer;
}

/// A rectangle of that size about the middle of the part.
matches::SearchOptions::Roi around(const sim::TeachPicture& taken, DemoOptions::TemplateSize size) {
  const int x = taken.roi_x + taken.roi_w / 2 - size.w / 2, y = taken.roi_y + taken.roi_h / 2 - size.h / 2;
  return {std::clamp(x, 0, taken.picture.width() - size.w), std::clamp(y, 0, taken.picture.height() - size.h), size.w,
          size.h};
}

core::Status teach_part(const fs::path& folder, const sim::TeachPicture& taken, const DemoOptions& options,
                        const std::string& date) {
  const std::string& kind = taken.kind;
  if (auto saved = image::save_png(folder / (kind + ".png"), taken.picture.view()); !saved) return saved;
  matches::TeachInput input;
  input.name = kind;
  input.date = date;
  input.picture = taken.picture.view();
  input.roi = matches::SearchOptions::Roi{taken.roi_x, taken.roi_y, taken.roi_w, taken.roi_h};
  if (options.template_px)
    input.roi = around(taken, *options.template_px);
  else
    input.mask = taken.mask.view();
  input.ref_px = {taken.ref_x_px, taken.ref_y_px};
  for (const sim::GraspPixel& g : taken.grasps) input.grasps.push_back({g.x_px, g.y_px, g.angle_deg, g.sym180});
  input.scale = kScale;
  input.height_m = core::m_from_mm(taken.height_mm);
  auto taught = matches::teach(input);
  if (!taught) return core::forward(taught);
  return matches::save_model(folder / (kind + ".pcm"), taught->model);
}

core::Status write_calibration(const fs::path& folder, const sim::CameraSettings& camera,
                               const sim::WorldSettings& world, const std::string& date) {
  poses::CameraCalibration c;
  const sim::Intrinsics& in = camera.intrinsics;
  c.lens.width_px = in.width_px;
  c.lens.height_px = in.height_px;
  c.lens.fx_px = in.fx_px;
  c.lens.fy_px = in.fy_px;
  c.lens.cx_px = in.cx_px;
  c.lens.cy_px = in.cy_px;
  std::copy(in.distortion.begin(), in.distortion.end(), c.lens.distortion.begin());
  c.model = "brown5";
  c.rms_px = c.holdout_rms_px = 0.05;
  c.camera_id = camera.camera_id;
  c.verdict = poses::Verdict::excellent;
  c.date = date;
  auto saved = poses::save_camera(folder / "camera.toml", c);
  if (!saved) return core::forward(saved);
  poses::PlaneCalibration plane;
  plane.T_base_plane = world.T_base_plane;
  plane.T_base_camera = camera.T_base_camera;
  plane.camera = saved->checksum;
  plane.rms_mm = 0.05;
  plane.verdict = poses::Verdict::excellent;
  plane.date = date;
  return poses::save_plane(folder / "plane.toml", plane);
}

core::Status calibrate(const fs::path& folder, const sim::CameraSettings& camera, const sim::WorldSettings& world,
                       const std::string& date) {
#ifdef PICKCELL_WITH_CALIBRATION
  return calibrate_demo(folder, camera, world, date);
#else
  core::log(
      core::LogLevel::warning, "calibration",
      "this build has no calibrate (PICKCELL_WITH_CALIBRATION): the cell takes the simulation's own lens and plane");
  return write_calibration(folder, camera, world, date);
#endif
}

std::string cell_toml(const DemoOptions& options, const sim::WorldSettings& world) {
  std::string kinds;
  for (const std::string& kind : options.kinds) kinds += (kinds.empty() ? "\"" : ", \"") + kind + "\"";
  std::string out =
      "# The demonstration cell: an indexed belt under a camera, one arm, a tray for each kind of part.\n"
      "[cell]\nname = \"demonstration\"\nstate_dir = \"state\"\nexchange_full_trays = true\n\n"
      "[camera]\nsource = \"sim\"\n\n"
      "[robot]\nlink = \"sim\"\nmodel = \"gp7\"\nframe = 0\ntool = 1\nallow_motion = true\n\n"
      "[calibration]\ncamera = \"camera.toml\"\nplane = \"plane.toml\"\n\n"
      "[limits]\nplace_mm = 1.0\nplace_deg = 1.0\ngripper_length_mm = 60\ngripper_width_mm = 20\n"
      "box_min_mm = [100, -550, -50]\nbox_max_mm = [750, 550, 350]\n\n"
      "[feed]\nkind = \"indexed\"\nadvance_contact = 27010\nmoving_contact = 11\n\n"
      "[server]\nlisten = \"127.0.0.1:8080\"\n\n";
  out += text("[sim]\nseed = %llu\nkinds = [%s]\n", static_cast<unsigned long long>(options.seed), kinds.c_str());
  const DemoOptions usual;
  if (options.parts_per_pitch != usual.parts_per_pitch) out += text("parts_per_pitch = %d\n", options.parts_per_pitch);
  if (options.camera_width_px != usual.camera_width_px || options.camera_height_px != usual.camera_height_px)
    out += text("camera_width_px = %d\ncamera_height_px = %d\n", options.camera_width_px, options.camera_height_px);
  const double floor_mm = core::mm_from_m(world.T_base_plane.translation_m().z());
  for (std::size_t i = 0; i < options.kinds.size(); ++i) {
    const TraySite& tray = kTrays[i];
    out += text(
        "\n[[part]]\nmodel = \"%s.pcm\"\n"
        "place = { origin_mm = [%.1f, %.1f, %.1f], angle_deg = %.1f, rows = %d, cols = %d, pitch_x_mm = %.1f, "
        "pitch_y_mm = %.1f }\n",
        options.kinds[i].c_str(), tray.x_mm, tray.y_mm, floor_mm, tray.angle_deg, kRows, kCols, kPitchMm, kPitchMm);
  }
  return out;
}

fs::path state_home() {
  const auto variable = [](const char* name) { return std::string(std::getenv(name) ? std::getenv(name) : ""); };
  if (const std::string state = variable("XDG_STATE_HOME"); !state.empty()) return state;
  if (const std::string home = variable("HOME"); !home.empty()) return fs::path(home) / ".local" / "state";
  return fs::temp_directory_path();
}

/// A cell that runs holds its journal.
bool in_use(const fs::path& demo) {
  const fs::path journal = demo / "state" / "journal.db";
  return fs::exists(journal) && !cell::SqliteJournal::open(journal);
}

/// Names begin with the date: the oldest come first.
void forget_old_demos(const fs::path& demos) {
  std::error_code ignored;
  std::vector<fs::path> folders;
  for (const fs::directory_entry& entry : fs::directory_iterator(demos, ignored))
    if (entry.is_directory(ignored) && fs::exists(entry.path() / "CELL.toml", ignored)) folders.push_back(entry.path());
  std::sort(folders.begin(), folders.end());
  for (std::size_t i = 0; i + kKeptDemos < folders.size(); ++i)
    if (!in_use(folders[i])) fs::remove_all(folders[i], ignored);
}

}  // namespace

core::Result<fs::path> prepare_demo(const fs::path& folder, const DemoOptions& options) {
  if (options.kinds.empty() || options.kinds.size() > std::size(kTrays))
    throw std::invalid_argument("the demonstration has trays for one to four kinds of parts");
  std::error_code problem;
  fs::create_directories(folder, problem);
  if (problem) return failure(ErrorCode::unreadable, folder.string(), problem.message());
  const sim::WorldSettings world = sim::default_world(options.seed);
  const sim::CameraSettings camera = sim::resized(sim::default_camera(world.T_base_plane, options.seed),
                                                  options.camera_width_px, options.camera_height_px);
  const std::string date = core::iso_utc(options.now_unix_us);
  for (const sim::TeachPicture& taken : sim::take_teach_pictures(options.kinds, camera, world.T_base_plane))
    if (auto taught = teach_part(folder, taken, options, date); !taught) return core::forward(taught);
  auto calibrated =
      options.calibrate ? calibrate(folder, camera, world, date) : write_calibration(folder, camera, world, date);
  if (!calibrated) return core::forward(calibrated);
  const fs::path file = folder / "CELL.toml";
  if (auto written = core::write_file_atomically(file, cell_toml(options, world)); !written)
    return core::forward(written);
  return file;
}

core::Result<fs::path> new_demo_folder() {
  const fs::path demos = state_home() / "pickcell" / "demo";
  std::error_code problem;
  fs::create_directories(demos, problem);
  if (problem) return failure(ErrorCode::unreadable, demos.string(), problem.message(), "set XDG_STATE_HOME");
  forget_old_demos(demos);
  const std::string name = core::utc(core::RealClock().unix_us(), "%Y%m%d-%H%M%S-") + std::to_string(getpid());
  return demos / name;
}

}  // namespace pickcell::cli
