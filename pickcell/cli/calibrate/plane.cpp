/// pickcell calibrate plane: a fixed camera over a work plane.

#include <CLI/CLI.hpp>
#include <memory>
#include <ostream>

#include "pickcell/cli/calibrate/calibrate.hpp"
#include "pickcell/cli/calibrate/pictures.hpp"
#include "pickcell/core/file.hpp"
#include "pickcell/core/units.hpp"
#include "pickcell/poses/calibration_report.hpp"
#include "pickcell/poses/plane_calibration.hpp"
#include "pickcell/poses/verdicts.hpp"

namespace pickcell::cli {

using core::ErrorCode;
using core::failure;

namespace {

struct Options {
  std::string camera, board_image, board, touched, points, out, report;
  double height_mm = 0;
  bool json = false;
};

core::Result<poses::BoardView> see_board(const Options& options, const poses::Board& board, const poses::Lens& lens) {
  auto pictures = find_boards({options.board_image}, board);
  if (!pictures) return core::forward(pictures);
  BoardPicture& picture = pictures->front();
  if (picture.width_px != lens.width_px || picture.height_px != lens.height_px)
    return failure(ErrorCode::unreadable, picture.name,
                   "is " + std::to_string(picture.width_px) + "x" + std::to_string(picture.height_px) +
                       " pixels, the camera calibration is for " + std::to_string(lens.width_px) + "x" +
                       std::to_string(lens.height_px),
                   "use a picture of the calibrated size, or calibrate the camera again");
  if (!picture.view) return tl::unexpected(no_board(*pictures, board));
  return *picture.view;
}

core::Result<poses::PlaneFit> fit_from_board(const Options& options, const poses::Lens& lens, double height_m) {
  if (options.board.empty())
    return failure(ErrorCode::usage, "--board-image", "--board is missing", "say what board the picture shows");
  auto board = poses::parse_board(options.board);
  if (!board) return core::forward(board);
  auto view = see_board(options, *board, lens);
  if (!view) return core::forward(view);
  if (options.touched.empty()) return poses::plane_from_board(lens, *board, *view, height_m);
  auto text = core::read_text_file(options.touched);
  if (!text) return core::forward(text);
  auto touched = poses::parse_touched_csv(*text, options.touched);
  if (!touched) return core::forward(touched);
  return poses::plane_from_touched_board(lens, *board, *view, *touched, height_m);
}

core::Result<poses::PlaneFit> fit_plane(const Options& options, const poses::Lens& lens) {
  const double height_m = core::m_from_mm(options.height_mm);
  if (options.points.empty() == options.board_image.empty())
    return failure(ErrorCode::usage, "calibrate plane", "one of --points and --board-image must be given",
                   "see 'pickcell calibrate plane --help'");
  if (!options.board_image.empty()) return fit_from_board(options, lens, height_m);
  auto text = core::read_text_file(options.points);
  if (!text) return core::forward(text);
  auto points = poses::parse_points_csv(*text, options.points);
  if (!points) return core::forward(points);
  return poses::plane_from_points(lens, *points, height_m);
}

core::Json report_json(const poses::PlaneFit& fit) {
  core::Json out = core::Json::object();
  out.set("points", fit.error_mm.size()).set("rms_mm", fit.rms_mm);
  out.set("loo_mm", fit.loo_mm ? core::Json(*fit.loo_mm) : core::Json());
  out.set("worst_mm", fit.worst_mm).set("T_base_plane", matrix_json(fit.calibration.T_base_plane.matrix()));
  out.set("T_base_camera", matrix_json(fit.calibration.T_base_camera.matrix())).set("error_mm", fit.error_mm);
  out.set("board_frame_only", fit.calibration.board_frame_only);
  return out.set("verdict", name(fit.calibration.verdict)).set("why", fit.why);
}

void print_words(const poses::PlaneFit& fit, const Options& options, Io& io) {
  using poses::figure;
  io.out << options.out << ": " << name(fit.calibration.verdict) << ": " << fit.why << "\n  " << fit.error_mm.size()
         << " points: RMS " << figure(fit.rms_mm, 3) << " mm, worst " << figure(fit.worst_mm, 3) << " mm"
         << (fit.loo_mm ? ", leave-one-out " + figure(*fit.loo_mm, 3) + " mm" : "") << "\n";
  if (fit.calibration.board_frame_only) return;
  for (std::size_t i = 0; i < fit.error_mm.size(); ++i)
    io.out << "  point " << i + 1 << ": " << figure(fit.error_mm[i], 3) << " mm\n";
}

core::Result<int> run(const Options& options, Io& io) {
  auto camera = poses::load_camera(options.camera);
  if (!camera) return core::forward(camera);
  auto fit = fit_plane(options, camera->lens);
  if (!fit) return tl::unexpected(rejected(std::move(fit.error()), options.json, io.out));
  fit->calibration.camera = camera->checksum;
  fit->calibration.date = today();
  if (auto saved = poses::save_plane(options.out, fit->calibration); !saved) return core::forward(saved);
  if (!options.report.empty())
    if (auto written = poses::write_plane_report(options.report, options.board_image, camera->lens, *fit); !written)
      return core::forward(written);
  if (options.json)
    io.out << report_json(*fit).dump() << "\n";
  else
    print_words(*fit, options, io);
  return fit->calibration.verdict == poses::Verdict::reject ? 1 : 0;
}

}  // namespace

Runner add_calibrate_plane(CLI::App& app) {
  auto options = std::make_shared<Options>();
  app.add_option("--camera", options->camera, "the lens, from calibrate camera")->required()->type_name("camera.toml");
  app.add_option("--board-image", options->board_image, "picture of a board that lies on the plane")->type_name("IMG");
  app.add_option("--board", options->board, "chessboard:9x6:25mm, ...")->type_name("BOARD");
  app.add_option("--touched", options->touched, "corners touched by the tool: col,row,x_mm,y_mm,z_mm")
      ->type_name("TOUCHED.csv");
  app.add_option("--points", options->points, "points touched and seen: u_px,v_px,x_mm,y_mm,z_mm")
      ->type_name("POINTS.csv");
  app.add_option("--height-mm", options->height_mm, "of the touched or board surface above the work plane");
  app.add_option("-o,--out", options->out, "file to write")->required()->type_name("plane.toml");
  app.add_option("--report", options->report, "a page with the points, their errors and the verdict")
      ->type_name("FILE.html");
  app.add_flag("--json", options->json, "report as one line of JSON");
  return [options](Io& io) { return run(*options, io); };
}

}  // namespace pickcell::cli
