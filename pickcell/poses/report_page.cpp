#include "pickcell/poses/report_page.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

#include "pickcell/core/file.hpp"
#include "pickcell/core/statistics.hpp"
#include "pickcell/image/codec.hpp"
#include "pickcell/poses/verdicts.hpp"
#include "pickcell/poses/view_coverage.hpp"

namespace pickcell::poses {

namespace {

constexpr int kPictureWidthPx = 640;  ///< of the embedded previews

constexpr const char* kStyle =
    "<style>body{font:15px/1.5 system-ui,sans-serif;max-width:1000px;margin:2em auto;padding:0 1em;color:#222}"
    "table{border-collapse:collapse;margin:1em 0}td,th{border:1px solid #ccc;padding:.2em .6em;text-align:right}"
    "td:first-child,th:first-child{text-align:left}.verdict{padding:.6em 1em;border-radius:6px;color:#fff}"
    ".excellent,.good,.ok{background:#2a7d3f}.usable,.drifted{background:#8f6200}.reject{background:#b3261e}"
    "svg{display:block;max-width:100%;height:auto;margin:.5em 0 1.5em;background:#f4f4f4}</style>";

std::string escaped(const std::string& text) {
  std::string out;
  for (const char c : text) {
    if (c == '&')
      out += "&amp;";
    else if (c == '<')
      out += "&lt;";
    else if (c == '>')
      out += "&gt;";
    else if (c == '"')
      out += "&quot;";
    else
      out += c;
  }
  return out;
}

std::string base64(std::span<const std::byte> bytes) {
  constexpr const char* kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string out;
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::uint32_t v = 0;
    const std::size_t n = std::min<std::size_t>(3, bytes.size() - i);
    for (std::size_t k = 0; k < 3; ++k) v = v << 8 | (k < n ? std::to_integer<std::uint32_t>(bytes[i + k]) : 0u);
    for (std::size_t k = 0; k < 4; ++k) out += k <= n ? kDigits[v >> (18 - 6 * k) & 63] : '=';
  }
  return out;
}

/// The picture made smaller by a whole factor (means of blocks), as JPEG in a data URI; "" when it cannot be read.
std::string preview(const std::string& path) {
  const auto picture = image::load_grey(path);
  if (!picture) return {};
  const int factor = std::max(1, picture->width() / kPictureWidthPx);
  image::Image small(picture->width() / factor, picture->height() / factor);
  for (int y = 0; y < small.height(); ++y)
    for (int x = 0; x < small.width(); ++x) {
      int sum = 0;
      for (int j = 0; j < factor; ++j)
        for (int i = 0; i < factor; ++i) sum += picture->at(x * factor + i, y * factor + j);
      small.at(x, y) = static_cast<std::uint8_t>(sum / (factor * factor));
    }
  return "data:image/jpeg;base64," + base64(image::encode_jpeg(small.view(), 70));
}

std::string view_box(const BoardView& view) {
  return "viewBox=\"-0.5 -0.5 " + std::to_string(view.width_px) + " " + std::to_string(view.height_px) + "\"";
}

std::vector<double> lengths(const std::vector<ReportView>& views) {
  std::vector<double> out;
  for (const ReportView& v : views)
    for (const auto& r : *v.residual_px) out.push_back(r.norm());
  return out;
}

}  // namespace

ReportPage::ReportPage(const std::string& title, const std::string& verdict, const std::string& why) {
  html_ = "<!doctype html><html lang=\"en\"><meta charset=\"utf-8\"><title>" + escaped(title) + "</title>" + kStyle +
          "<h1>" + escaped(title) + "</h1><p class=\"verdict " + escaped(verdict) + "\"><b>" + escaped(verdict) +
          "</b>: " + escaped(why) + "</p>\n";
}

void ReportPage::paragraph(const std::string& text) { html_ += "<p>" + escaped(text) + "</p>\n"; }

void ReportPage::table(const std::vector<std::string>& header, const std::vector<std::vector<std::string>>& rows) {
  html_ += "<table><tr>";
  for (const std::string& h : header) html_ += "<th>" + escaped(h) + "</th>";
  html_ += "</tr>\n";
  for (const auto& row : rows) {
    html_ += "<tr>";
    for (const std::string& cell : row) html_ += "<td>" + escaped(cell) + "</td>";
    html_ += "</tr>\n";
  }
  html_ += "</table>\n";
}

