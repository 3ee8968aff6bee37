#include "pickcell/poses/calibration_report.hpp"

#include <array>

#include "pickcell/poses/report_page.hpp"
#include "pickcell/poses/verdicts.hpp"

namespace pickcell::poses {

namespace {

using Rows = std::vector<std::vector<std::string>>;

void left_out_table(ReportPage& page, const std::vector<LeftOut>& left_out) {
  if (left_out.empty()) return;
  Rows rows;
  for (const LeftOut& l : left_out) rows.push_back({l.image, l.reason});
  page.table({"left out", "why"}, rows);
}

std::string with_sigma(double value, double sigma, int digits) {
  return figure(value, digits) + " ± " + figure(sigma, digits);
}

void lens_table(ReportPage& page, const CameraFit& fit) {
  const Lens& lens = fit.calibration.lens;
  Rows rows{{"fx, px", with_sigma(lens.fx_px, fit.sigma.fx_px, 2)},
            {"fy, px", with_sigma(lens.fy_px, fit.sigma.fy_px, 2)},
            {"cx, px", with_sigma(lens.cx_px, fit.sigma.cx_px, 2)},
            {"cy, px", with_sigma(lens.cy_px, fit.sigma.cy_px, 2)}};
  constexpr std::array<const char*, 8> kNames{"k1", "k2", "p1", "p2", "k3", "k4", "k5", "k6"};
  for (std::size_t i = 0; i < fit.sigma.distortion.size(); ++i)
    rows.push_back({kNames[i], with_sigma(lens.distortion[i], fit.sigma.distortion[i], 5)});
  page.table({"lens", "value ± standard deviation"}, rows);
  Rows trials;
  for (const ModelTrial& t : fit.trials)
    trials.push_back({t.model, figure(t.holdout_rms_px, 3), t.model == fit.calibration.model ? "taken" : ""});
  page.table({"distortion model", "hold-out error, px", ""}, trials);
}

}  // namespace

core::Status write_camera_report(const std::filesystem::path& path, const Board& board, const CameraFit& fit) {
  const CameraCalibration& c = fit.calibration;
  ReportPage page("Camera calibration", name(c.verdict), fit.why);
  page.paragraph(board.text + "; " + std::to_string(fit.views.size()) + " pictures of " +
                 std::to_string(c.lens.width_px) + "x" + std::to_string(c.lens.height_px) + "; RMS " +
                 figure(c.rms_px, 3) + " px, on pictures held out " + figure(c.holdout_rms_px, 3) + " px; " +
                 figure(100 * fit.coverage, 0) + " % of the picture covered, normals within " +
                 figure(fit.tilt_range_deg, 0) + " degrees.");
  for (const std::string& advice : fit.advice) page.paragraph("Missing: " + advice + ".");
  lens_table(page, fit);
  std::vector<ReportView> views;
  Rows rows;
  for (const CameraView& v : fit.views) {
    views.push_back({v.image, &v.view, &v.residual_px, {}});
    rows.push_back({v.image, std::to_string(v.view.ids.size()), figure(v.rms_px, 3), figure(v.tilt_deg, 1)});
  }
  page.table({"picture", "points", "RMS, px", "inclined, deg"}, rows);
  left_out_table(page, fit.left_out);
  page.coverage_map(views);
  page.histogram(views);
  page.pictures(views);
  return page.write(path);
}

core::Status write_handeye_report(const std::filesystem::path& path, const Board& board, const HandeyeFit& fit) {
  ReportPage page("Hand-eye calibration", name(fit.calibration.verdict), fit.why);
  page.paragraph(board.text + "; " + std::to_string(fit.views.size()) + " poses; joint reprojection " +
                 figure(fit.rms_px, 3) + " px; the board's place scatters by " + figure(fit.spread.mm, 2) + " mm and " +
                 figure(fit.spread.deg, 3) + " deg; error on the board's plane " + figure(fit.plane_error_mm, 3) +
                 " mm, on pictures held out " + figure(fit.holdout_mm, 3) + " mm.");
  Rows methods;
  for (const auto& [method, spread] : fit.by_method)
    methods.push_back({method, figure(spread.mm, 2), figure(spread.deg, 3)});
  methods.push_back({fit.method, figure(fit.spread.mm, 2), figure(fit.spread.deg, 3)});
  page.table({"method", "spread, mm", "spread, deg"}, methods);
  std::vector<ReportView> views;
  Rows rows;
  for (const HandeyeView& v : fit.views) {
    views.push_back({v.image, &v.view, &v.residual_px, {}});
    rows.push_back({v.image, std::to_string(v.view.ids.size()), figure(v.rms_px, 2), figure(v.picture_rms_px, 2),
                    figure(v.plane_error_mm, 2), figure(v.arm_mm, 1), figure(v.arm_deg, 2)});
  }
  page.table({"picture", "points", "RMS, px", "picture alone, px", "on the plane, mm", "pose off, mm", "pose off, deg"},
             rows);
  left_out_table(page, fit.left_out);
  page.coverage_map(views);
  page.histogram(views);
  page.pictures(views);
  return page.write(path);
}

core::Status write_plane_report(const std::filesystem::path& path, const std::string& image, const Lens& lens,
                                const PlaneFit& fit) {
  ReportPage page("Work plane calibration", name(fit.calibration.verdict), fit.why);
  page.paragraph(std::to_string(fit.error_mm.size()) + " points; RMS " + figure(fit.rms_mm, 3) + " mm, worst " +
                 figure(fit.worst_mm, 3) + " mm" +
                 (fit.loo_mm ? "; each predicted by the others: " + figure(*fit.loo_mm, 3) + " mm." : "."));
  BoardView view;
  view.width_px = lens.width_px;
  view.height_px = lens.height_px;
  view.pixels = fit.pixels;
  Rows rows;
  for (std::size_t i = 0; i < fit.error_mm.size(); ++i)
    rows.push_back({std::to_string(i + 1), figure(fit.pixels[i].x(), 1), figure(fit.pixels[i].y(), 1),
                    figure(fit.residual_px[i].norm(), 2), figure(fit.error_mm[i], 3)});
  page.table({"point", "u, px", "v, px", "off, px", "off on the plane, mm"}, rows);
  const std::vector<ReportView> views{{image.empty() ? "touched points" : image, &view, &fit.residual_px, {}}};
  page.coverage_map(views);
  page.histogram(views);
  page.pictures(views);
  return page.write(path);
}

core::Status write_verify_report(const std::filesystem::path& path, const std::string& image,
                                 const VerifyResult& result) {
  ReportPage page("Camera verification", name(result.verdict), result.why);
  page.table({"measure", "now", "allowed"},
             {{"drift on the plane, mm", figure(result.drift_mm, 3), figure(kDriftOkMm, 2)},
              {"drift, deg", figure(result.drift_deg, 4), figure(kDriftOkDeg, 2)},
              {"picture against the lens, px", figure(result.rms_px, 3), figure(kDriftPicturePx, 2)}});
  const std::vector<ReportView> views{{image, &result.view, &result.residual_px, {}}};
  page.coverage_map(views);
  page.histogram(views);
  page.pictures(views);
  return page.write(path);
}

}  // namespace pickcell::poses
