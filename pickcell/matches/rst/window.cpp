#include "pickcell/matches/rst/window.hpp"

#include <algorithm>
#include <cmath>

#include "pickcell/matches/rst/kernels.hpp"
#include "pickcell/matches/similarity.hpp"

namespace pickcell::matches {
namespace {

constexpr double kEdge = 1e-9;  // a place on the last pixel is inside, although it was computed in floating point

/// How far along a row from..to lies within lo <= at + step * x <= hi.
void narrow(double at, double step, double lo, double hi, double& from, double& to) {
  if (std::abs(step) < 1e-12) {
    if (at < lo || at > hi) to = from - 1;
    return;
  }
  const double a = (lo - at) / step, b = (hi - at) / step;
  from = std::max(from, std::min(a, b));
  to = std::min(to, std::max(a, b));
}

class Builder {
 public:
  Builder(const WindowSource& source, double angle_deg, double scale) : s_(source) {
    const double a = angle_deg / kDegPerRad;
    c_ = std::cos(a) / scale;
    d_ = std::sin(a) / scale;
    if (std::abs(c_) < 1e-14) c_ = 0;  // exact quarter turns read whole pixels
    if (std::abs(d_) < 1e-14) d_ = 0;
    right_ = s_.grey.width() - 1 + kEdge;
    bottom_ = s_.grey.height() - 1 + kEdge;
    const double far_x = std::max(s_.anchor_x, s_.grey.width() - 1 - s_.anchor_x);
    const double far_y = std::max(s_.anchor_y, s_.grey.height() - 1 - s_.anchor_y);
    reach_ = static_cast<int>(std::ceil(std::hypot(far_x, far_y) * scale));
    const double r =
        std::min({s_.anchor_x, s_.grey.width() - 1 - s_.anchor_x, s_.anchor_y, s_.grey.height() - 1 - s_.anchor_y});
    disc_sq_ = s_.mask == WindowMask::disc ? r * r : std::numeric_limits<double>::infinity();
  }

  Window build() {
    for (int dy = -reach_; dy <= reach_; ++dy) row(dy);
    return std::move(out_);
  }

 private:
  void row(int dy) {
    double from = -reach_, to = reach_;
    narrow(s_.anchor_x - d_ * dy, c_, -kEdge, right_, from, to);
    narrow(s_.anchor_y + c_ * dy, d_, -kEdge, bottom_, from, to);
    if (s_.coverage.empty() && s_.mask == WindowMask::rect) {
      whole_row(dy, from, to);
      return;
    }
    bool open = false;
    for (int dx = static_cast<int>(std::ceil(from - 1e-6)); dx <= to + 1e-6; ++dx) {
      const double u = c_ * dx - d_ * dy, v = d_ * dx + c_ * dy;
      const bool part = belongs(u, v);
      if (part && !open) begin(dx, dy);
      if (part) add(s_.anchor_x + u, s_.anchor_y + v, dx);
      if (!part && open) end();
      open = part;
    }
    if (open) end();
  }

  /// Every pixel of the row's part that lies in the template.
  void whole_row(int dy, double from, double to) {
    int first = static_cast<int>(std::ceil(from - 1e-6)), last = static_cast<int>(std::floor(to + 1e-6));
    while (first <= last && !belongs(c_ * first - d_ * dy, d_ * first + c_ * dy)) ++first;
    while (first <= last && !belongs(c_ * last - d_ * dy, d_ * last + c_ * dy)) --last;
    if (first > last) return;
    begin(first, dy);
    for (int dx = first; dx <= last; ++dx)
      add(s_.anchor_x + (c_ * dx - d_ * dy), s_.anchor_y + (d_ * dx + c_ * dy), dx);
    end();
  }

  [[nodiscard]] bool belongs(double u, double v) const {
    const double x = s_.anchor_x + u, y = s_.anchor_y + v;
    if (x < -kEdge || y < -kEdge || x > right_ || y > bottom_ || u * u + v * v > disc_sq_) return false;
    if (s_.coverage.empty()) return true;
    const auto [x0, y0] = corner(x, y);
    const int x1 = std::min(x0 + 1, s_.grey.width() - 1), y1 = std::min(y0 + 1, s_.grey.height() - 1);
    const auto in = [&](int i, int j) { return s_.coverage.at(i, j) >= 0.5f; };
    return in(x0, y0) && in(x1, y0) && in(x0, y1) && in(x1, y1);
  }

  /// x, y >= -kEdge, so cutting rounds down.
  [[nodiscard]] std::pair<int, int> corner(double x, double y) const {
    return {std::min(static_cast<int>(x + kEdge), s_.grey.width() - 1),
            std::min(static_cast<int>(y + kEdge), s_.grey.height() - 1)};
  }

  void begin(int dx, int dy) { out_.runs.push_back({dy, dx, 0, out_.values.size()}); }

  void add(double x, double y, int dx) {
    const auto [x0, y0] = corner(x, y);
    const int x1 = std::min(x0 + 1, s_.grey.width() - 1);
    const std::uint8_t* a = s_.grey.row(y0);
    const std::uint8_t* b = s_.grey.row(std::min(y0 + 1, s_.grey.height() - 1));
    const double fx = x - x0, fy = y - y0;
    const double up = a[x0] + fx * (a[x1] - a[x0]), down = b[x0] + fx * (b[x1] - b[x0]);
    const int value = static_cast<int>(up + fy * (down - up) + 0.5);
    out_.values.push_back(static_cast<std::uint8_t>(value));
    out_.sum += value - 128;
    out_.sum_sq += (value - 128) * (value - 128);
    ++out_.pixels;
    ++out_.runs.back().length;
    if (out_.pixels == 1) out_.y_lo = out_.runs.back().dy, out_.x_lo = out_.x_hi = dx;
    out_.x_lo = std::min(out_.x_lo, dx);
    out_.x_hi = std::max(out_.x_hi, dx);
    out_.y_hi = out_.runs.back().dy;
  }

  void end() {
    while (out_.values.size() % kWindowBlock != 0) out_.values.push_back(128);
  }

  const WindowSource& s_;
  double c_ = 1, d_ = 0;
  double right_ = 0, bottom_ = 0, disc_sq_ = 0;
  int reach_ = 0;
  Window out_;
};

double ncc_of(double n, double i, double ii, double t, double tt, double it) {
  const double scene = n * ii - i * i, part = n * tt - t * t;
  if (scene <= 0 || part <= 0) return 0;
  return (n * it - i * t) / std::sqrt(scene * part);
}

}  // namespace

Window make_window(const WindowSource& source, double angle_deg, double scale) {
  return Builder(source, angle_deg, scale).build();
}

WindowScore score_window(image::ImageView picture, const Window& window, int x, int y) {
  const WindowSums s = sum_window(picture, window, x, y);
  const auto real = [](std::int64_t v) { return static_cast<double>(v); };
  return {ncc_of(real(s.n), real(s.i), real(s.ii), real(s.t), real(s.tt), real(s.it)),
          window.pixels > 0 ? real(s.n) / window.pixels : 0};
}

}  // namespace pickcell::matches