void ReportPage::coverage_map(const std::vector<ReportView>& views) {
  if (views.empty()) return;
  const BoardView& first = *views.front().view;
  const std::string radius = figure(first.width_px / 250.0, 1);
  html_ += "<h2>Where the board was seen</h2><svg width=\"480\" " + view_box(first) + ">\n";
  for (std::size_t i = 0; i < views.size(); ++i) {
    const int hue = static_cast<int>(360 * i / views.size());
    html_ += "<g fill=\"hsl(" + std::to_string(hue) +
             ",70%,45%)\" fill-opacity=\".7\"><polygon fill-opacity=\".1\" points=\"";
    for (const auto& p : outline(*views[i].view)) html_ += figure(p.x(), 0) + "," + figure(p.y(), 0) + " ";
    html_ += "\"/>";
    for (const auto& p : views[i].view->pixels)
      html_ += "<circle cx=\"" + figure(p.x(), 1) + "\" cy=\"" + figure(p.y(), 1) + "\" r=\"" + radius + "\"/>";
    html_ += "</g>\n";
  }
  html_ += "</svg>\n";
}

void ReportPage::histogram(const std::vector<ReportView>& views) {
  const std::vector<double> all = lengths(views);
  if (all.empty()) return;
  constexpr int kBins = 30;
  const double end = std::max(1e-6, 1.2 * *core::quantile(all, 0.99));
  std::array<int, kBins> counts{};
  for (const double v : all) ++counts[static_cast<std::size_t>(std::min(kBins - 1.0, v / end * kBins))];
  const int most = *std::max_element(counts.begin(), counts.end());
  html_ += "<h2>Residuals</h2><svg width=\"480\" viewBox=\"0 0 480 190\">\n";
  for (int i = 0; i < kBins; ++i) {
    const double h = 150.0 * counts[static_cast<std::size_t>(i)] / most;
    html_ += "<rect x=\"" + std::to_string(16 * i) + "\" y=\"" + figure(160 - h, 1) + "\" width=\"14\" height=\"" +
             figure(h, 1) + "\" fill=\"#35618f\"/>";
  }
  html_ +=
      "<text x=\"2\" y=\"180\" font-size=\"12\">0 px</text><text x=\"478\" y=\"180\" font-size=\"12\" "
      "text-anchor=\"end\">" +
      figure(end, 2) + " px and more</text></svg>\n";
}

void ReportPage::pictures(const std::vector<ReportView>& views) {
  const std::vector<double> all = lengths(views);
  if (all.empty()) return;
  const double usual = std::max(1e-6, *core::quantile(all, 0.9));
  const double enlarged = std::max(1.0, std::round(views.front().view->width_px / 40.0 / usual));
  html_ +=
      "<h2>Pictures</h2><p>Circles: points as found. Arrows: from where the result expects a point to where it is "
      "seen, "
      "enlarged " +
      figure(enlarged, 0) +
      " times.</p>\n"
      "<svg width=\"0\" height=\"0\" style=\"position:absolute\"><defs><marker id=\"tip\" viewBox=\"0 0 6 6\" "
      "refX=\"5\" "
      "refY=\"3\" markerWidth=\"5\" markerHeight=\"5\" orient=\"auto\"><path d=\"M0 0L6 3L0 6z\" "
      "fill=\"#e5484d\"/></marker>"
      "</defs></svg>\n";
  for (const ReportView& v : views) {
    const std::string source = preview(v.image);
    const std::string size =
        " width=\"" + std::to_string(v.view->width_px) + "\" height=\"" + std::to_string(v.view->height_px) + "\"";
    const double stroke = v.view->width_px / 500.0;
    html_ += "<h3>" + escaped(v.image) + "</h3><svg width=\"640\" " + view_box(*v.view) + ">";
    if (!source.empty()) html_ += "<image x=\"-0.5\" y=\"-0.5\"" + size + " href=\"" + source + "\"/>";
    html_ += "<g fill=\"none\" stroke=\"#19c37d\" stroke-width=\"" + figure(stroke, 2) + "\">";
    std::string lines;
    for (std::size_t i = 0; i < v.view->pixels.size(); ++i) {
      const auto& p = v.view->pixels[i];
      const Eigen::Vector2d end = p + enlarged * (*v.residual_px)[i];
      html_ += "<circle cx=\"" + figure(p.x(), 1) + "\" cy=\"" + figure(p.y(), 1) + "\" r=\"" + figure(3 * stroke, 1) +
               "\"/>";
      lines += "<path d=\"M" + figure(p.x(), 1) + " " + figure(p.y(), 1) + "L" + figure(end.x(), 1) + " " +
               figure(end.y(), 1) + "\"/>";
    }
    html_ += "<g stroke=\"#e5484d\" marker-end=\"url(#tip)\">" + lines + "</g></g></svg>\n";
  }
}

core::Status ReportPage::write(const std::filesystem::path& path) const {
  return core::write_file_atomically(path, html_ + "</html>\n");
}

}  // namespace pickcell::poses
