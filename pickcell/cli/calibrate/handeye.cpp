/// pickcell calibrate handeye: camera and arm, from pictures and arm poses.

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <memory>
#include <ostream>

#include "pickcell/cli/calibrate/calibrate.hpp"
#include "pickcell/cli/calibrate/pictures.hpp"
#include "pickcell/cli/values.hpp"
#include "pickcell/poses/calibration_report.hpp"
#include "pickcell/poses/handeye.hpp"
#include "pickcell/poses/verdicts.hpp"

namespace pickcell::cli {

using core::ErrorCode;
using core::failure;
namespace fs = std::filesystem;

namespace {

struct Options {
  std::string camera, poses, images, board, tool, out, report;
  bool eye_in_hand = false, eye_to_hand = false;
  bool keep_lens = false, json = false;
};

core::Result<Eigen::Isometry3d> parse_tool(const std::string& text) {
  Eigen::Isometry3d out = Eigen::Isometry3d::Identity();
  if (text.empty()) return out;
  const auto v = parse_numbers("--tool", text);
  if (!v) return tl::unexpected(v.error());
  if (v->size() != 6)
    return failure(ErrorCode::usage, "--tool", "'" + text + "' is no tool", "write x,y,z,rx,ry,rz in mm and degrees");
  out.linear() = poses::rotation_zyx({(*v)[3], (*v)[4], (*v)[5]});
  out.translation() = Eigen::Vector3d((*v)[0], (*v)[1], (*v)[2]) * 1e-3;
  return out;
}

/// The file of a pose's picture: in --images, by its name there, or beside the pose file.
core::Result<fs::path> picture_of(const std::string& image, const Options& options) {
  const fs::path folder = options.images;
  for (const fs::path& path :
       {folder / image, folder / fs::path(image).filename(), fs::path(options.poses).parent_path() / image})
    if (std::error_code ignored; fs::is_regular_file(path, ignored)) return path;
  return failure(ErrorCode::unreadable, image, "the pose file names this picture, but it is not in " + options.images,
                 "name the folder of the pictures with --images");
}

struct Prepared {
  poses::HandeyeInput input;
  std::vector<poses::LeftOut> left_out;
  poses::CameraCalibration camera;
};

std::string size_misfit(const BoardPicture& p, const poses::Lens& lens) {
  if (p.width_px == lens.width_px && p.height_px == lens.height_px) return {};
  return "is " + std::to_string(p.width_px) + "x" + std::to_string(p.height_px) +
         " pixels, the camera calibration is for " + std::to_string(lens.width_px) + "x" +
         std::to_string(lens.height_px);
}

/// At least one picture must have the lens's size; others are left out one by one.
core::Status sizes_fit(const std::vector<BoardPicture>& pictures, const poses::Lens& lens) {
  for (const BoardPicture& p : pictures)
    if (p.width_px == lens.width_px && p.height_px == lens.height_px) return {};
  return failure(ErrorCode::unreadable, pictures.front().name, size_misfit(pictures.front(), lens),
                 "use pictures of the calibrated size, or calibrate the camera again");
}

core::Result<Prepared> prepare(const Options& options, Io& io) {
  Prepared out;
  if (options.eye_in_hand == options.eye_to_hand)
    return failure(ErrorCode::usage, "calibrate handeye", "one of --eye-in-hand and --eye-to-hand must be given",
                   "say whether the camera is on the arm or beside it");
  out.input.mounting = options.eye_in_hand ? poses::Mounting::eye_in_hand : poses::Mounting::eye_to_hand;
  auto board = poses::parse_board(options.board);
  if (!board) return core::forward(board);
  out.input.board = *board;
  auto tool = parse_tool(options.tool);
  if (!tool) return core::forward(tool);
  out.input.T_flange_tool = *tool;
  auto camera = poses::load_camera(options.camera);
  if (!camera) return core::forward(camera);
  out.input.lens = camera->lens;
  out.input.keep_lens = options.keep_lens;
  out.camera = *camera;
  auto arm = poses::load_poses(options.poses);
  if (!arm) return core::forward(arm);
  std::vector<fs::path> paths;
  for (const poses::ArmPose& pose : *arm) {
    auto path = picture_of(pose.image, options);
    if (!path) return core::forward(path);
    paths.push_back(*path);
  }
  auto pictures = find_boards(paths, *board);
  if (!pictures) return core::forward(pictures);
  if (auto fit = sizes_fit(*pictures, camera->lens); !fit) return core::forward(fit);
  for (std::size_t i = 0; i < pictures->size(); ++i) {
    BoardPicture& p = (*pictures)[i];
    if (const std::string misfit = size_misfit(p, camera->lens); !misfit.empty())
      out.left_out.push_back({p.name, misfit});
    else if (p.view)
      out.input.views.push_back({{p.name, *p.view}, (*arm)[i]});
    else
      out.left_out.push_back({p.name, p.view.error().why});
  }
  const bool none = std::all_of(pictures->begin(), pictures->end(), [](const BoardPicture& p) { return !p.view; });
  if (none) return tl::unexpected(rejected(no_board(*pictures, *board), options.json, io.out));
  return out;
}

core::Json by_method_json(const poses::HandeyeFit& fit) {
  core::Json out = core::Json::object();
  for (const auto& [method, spread] : fit.by_method) {
    core::Json entry = core::Json::object();
    out.set(method, entry.set("spread_mm", spread.mm).set("spread_deg", spread.deg));
  }
  return out;
}

core::Json per_image_json(const poses::HandeyeFit& fit) {
  core::Json out = core::Json::array();
  for (const poses::HandeyeView& v : fit.views) {
    core::Json entry = core::Json::object();
    entry.set("image", v.image).set("points", v.view.ids.size()).set("rms_px", v.rms_px);
    entry.set("picture_rms_px", v.picture_rms_px).set("plane_error_mm", v.plane_error_mm);
    out.push(entry.set("pose_mm", v.arm_mm).set("pose_deg", v.arm_deg));
  }
  return out;
}

/// The camera file that goes with the result: the given one, or beside the result the lens it was made with instead.
core::Result<fs::path> save_lens(const poses::HandeyeFit& fit, const Options& options,
                                 poses::CameraCalibration& camera) {
  if (!fit.own_lens) return fs::path(options.camera);
  poses::CameraCalibration own = fit.own_lens->calibration;
  own.camera_id = camera.camera_id;
  own.date = today();
  const fs::path out = options.out;
  const fs::path path = out.parent_path() / (out.stem().string() + "-camera.toml");
  auto saved = poses::save_camera(path, std::move(own));
  if (!saved) return core::forward(saved);
  camera = std::move(*saved);
  return path;
}

core::Json report_json(const poses::HandeyeFit& fit, std::size_t poses_given, const fs::path& camera) {
  core::Json out = core::Json::object();
  out.set("method", fit.method).set("poses", poses_given).set("used", fit.views.size());
  out.set("left_out", left_out_json(fit.left_out)).set("rms_px", fit.rms_px);
  out.set("spread_mm", fit.spread.mm).set("spread_deg", fit.spread.deg).set("plane_error_mm", fit.plane_error_mm);
  out.set("holdout_mm", fit.holdout_mm);
  if (fit.calibration.T_flange_camera)
    out.set("T_flange_camera", matrix_json(fit.calibration.T_flange_camera->matrix()));
  if (fit.calibration.T_base_camera) out.set("T_base_camera", matrix_json(fit.calibration.T_base_camera->matrix()));
  out.set("by_method", by_method_json(fit)).set("per_image", per_image_json(fit));
  if (!fit.fault.empty()) out.set("fault", fit.fault);
  out.set("lens", fit.own_lens ? "pictures" : "given").set("camera", camera.string());
  return out.set("verdict", name(fit.calibration.verdict)).set("why", fit.why);
}

void print_words(const poses::HandeyeFit& fit, const Options& options, std::size_t poses_given, const fs::path& camera,
                 Io& io) {
  using poses::figure;
  io.out << options.out << ": " << name(fit.calibration.verdict) << ": " << fit.why << "\n";
  io.out << "  " << fit.views.size() << " of " << poses_given << " poses, " << fit.method << ": joint reprojection "
         << figure(fit.rms_px, 3) << " px, board's place within " << figure(fit.spread.mm, 2) << " mm and "
         << figure(fit.spread.deg, 3) << " deg, plane error " << figure(fit.plane_error_mm, 3) << " mm, held out "
         << figure(fit.holdout_mm, 3) << " mm\n";
  if (fit.own_lens) io.out << "  goes with " << camera.string() << ", not with " << options.camera << "\n";
  for (const auto& [method, spread] : fit.by_method)
    io.out << "  " << method << " alone: " << figure(spread.mm, 2) << " mm, " << figure(spread.deg, 3) << " deg\n";
  for (const poses::HandeyeView& v : fit.views)
    io.out << "  " << v.image << ": " << figure(v.rms_px, 2) << " px, " << figure(v.plane_error_mm, 2) << " mm\n";
  for (const poses::LeftOut& l : fit.left_out) io.out << "  left out: " << l.image << ": " << l.reason << "\n";
}

core::Result<int> run(const Options& options, Io& io) {
  auto prepared = prepare(options, io);
  if (!prepared) return core::forward(prepared);
  auto fit = poses::calibrate_handeye(prepared->input);
  if (!fit) return tl::unexpected(rejected(std::move(fit.error()), options.json, io.out));
  fit->left_out.insert(fit->left_out.begin(), prepared->left_out.begin(), prepared->left_out.end());
  auto camera = save_lens(*fit, options, prepared->camera);
  if (!camera) return core::forward(camera);
  fit->calibration.camera = prepared->camera.checksum;
  fit->calibration.board = options.board;
  fit->calibration.date = today();
  if (auto saved = poses::save_handeye(options.out, fit->calibration); !saved) return core::forward(saved);
  if (!options.report.empty())
    if (auto written = poses::write_handeye_report(options.report, prepared->input.board, *fit); !written)
      return core::forward(written);
  const std::size_t given = prepared->input.views.size() + prepared->left_out.size();
  if (options.json)
    io.out << report_json(*fit, given, *camera).dump() << "\n";
  else
    print_words(*fit, options, given, *camera, io);
  return fit->calibration.verdict == poses::Verdict::reject ? 1 : 0;
}

}  // namespace

Runner add_calibrate_handeye(CLI::App& app) {
  auto options = std::make_shared<Options>();
  app.add_option("--camera", options->camera, "the lens, from calibrate camera")->required()->type_name("camera.toml");
  app.add_option("--poses", options->poses, "CSV of arm poses, or an rct cal_data.yaml")
      ->required()
      ->type_name("POSES");
  app.add_option("--images", options->images, "folder of the pictures that the poses name")
      ->required()
      ->type_name("DIR");
  app.add_option("--board", options->board, "chessboard:9x6:25mm, ...")->required()->type_name("BOARD");
  app.add_flag("--eye-in-hand", options->eye_in_hand, "the camera is on the arm, the board stands still");
  app.add_flag("--eye-to-hand", options->eye_to_hand, "the camera stands still, the arm carries the board");
  app.add_option("--tool", options->tool, "the poses are the tool's: its place on the flange, mm and degrees")
      ->type_name("x,y,z,rx,ry,rz");
  app.add_flag("--keep-lens", options->keep_lens, "use the given lens even where the pictures contradict it");
  app.add_option("-o,--out", options->out, "file to write")->required()->type_name("handeye.toml");
  app.add_option("--report", options->report, "a page with pictures, residuals and the verdict")
      ->type_name("FILE.html");
  app.add_flag("--json", options->json, "report as one line of JSON");
  return [options](Io& io) { return run(*options, io); };
}

}  // namespace pickcell::cli
