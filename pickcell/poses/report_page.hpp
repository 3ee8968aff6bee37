#pragma once
/// The pieces of a calibration report: one self-contained HTML page with inline SVG. Built with
/// PICKCELL_WITH_CALIBRATION only.

#include <Eigen/Core>
#include <filesystem>
#include <string>
#include <vector>

#include "pickcell/core/result.hpp"
#include "pickcell/poses/board.hpp"

namespace pickcell::poses {

/// What a page shows of one picture.
struct ReportView {
  std::string image;  ///< path; a picture that can no longer be read is drawn without its pixels
  const BoardView* view = nullptr;
  const std::vector<Eigen::Vector2d>* residual_px = nullptr;
  std::vector<std::string> cells;  ///< of its table row, after the image's name
};

/// Collects a page from top to bottom; everything given is escaped.
class ReportPage {
 public:
  /// verdict: one of the words of a verdict or of verify; it chooses the colour.
  ReportPage(const std::string& title, const std::string& verdict, const std::string& why);
  void paragraph(const std::string& text);
  /// Header row, then one row per view.
  void table(const std::vector<std::string>& header, const std::vector<std::vector<std::string>>& rows);
  /// Every point of all views in one picture's frame.
  void coverage_map(const std::vector<ReportView>& views);
  /// Lengths of all residuals.
  void histogram(const std::vector<ReportView>& views);
  /// The picture with corners as circles and residuals as lines, enlarged so that the largest are seen.
  void pictures(const std::vector<ReportView>& views);
  [[nodiscard]] core::Status write(const std::filesystem::path& path) const;

 private:
  std::string html_;
};

}  // namespace pickcell::poses
