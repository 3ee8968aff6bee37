/// pickcell calibrate camera: the lens from pictures of a board.

#include <CLI/CLI.hpp>
#include <algorithm>
#include <map>
#include <memory>
#include <ostream>

#include "pickcell/cli/calibrate/calibrate.hpp"
#include "pickcell/cli/calibrate/pictures.hpp"
#include "pickcell/poses/board.hpp"
#include "pickcell/poses/calibration_report.hpp"
#include "pickcell/poses/camera_calibration.hpp"
#include "pickcell/poses/verdicts.hpp"

namespace pickcell::cli {

using core::ErrorCode;
using core::failure;

namespace {

struct Options {
  std::vector<std::string> images;
  std::string board, camera_id, out, report;
  bool json = false;
};

using Size = std::pair<int, int>;

std::string text(const Size& size) { return std::to_string(size.first) + "x" + std::to_string(size.second); }

/// The size that most pictures share, of those with a board where there are any.
core::Result<Size> shared_size(const std::vector<BoardPicture>& pictures) {
  std::map<Size, std::pair<int, int>> counts;  // with a board, all
  for (const BoardPicture& p : pictures) {
    auto& count = counts[{p.width_px, p.height_px}];
    ++count.second;
    if (p.view) ++count.first;
  }
  const auto most =
      std::max_element(counts.begin(), counts.end(), [](const auto& a, const auto& b) { return a.second < b.second; });
  if (most->second.second < 3)
    return failure(ErrorCode::negative, "pictures",
                   "no size is shared by at least three of them (most: " + text(most->first) + ")",
                   "take at least three pictures with one camera setting");
  return most->first;
}

struct Sorted {
  std::vector<poses::NamedView> views;
  std::vector<poses::LeftOut> left_out;
  int found = 0;
};

Sorted sort_pictures(const std::vector<BoardPicture>& pictures, const Size& size) {
  Sorted out;
  for (const BoardPicture& p : pictures) {
    if (p.view) ++out.found;
    if (Size(p.width_px, p.height_px) != size)
      out.left_out.push_back(
          {p.name, "is " + text({p.width_px, p.height_px}) + " pixels, most pictures are " + text(size)});
    else if (!p.view)
      out.left_out.push_back({p.name, p.view.error().why});
    else
      out.views.push_back({p.name, *p.view});
  }
  return out;
}

core::Json sigma_json(const poses::LensSigma& sigma) {
  core::Json out = core::Json::object();
  out.set("fx_px", sigma.fx_px).set("fy_px", sigma.fy_px).set("cx_px", sigma.cx_px).set("cy_px", sigma.cy_px);
  return out.set("distortion", sigma.distortion);
}

core::Json per_image_json(const std::vector<poses::CameraView>& views) {
  core::Json out = core::Json::array();
  for (const poses::CameraView& v : views) {
    core::Json entry = core::Json::object();
    entry.set("image", v.image).set("points", v.view.ids.size()).set("rms_px", v.rms_px);
    out.push(entry.set("tilt_deg", v.tilt_deg));
  }
  return out;
}

double worst_px(const poses::CameraFit& fit) {
  double worst = 0;
  for (const poses::CameraView& v : fit.views) worst = std::max(worst, v.rms_px);
  return worst;
}

core::Json report_json(const poses::CameraFit& fit, std::size_t images, int found) {
  const poses::CameraCalibration& c = fit.calibration;
  core::Json out = core::Json::object();
  out.set("images", images).set("found", found).set("used", fit.views.size());
  out.set("left_out", left_out_json(fit.left_out)).set("model", c.model);
  out.set("rms_px", c.rms_px).set("holdout_rms_px", c.holdout_rms_px).set("worst_image_px", worst_px(fit));
  out.set("fx_px", c.lens.fx_px).set("fy_px", c.lens.fy_px).set("cx_px", c.lens.cx_px).set("cy_px", c.lens.cy_px);
  out.set("distortion", std::vector<double>(c.lens.distortion.begin(), c.lens.distortion.end()));
  out.set("sigma", sigma_json(fit.sigma)).set("coverage", fit.coverage);
  out.set("tilt_range_deg", fit.tilt_range_deg).set("largest_tilt_deg", fit.largest_tilt_deg);
  core::Json trials = core::Json::object();
  for (const poses::ModelTrial& t : fit.trials) trials.set(t.model, t.holdout_rms_px);
  out.set("holdout_by_model", trials).set("per_image", per_image_json(fit.views)).set("advice", fit.advice);
  return out.set("verdict", name(c.verdict)).set("why", fit.why);
}

void print_words(const poses::CameraFit& fit, const Options& options, Io& io) {
  using poses::figure;
  const poses::CameraCalibration& c = fit.calibration;
  io.out << options.out << ": " << name(c.verdict) << ": " << fit.why << "\n";
  io.out << "  " << fit.views.size() << " of " << options.images.size() << " pictures, model " << c.model << ", RMS "
         << figure(c.rms_px, 3) << " px, on pictures held out " << figure(c.holdout_rms_px, 3) << " px\n";
  io.out << "  fx " << figure(c.lens.fx_px, 2) << " +- " << figure(fit.sigma.fx_px, 2) << ", fy "
         << figure(c.lens.fy_px, 2) << " +- " << figure(fit.sigma.fy_px, 2) << ", centre " << figure(c.lens.cx_px, 2)
         << " +- " << figure(fit.sigma.cx_px, 2) << ", " << figure(c.lens.cy_px, 2) << " +- "
         << figure(fit.sigma.cy_px, 2) << " px\n";
  for (const poses::CameraView& v : fit.views)
    io.out << "  " << v.image << ": " << figure(v.rms_px, 3) << " px, inclined " << figure(v.tilt_deg, 0) << " deg\n";
  for (const poses::LeftOut& l : fit.left_out) io.out << "  left out: " << l.image << ": " << l.reason << "\n";
  for (const std::string& a : fit.advice) io.out << "  " << a << "\n";
}

core::Result<int> run(const Options& options, Io& io) {
  auto board = poses::parse_board(options.board);
  if (!board) return core::forward(board);
  auto pictures = find_boards({options.images.begin(), options.images.end()}, *board);
  if (!pictures) return core::forward(pictures);
  auto size = shared_size(*pictures);
  if (!size) return tl::unexpected(rejected(std::move(size.error()), options.json, io.out));
  Sorted sorted = sort_pictures(*pictures, *size);
  if (sorted.found == 0) return tl::unexpected(rejected(no_board(*pictures, *board), options.json, io.out));
  auto fit = poses::calibrate_camera(*board, std::move(sorted.views));
  if (!fit) return tl::unexpected(rejected(std::move(fit.error()), options.json, io.out));
  fit->left_out.insert(fit->left_out.begin(), sorted.left_out.begin(), sorted.left_out.end());
  fit->calibration.camera_id = options.camera_id;
  fit->calibration.date = today();
  auto saved = poses::save_camera(options.out, fit->calibration);
  if (!saved) return core::forward(saved);
  if (!options.report.empty())
    if (auto written = poses::write_camera_report(options.report, *board, *fit); !written)
      return core::forward(written);
  if (options.json)
    io.out << report_json(*fit, options.images.size(), sorted.found).dump() << "\n";
  else
    print_words(*fit, options, io);
  return fit->calibration.verdict == poses::Verdict::reject ? 1 : 0;
}

}  // namespace

Runner add_calibrate_camera(CLI::App& app) {
  auto options = std::make_shared<Options>();
  app.add_option("IMAGE", options->images, "pictures of the board, from one camera")->required();
  app.add_option("--board", options->board, "chessboard:9x6:25mm, charuco:5x7:36mm:18mm:6X6_250, ...")
      ->required()
      ->type_name("BOARD");
  app.add_option("--camera-id", options->camera_id, "the cell refuses the file for any other camera")->type_name("ID");
  app.add_option("-o,--out", options->out, "file to write")->required()->type_name("camera.toml");
  app.add_option("--report", options->report, "a page with pictures, residuals and the verdict")
      ->type_name("FILE.html");
  app.add_flag("--json", options->json, "report as one line of JSON");
  return [options](Io& io) { return run(*options, io); };
}

}  // namespace pickcell::cli
