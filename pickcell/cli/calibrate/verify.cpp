/// pickcell calibrate verify: whether a camera still stands where it was calibrated.

#include <CLI/CLI.hpp>
#include <memory>
#include <ostream>

#include "pickcell/cli/calibrate/calibrate.hpp"
#include "pickcell/cli/calibrate/pictures.hpp"
#include "pickcell/cli/cell/setup.hpp"
#include "pickcell/poses/calibration_report.hpp"
#include "pickcell/poses/verdicts.hpp"
#include "pickcell/poses/verify.hpp"

namespace pickcell::cli {

using core::ErrorCode;
using core::failure;

namespace {

struct Options {
  std::string cell, image, board, report;
  bool json = false;
};

core::Result<poses::VerifyResult> verify_cell(const Options& options) {
  auto file = load_cell_file(options.cell);
  if (!file) return core::forward(file);
  const auto& paths = file->cell.calibration;
  auto camera = poses::load_camera(paths.camera);
  if (!camera) return core::forward(camera);
  if (paths.plane.empty())
    return failure(ErrorCode::usage, options.cell,
                   "has a hand-eye calibration, and a picture does not say where the arm stood",
                   "let the cell verify by itself: verify_at_start in [calibration]");
  auto plane = poses::load_plane(paths.plane);
  if (!plane) return core::forward(plane);
  if (plane->camera != camera->checksum)
    return failure(ErrorCode::unreadable, paths.plane.string(), "was made with another camera.toml",
                   "calibrate the plane again with this camera calibration");
  const std::string text = options.board.empty() ? plane->board : options.board;
  if (text.empty())
    return failure(ErrorCode::usage, "--board", "is missing, and " + paths.plane.string() + " names no board",
                   "calibrate the plane with --board-image and --touched");
  auto board = poses::parse_board(text);
  if (!board) return core::forward(board);
  auto pictures = find_boards({options.image}, *board);
  if (!pictures) return core::forward(pictures);
  const BoardPicture& picture = pictures->front();
  if (picture.width_px != camera->lens.width_px || picture.height_px != camera->lens.height_px)
    return failure(ErrorCode::unreadable, picture.name, "has another size than the camera calibration",
                   "take it with the cell's camera settings");
  if (!picture.view) return tl::unexpected(no_board(*pictures, *board));
  return poses::verify(camera->lens, *plane, *board, *picture.view);
}

core::Result<int> run(const Options& options, Io& io) {
  auto result = verify_cell(options);
  if (!result) return tl::unexpected(rejected(std::move(result.error()), options.json, io.out));
  if (!options.report.empty())
    if (auto written = poses::write_verify_report(options.report, options.image, *result); !written)
      return core::forward(written);
  if (options.json) {
    core::Json out = core::Json::object();
    out.set("drift_mm", result->drift_mm).set("drift_deg", result->drift_deg).set("rms_px", result->rms_px);
    io.out << out.set("verdict", name(result->verdict)).set("why", result->why).dump() << "\n";
  } else {
    io.out << name(result->verdict) << ": " << result->why << "\n";
  }
  return result->verdict == poses::Drift::ok ? 0 : 1;
}

}  // namespace

Runner add_calibrate_verify(CLI::App& app) {
  auto options = std::make_shared<Options>();
  app.add_option("--cell", options->cell, "the cell whose calibration is checked")->required()->type_name("CELL.toml");
  app.add_option("IMAGE", options->image, "picture of the board in its reference place")->required();
  app.add_option("--board", options->board, "default: the board in plane.toml")->type_name("BOARD");
  app.add_option("--report", options->report, "a page with the picture, the shifts and the verdict")
      ->type_name("FILE.html");
  app.add_flag("--json", options->json, "report as one line of JSON");
  return [options](Io& io) { return run(*options, io); };
}

}  // namespace pickcell::cli
