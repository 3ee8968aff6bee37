#include "pickcell/cli/svg_plot.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

namespace pickcell::cli {

namespace {

constexpr double kWidth = 760;
constexpr double kHeight = 440;
constexpr double kLeft = 72;
constexpr double kRight = 24;
constexpr double kTop = 64;
constexpr double kBottom = 64;
constexpr const char* kInk = "#2b3036";
constexpr const char* kSoftInk = "#6a727b";
constexpr const char* kPanel = "#f3f4f6";
constexpr const char* kGrid = "#d9dde1";
constexpr std::array kColours = {"#2f5f8a", "#c9742b", "#5b8c5a", "#8a5a8d"};  // apart for colour-blind eyes, too

std::string number(double v) {
  char text[32];
  std::snprintf(text, sizeof text, "%.2f", v);
  return text;
}

std::string tick_text(double v) {
  char text[32];
  std::snprintf(text, sizeof text, "%.6g", v);
  return text;
}

std::string escaped(const std::string& text) {
  std::string out;
  for (const char c : text) {
    switch (c) {
      case '&':
        out += "&amp;";
        break;
      case '<':
        out += "&lt;";
        break;
      case '>':
        out += "&gt;";
        break;
      case '"':
        out += "&quot;";
        break;
      default:
        out += static_cast<unsigned char>(c) < 0x20 ? ' ' : c;
    }
  }
  return out;
}

std::string text_at(double x, double y, const std::string& text, const char* anchor, const char* colour, int size_px,
                    const std::string& more = {}) {
  return "<text x=\"" + number(x) + "\" y=\"" + number(y) + "\" text-anchor=\"" + anchor + "\" fill=\"" + colour +
         "\" font-size=\"" + std::to_string(size_px) + "\"" + more + ">" + escaped(text) + "</text>\n";
}

std::string line(double x0, double y0, double x1, double y1, const char* colour, const char* more = "") {
  return "<line x1=\"" + number(x0) + "\" y1=\"" + number(y0) + "\" x2=\"" + number(x1) + "\" y2=\"" + number(y1) +
         "\" stroke=\"" + colour + "\"" + more + "/>\n";
}

/// Place of a value between the ends of an axis, 0..1.
double fraction(const PlotAxis& axis, double v) {
  if (!axis.categories.empty()) return (v + 0.5) / static_cast<double>(axis.categories.size());
  if (axis.logarithmic)
    v = std::log(std::max(v, axis.lo) / axis.lo) / std::log(axis.hi / axis.lo);
  else
    v = (v - axis.lo) / (axis.hi - axis.lo);
  return std::clamp(v, 0.0, 1.0);
}

double x_of(const Plot& plot, double v) { return kLeft + fraction(plot.x, v) * (kWidth - kLeft - kRight); }
double y_of(const Plot& plot, double v) { return kHeight - kBottom - fraction(plot.y, v) * (kHeight - kTop - kBottom); }

std::vector<double> log_ticks(const PlotAxis& axis) {
  std::vector<double> out;
  const bool few_decades = axis.hi / axis.lo < 2e3;
  const int last = static_cast<int>(std::ceil(std::log10(axis.hi)));
  for (int decade = static_cast<int>(std::floor(std::log10(axis.lo))); decade <= last; ++decade) {
    for (const double step : {1.0, 2.0, 5.0}) {
      const double v = step * std::pow(10.0, decade);
      if ((step == 1.0 || few_decades) && v >= axis.lo * (1 - 1e-9) && v <= axis.hi * (1 + 1e-9)) out.push_back(v);
    }
  }
  return out;
}

std::string axes(const Plot& plot) {
  const double bottom = kHeight - kBottom;
  const double right = kWidth - kRight;
  std::string out = "<rect x=\"" + number(kLeft) + "\" y=\"" + number(kTop) + "\" width=\"" + number(right - kLeft) +
                    "\" height=\"" + number(bottom - kTop) + "\" fill=\"" + kPanel + "\"/>\n";
  for (const double v : axis_ticks(plot.y)) {
    out += line(kLeft, y_of(plot, v), right, y_of(plot, v), kGrid);
    out += text_at(kLeft - 8, y_of(plot, v) + 4, tick_text(v), "end", kInk, 12);
  }
  for (std::size_t i = 0; i < plot.x.categories.size(); ++i)
    out += text_at(x_of(plot, static_cast<double>(i)), bottom + 18, plot.x.categories[i], "middle", kInk, 12);
  if (plot.x.categories.empty()) {
    for (const double v : axis_ticks(plot.x)) {
      out += line(x_of(plot, v), kTop, x_of(plot, v), bottom, kGrid);
      out += text_at(x_of(plot, v), bottom + 18, tick_text(v), "middle", kInk, 12);
    }
  }
  out += text_at((kLeft + right) / 2, kHeight - 16, plot.x.label, "middle", kInk, 13);
  const double middle = (kTop + bottom) / 2;
  out += text_at(20, middle, plot.y.label, "middle", kInk, 13, " transform=\"rotate(-90 20 " + number(middle) + ")\"");
  return out + line(kLeft, bottom, right, bottom, kSoftInk);
}

std::string drawn(const Plot& plot, const PlotSeries& series, const char* colour) {
  const double bottom = kHeight - kBottom;
  std::string out = "<g fill=\"" + std::string(colour) + "\">\n";
  for (const PlotBar& bar : series.bars) {
    const double x0 = x_of(plot, bar.x0) + 0.5;
    const double width = std::max(x_of(plot, bar.x1) - 0.5 - x0, 0.5);
    const double top = y_of(plot, bar.y);
    out += "<rect x=\"" + number(x0) + "\" y=\"" + number(top) + "\" width=\"" + number(width) + "\" height=\"" +
           number(bottom - top) + "\"/>\n";
    if (!bar.label.empty()) out += text_at(x0 + width / 2, top - 5, bar.label, "middle", kInk, 11);
  }
  for (const PlotPoint& p : series.points)
    out += "<circle cx=\"" + number(x_of(plot, p.x)) + "\" cy=\"" + number(y_of(plot, p.y)) +
           "\" r=\"3.2\" fill-opacity=\"0.65\"/>\n";
  return out + "</g>\n";
}

/// A mark's word stands left of its line where there is no room to the right of it.
std::string mark(const Plot& plot, const PlotMark& mark, double text_y) {
  const double x = x_of(plot, mark.x);
  const bool to_the_left = x + 7.0 * static_cast<double>(mark.label.size()) > kWidth - kRight;
  return line(x, kTop, x, kHeight - kBottom, kInk, " stroke-dasharray=\"4 3\"") +
         text_at(to_the_left ? x - 5 : x + 5, text_y, mark.label, to_the_left ? "end" : "start", kInk, 11,
                 " paint-order=\"stroke\" stroke=\"#f3f4f6\" stroke-width=\"4\"");
}

std::string legend(const Plot& plot) {
  std::string out;
  double x = kWidth - kRight;
  for (std::size_t i = plot.series.size(); i-- > 0 && plot.series.size() > 1;) {
    x -= 7.0 * static_cast<double>(plot.series[i].name.size());
    out += text_at(x, kTop - 10, plot.series[i].name, "start", kInk, 12);
    x -= 16;
    out += "<rect x=\"" + number(x) + "\" y=\"" + number(kTop - 20) + "\" width=\"11\" height=\"11\" fill=\"" +
           kColours[i % kColours.size()] + "\"/>\n";
    x -= 14;
  }
  return out;
}

}  // namespace

std::vector<double> axis_ticks(const PlotAxis& axis, int wanted) {
  if (axis.logarithmic) return log_ticks(axis);
  const double raw = (axis.hi - axis.lo) / std::max(wanted, 1);
  const double decade = std::pow(10.0, std::floor(std::log10(raw)));
  double step = 10 * decade;
  for (const double s : {5.0, 2.0, 1.0})
    if (s * decade >= raw * 0.999) step = s * decade;
  std::vector<double> out;
  for (double i = std::ceil(axis.lo / step - 1e-9) + 0.0 /* not -0 */; i * step <= axis.hi + 1e-9 * step; ++i)
    out.push_back(i * step);
  return out;
}

std::string to_svg(const Plot& plot) {
  std::string out =
      "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"" + number(kWidth) + "\" height=\"" + number(kHeight) +
      "\" viewBox=\"0 0 " + number(kWidth) + " " + number(kHeight) +
      "\" font-family=\"'DejaVu Sans', Arial, sans-serif\">\n<rect width=\"100%\" height=\"100%\" fill=\"#ffffff\"/>\n";
  out += text_at(kLeft, 26, plot.title, "start", kInk, 16, " font-weight=\"600\"");
  out += text_at(kLeft, 46, plot.subtitle, "start", kSoftInk, 12);
  out += legend(plot) + axes(plot);
  for (std::size_t i = 0; i < plot.series.size(); ++i)
    out += drawn(plot, plot.series[i], kColours[i % kColours.size()]);
  double text_y = kTop + 14;
  for (const PlotMark& m : plot.marks) {
    out += mark(plot, m, text_y);
    text_y += 16;
  }
  return out + "</svg>\n";
}

}  // namespace pickcell::cli
