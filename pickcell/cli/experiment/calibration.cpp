/// pickcell experiment calibration: the targets on real sets, faults that must be named, and errors against the truth.

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <ostream>

#include "pickcell/cli/calibrate/pictures.hpp"
#include "pickcell/cli/calibrate/scenes.hpp"
#include "pickcell/cli/experiment/experiment.hpp"
#include "pickcell/core/file.hpp"
#include "pickcell/poses/verdicts.hpp"

namespace pickcell::cli {

namespace {

namespace fs = std::filesystem;
using poses::figure;
using poses::Verdict;

/// One line of the table: what was asked, what came out, whether it holds.
struct Row {
  std::string set, wanted, reached;
  bool holds = false;
};

fs::path data_folder() {
  const char* given = std::getenv("PICKCELL_DATA");
  return fs::path(given ? given : "../shared/data") / "calibration";
}

std::vector<fs::path> pictures_in(const fs::path& folder) {
  std::vector<fs::path> out;
  std::error_code ignored;
  for (const auto& entry : fs::directory_iterator(folder, ignored))
    if (entry.path().extension() == ".jpg" || entry.path().extension() == ".png") out.push_back(entry.path());
  std::sort(out.begin(), out.end());
  return out;
}

core::Result<poses::CameraFit> fit_camera(const std::vector<fs::path>& files, const poses::Board& board, int width_px) {
  auto pictures = find_boards(files, board);
  if (!pictures) return core::forward(pictures);
  std::vector<poses::NamedView> views;
  for (BoardPicture& p : *pictures)
    if (p.view && p.width_px == width_px) views.push_back({p.path.filename().string(), *p.view});
  return poses::calibrate_camera(board, std::move(views));
}

Row opencv_left() {
  Row row{"opencv_left", "12 of 13, 0.19 px, f within 1 % of 533", "missing", false};
  const auto files = pictures_in(data_folder() / "opencv_left");
  if (files.empty()) return row;
  const auto fit = fit_camera(files, *poses::parse_board("chessboard:9x6:25mm"), 640);
  if (!fit) return row;
  const auto& c = fit->calibration;
  row.reached = std::to_string(fit->views.size()) + " of 13, " + figure(c.rms_px, 3) + " px, f " +
                figure(c.lens.fx_px, 1) + ", " + name(c.verdict);
  row.holds = fit->views.size() >= 12 && c.rms_px <= 0.19 && std::abs(c.lens.fx_px / 533 - 1) < 0.01;
  return row;
}

struct RctSet {
  std::string folder, board, wanted;
  poses::Mounting mounting;
  poses::Lens lens;
  std::size_t fewest;
  double joint_px, plane_mm;
};

core::Result<poses::HandeyeFit> fit_rct(const RctSet& set) {
  const fs::path folder = data_folder() / "rct" / set.folder;
  auto board = poses::parse_board(set.board);
  auto arm = poses::load_poses(folder / "cal_data.yaml");
  if (!arm) return core::forward(arm);
  std::vector<fs::path> files;
  for (const auto& pose : *arm) files.push_back(folder / pose.image);
  auto pictures = find_boards(files, *board);
  if (!pictures) return core::forward(pictures);
  poses::HandeyeInput input{set.lens, *board, set.mounting, Eigen::Isometry3d::Identity(), {}};
  for (std::size_t i = 0; i < files.size(); ++i)
    if ((*pictures)[i].view) input.views.push_back({{(*arm)[i].image, *(*pictures)[i].view}, (*arm)[i]});
  return poses::calibrate_handeye(input);
}

Row rct_row(const RctSet& set) {
  Row row{"rct " + set.folder + ", its lens given", set.wanted, "missing", false};
  const auto fit = fit_rct(set);
  if (!fit) return row;
  row.reached = std::to_string(fit->views.size()) + " used, joint " + figure(fit->rms_px, 2) + " px, plane " +
                figure(fit->plane_error_mm, 2) + " mm, " + name(fit->calibration.verdict);
  if (fit->own_lens) row.reached += "; the given lens does not fit: made with the pictures' own";
  row.holds = fit->views.size() >= set.fewest && fit->rms_px <= set.joint_px && fit->plane_error_mm <= set.plane_mm;
  return row;
}

std::vector<Row> real_sets() {
  const RctSet circles{"circles",
                       "circles:10x10:25.4mm",
                       "15 of 15, plane 2.9 mm",
                       poses::Mounting::eye_in_hand,
                       {640, 480, 542.324, 543.515, 320.474, 226.039, {}},
                       15,
                       1e9,
                       2.9};
  const RctSet charuco{"charuco",
                       "charuco:5x7:36.195mm:18.256mm:6X6_250",
                       "14 of 16, joint 1.5 px, plane 0.63 mm",
                       poses::Mounting::eye_to_hand,
                       {1600, 1200, 1352.02747, 1356.14287, 789.67065, 627.2995, {}},
                       14,
                       1.5,
                       0.63};
  return {opencv_left(), rct_row(circles), rct_row(charuco)};
}

Row clean_row(const HandeyeScene& scene, const poses::HandeyeInput& input) {
  Row row{"rendered, clean, " + scene.board.text, "good or better", "failed", false};
  const auto fit = poses::calibrate_handeye(input);
  if (!fit) return row;
  const auto error = error_of(fit->calibration.T_flange_camera->iso(), scene.T_flange_camera.iso());
  row.reached = std::string(name(fit->calibration.verdict)) + ", off the truth by " + figure(error.mm, 3) + " mm, " +
                figure(error.deg, 4) + " deg";
  row.holds = fit->calibration.verdict <= Verdict::good;
  return row;
}

Row fault_row(const PoseFault& fault, poses::HandeyeInput input, std::uint64_t seed) {
  fault.apply(input, seed);
  const auto fit = poses::calibrate_handeye(input);
  const Verdict verdict = fit ? fit->calibration.verdict : Verdict::reject;
  const std::string why = fit ? fit->why : fit.error().line();
  bool named = false;
  for (const std::string& word : fault.words) named = named || why.find(word) != std::string::npos;
  return {fault.name, "below good, named", std::string(name(verdict)) + ": " + why,
          verdict >= Verdict::usable && named};
}

struct NoiseRow {
  double noise_px = 0;
  TransformError rms, expected;
  double plane_rms_mm = 0, plane_worst_mm = 0;  ///< over trials of the mean, and of the worst corner
};

NoiseRow noise_row(const HandeyeScene& scene, double noise_px, int trials, std::uint64_t seed) {
  NoiseRow out;
  out.noise_px = noise_px;
  out.expected = expected_error(scene, noise_px);
  double plane2 = 0;
  for (int i = 0; i < trials; ++i) {
    // Of every trial its own: shared ones would repeat one sample of the noise at every level.
    const std::uint64_t s =
        (seed << 20) + static_cast<std::uint64_t>(std::lround(1000 * noise_px) << 10) + static_cast<std::uint64_t>(i);
    const auto fit = poses::calibrate_handeye(with_noisy_corners(scene, noise_px, s));
    const TransformError e =
        fit ? error_of(fit->calibration.T_flange_camera->iso(), scene.T_flange_camera.iso()) : TransformError{1e9, 1e9};
    out.rms.mm += e.mm * e.mm / trials;
    out.rms.deg += e.deg * e.deg / trials;
    const PlaneError plane = plane_error(noise_px, s);
    plane2 += plane.mean_mm * plane.mean_mm / trials;
    out.plane_worst_mm = std::max(out.plane_worst_mm, plane.worst_mm);
  }
  out.rms = {std::sqrt(out.rms.mm), std::sqrt(out.rms.deg)};
  out.plane_rms_mm = std::sqrt(plane2);
  return out;
}

core::Json row_json(const Row& row) {
  core::Json out = core::Json::object();
  out.set("set", row.set).set("wanted", row.wanted).set("reached", row.reached);
  return out.set("holds", row.holds);
}

std::string noise_text(const NoiseRow& n) {
  return "| " + figure(n.noise_px, 2) + " | " + figure(n.rms.mm, 4) + " | " + figure(n.expected.mm, 4) + " | " +
         figure(n.rms.deg, 5) + " | " + figure(n.expected.deg, 5) + " | " + figure(n.plane_rms_mm, 4) + " | " +
         figure(n.plane_worst_mm, 4) + " |\n";
}

core::Result<int> run(const ExperimentOptions& options, Io& io) {
  std::vector<Row> rows = real_sets();
  const HandeyeScene scene = handeye_scene(options.seed, 16);
  const poses::HandeyeInput clean = with_pictures(scene, options.seed);
  rows.push_back(clean_row(scene, clean));
  for (const char* board : {"charuco:9x7:25mm:18mm:5X5_100", "circles:9x6:25mm", "acircles:4x11:15mm"}) {
    const HandeyeScene other = handeye_scene(options.seed, 12, board);
    rows.push_back(clean_row(other, with_pictures(other, options.seed)));
  }
  for (const PoseFault& fault : pose_faults()) rows.push_back(fault_row(fault, clean, options.seed));
  std::vector<NoiseRow> noise;
  for (const double px : {0.05, 0.1, 0.2, 0.5})
    noise.push_back(noise_row(scene, px, options.n.value_or(50), options.seed));
  const NoiseRow& tenth = noise[1];
  rows.push_back({"0.1 px corner noise", "0.3 mm, 0.02 deg, plane 0.1 mm",
                  figure(tenth.rms.mm, 3) + " mm, " + figure(tenth.rms.deg, 4) + " deg, plane " +
                      figure(tenth.plane_worst_mm, 3) + " mm (worst corner of all trials)",
                  tenth.rms.mm <= 0.3 && tenth.rms.deg <= 0.02 && tenth.plane_worst_mm <= 0.1});
  std::string text = "| set | wanted | reached | holds |\n|---|---|---|---|\n";
  core::Json json = core::Json::array();
  bool all = true;
  for (const Row& r : rows) {
    text += "| " + r.set + " | " + r.wanted + " | " + r.reached + " | " + (r.holds ? "yes" : "NO") + " |\n";
    json.push(row_json(r));
    all = all && r.holds;
  }
  text +=
      "\nHand-eye and plane against the truth, RMS over trials; expected: Cramer-Rao bound\n"
      "| noise px | mm | expected mm | deg | expected deg | plane mm | plane mm, worst corner of all trials |\n"
      "|---|---|---|---|---|---|---|\n";
  for (const NoiseRow& n : noise) text += noise_text(n);
  if (auto written = core::write_file_atomically(options.out / "calibration.md", text); !written)
    return core::forward(written);
  core::Json line = core::Json::object();
  io.out << (options.json ? line.set("rows", json).set("holds", all).dump() + "\n" : text);
  return all ? 0 : 1;
}

const ExperimentRegistration registered(
    {"calibration",
     "targets on real sets, faults that must be named, errors against the truth; --n: trials per noise level", false,
     run});

}  // namespace

}  // namespace pickcell::cli
