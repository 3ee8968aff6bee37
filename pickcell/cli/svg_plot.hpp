#pragma once
/// Small plots for people, as SVG text: one set of axes with bars, points and marked values.

#include <string>
#include <vector>

namespace pickcell::cli {

/// One direction of a plot. With categories the values are their places: category i is centred at i.
struct PlotAxis {
  std::string label;  ///< with its unit
  double lo = 0;
  double hi = 1;
  bool logarithmic = false;  ///< lo and hi above 0
  std::vector<std::string> categories;
};

/// From the axis (or the lower end of it) up to y, between x0 and x1.
struct PlotBar {
  double x0 = 0;
  double x1 = 0;
  double y = 0;
  std::string label;  ///< written above; may be empty
};

struct PlotPoint {
  double x = 0;
  double y = 0;
};

/// What is drawn in one colour and named in the legend.
struct PlotSeries {
  std::string name;
  std::vector<PlotBar> bars;
  std::vector<PlotPoint> points;
};

/// A vertical line with a word beside it.
struct PlotMark {
  double x = 0;
  std::string label;
};

struct Plot {
  std::string title;
  std::string subtitle;
  PlotAxis x;
  PlotAxis y;
  std::vector<PlotSeries> series;
  std::vector<PlotMark> marks;
};

/// Values at which an axis is labelled: round numbers inside [lo, hi], about `wanted` of them; decades (and 2, 5 within
/// a few decades) on a logarithmic axis.
[[nodiscard]] std::vector<double> axis_ticks(const PlotAxis& axis, int wanted = 6);

/// A whole SVG file. Values outside the axes are drawn at their ends.
[[nodiscard]] std::string to_svg(const Plot& plot);

}  // namespace pickcell::cli
