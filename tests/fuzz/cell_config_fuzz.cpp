// CELL.toml and run.toml: what is accepted can be worked with, what is not is named on one line.

#include <cmath>
#include <cstdlib>
#include <string_view>

#include "pickcell/cell/cell_config.hpp"
#include "pickcell/cell/recorded_run.hpp"

namespace {

using namespace pickcell;

void need(bool holds) {
  if (!holds) std::abort();
}

void check(const cell::CellConfig& c) {
  for (std::size_t i = 0; i < 3; ++i) {
    need(c.limits.box_min_mm[i] < c.limits.box_max_mm[i]);
    need(std::isfinite(c.robot.home_mm[i]));
  }
  for (const double v : {c.limits.place_mm, c.limits.place_deg, c.limits.grasp_mm, c.limits.grasp_deg,
                         c.limits.approach_mm, c.limits.speed_pct, c.calibration.max_age_days, c.pick_timeout_s})
    need(std::isfinite(v) && v > 0);
  need(c.limits.speed_pct <= 100);
  need(c.limits.gripper_length_mm >= 0 && c.limits.gripper_width_mm >= 0);
  need(c.calibration.plane.empty() != c.calibration.handeye.empty());
  need(!c.parts.empty());
  for (const cell::PartConfig& part : c.parts) need(part.place.rows > 0 && part.place.cols > 0);
}

/// A run from elsewhere names files of its own folder only.
void check_run(std::string_view text) {
  auto file = core::Config::parse(text, "fuzz");
  if (!file) return;
  const cell::RecordedInfo info = cell::read_run_toml(*file, "/runs/1");
  if (!file->finish() || !info.kept) return;
  for (const auto& path : {info.kept->cell, info.kept->camera, info.kept->plane, info.kept->handeye})
    need(path.empty() || path.parent_path() == "/runs/1/cell");
  need(!info.kept->models.empty());
  for (const auto& path : info.kept->models) need(path.parent_path() == "/runs/1/cell" && path.filename() != "..");
}

/// The columns of picks.db that are texts with a form.
void check_row(std::string_view text) {
  const std::int64_t one = 1;
  const std::string words(text);
  const cell::SqlRow row{one, one, words, one, one, 1.0, words, words};
  const auto frame = cell::frame_from(row, "row");
  need(!frame || (frame->file.starts_with("frames/") && frame->T_base_flange));
  const auto posed = cell::frame_from({one, one, words, one, one, 1.0, std::monostate{}, words}, "row");
  need(!posed || std::abs(posed->T_base_flange->rotation().determinant() - 1) < 1e-4);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  check_run(text);
  check_row(text);
  auto file = core::Config::parse(text, "fuzz");
  if (!file) return 0;
  const cell::CellConfig config = cell::read_cell_config(*file, "/cells/fuzz.toml");
  if (const auto fine = file->finish(); fine)
    check(config);
  else
    need(fine.error().line().find('\n') == std::string::npos && !fine.error().what.empty());
  return 0;
}
