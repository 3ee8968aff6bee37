#include "pickcell/matches/learn/self_match.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "pickcell/image/pyramid.hpp"

namespace pickcell::matches {

namespace {

constexpr double kStepDeg = 2;
constexpr double kMaxWorkSidePx = 64;    ///< of the square of the part's area at the working level; at least half of it
constexpr double kAllAlike = 0.95;       ///< a disc with a mark: any turn is nearly the same
constexpr double kDiscStepDeg = 30;      ///< of the turns told of a disc
constexpr double kNearlySame = 0.9;      ///< a matcher under occlusion and blur may take it for the true angle
constexpr double kHopeless = 0.3;        ///< not worth climbing from
constexpr double kNearDeg = 20;          ///< the true angle's own shoulder
constexpr double kRepeats = 0.8;         ///< a copy beside the part, as a matcher may take it for the part
constexpr double kRepeatCover = 0.5;     ///< of the part must lie on itself to tell
constexpr double kRepeatDip = 0.3;       ///< a smooth part resembles itself nearby without repeating
constexpr double kRectangleCover = 0.8;  ///< without a mask the corners are background

/// The template at the level where the search is cheap and shapes are still to be told apart.
struct Work {
  image::Image picture;
  image::Image mask;
  double area = 0;
  double centre_x = 0, centre_y = 0;
  bool masked = false;
  int px_per_pixel = 1;  ///< of the template
};

Work make_work(image::ImageView picture, image::ImageView mask) {
  Work work;
  work.masked = !mask.empty();
  image::Image full;
  if (!work.masked) {
    full.resize(picture.width(), picture.height());
    full.fill(255);
  }
  const image::ImageView part = work.masked ? mask : full.view();
  double area = 0;
  for (int y = 0; y < part.height(); ++y)
    for (int x = 0; x < part.width(); ++x) area += part.at(x, y) >= 128 ? 1 : 0;
  image::Pyramid pictures, masks;
  pictures.build(picture, 4);
  masks.build(part, 4);
  int level = 0;
  for (double side = std::sqrt(area); side > kMaxWorkSidePx && level + 1 < pictures.levels(); side /= 2) ++level;
  work.px_per_pixel = 1 << level;
  work.picture = image::Image(pictures.level(level));
  work.mask = image::Image(masks.level(level));
  for (int y = 0; y < work.mask.height(); ++y)
    for (int x = 0; x < work.mask.width(); ++x)
      if (work.mask.at(x, y) >= 128) {
        work.area += 1;
        work.centre_x += x;
        work.centre_y += y;
      }
  work.centre_x /= std::max(1.0, work.area);
  work.centre_y /= std::max(1.0, work.area);
  return work;
}

struct Comparison {
  double ncc = 0;    ///< 0 where one of the two is flat
  double cover = 0;  ///< share of the part that lies on the part
};

/// The template and itself turned about the centre and moved by (dx, dy).
Comparison compare(const Work& work, double angle_deg, double dx, double dy) {
  const double a = angle_deg * std::numbers::pi / 180;
  const double c = std::cos(a), s = std::sin(a);
  double n = 0, sum_a = 0, sum_b = 0, sum_aa = 0, sum_bb = 0, sum_ab = 0;
  const int last_x = work.picture.width() - 1, last_y = work.picture.height() - 1;
  for (int y = 0; y <= last_y; ++y)
    for (int x = 0; x <= last_x; ++x) {
      if (work.mask.at(x, y) < 128) continue;
      const double u = x - work.centre_x, v = y - work.centre_y;
      const double fx = work.centre_x + dx + c * u + s * v, fy = work.centre_y + dy - s * u + c * v;
      if (!(fx >= 0 && fy >= 0 && fx <= last_x && fy <= last_y)) continue;
      const int ix = std::min(static_cast<int>(fx), last_x - 1), iy = std::min(static_cast<int>(fy), last_y - 1);
      if (work.mask.at(static_cast<int>(fx + 0.5), static_cast<int>(fy + 0.5)) < 128) continue;
      const double wx = fx - ix, wy = fy - iy;
      const double there = (work.picture.at(ix, iy) * (1 - wx) + work.picture.at(ix + 1, iy) * wx) * (1 - wy) +
                           (work.picture.at(ix, iy + 1) * (1 - wx) + work.picture.at(ix + 1, iy + 1) * wx) * wy;
      const double here = work.picture.at(x, y);
      n += 1;
      sum_a += here;
      sum_b += there;
      sum_aa += here * here;
      sum_bb += there * there;
      sum_ab += here * there;
    }
  if (n < 0.2 * work.area || n < 9) return {};
  const double var_a = sum_aa - sum_a * sum_a / n, var_b = sum_bb - sum_b * sum_b / n;
  const double cover = n / work.area;
  if (var_a < n || var_b < n) return {0, cover};
  return {(sum_ab - sum_a * sum_b / n) / std::sqrt(var_a * var_b), cover};
}

double likeness(const Work& work, double angle_deg, double dx, double dy) {
  const Comparison c = compare(work, angle_deg, dx, dy);
  return std::max(0.0, c.ncc) * (work.masked ? c.cover : std::min(1.0, c.cover / kRectangleCover));
}

/// Whether the part looks the same beside itself: the best local maximum over shifts that leave most of it on itself
/// and that are parted from no shift at all by places where it looks otherwise.
std::optional<Repeat> repeat_of(const Work& work) {
  const int reach_x = static_cast<int>((1 - kRepeatCover) * work.picture.width());
  const int reach_y = static_cast<int>((1 - kRepeatCover) * work.picture.height());
  image::Plane<float> ncc(2 * reach_x + 1, 2 * reach_y + 1);
  for (int y = -reach_y; y <= reach_y; ++y)
    for (int x = -reach_x; x <= reach_x; ++x) {
      const Comparison c = compare(work, 0, x, y);
      ncc.at(x + reach_x, y + reach_y) = static_cast<float>(c.cover >= kRepeatCover ? c.ncc : 0);
    }
  std::optional<Repeat> best;
  for (int y = 0; y <= reach_y; ++y)  // the other half is the same
    for (int x = -reach_x + 1; x < reach_x; ++x) {
      const double here = static_cast<double>(ncc.at(x + reach_x, y + reach_y));
      if (here < kRepeats || (best && here <= best->likeness) || (y == 0 && x <= 0)) continue;
      bool peak = true;
      for (int j = -1; j <= 1; ++j)
        for (int i = -1; i <= 1; ++i)
          if (y + j <= reach_y && y + j >= -reach_y)
            peak = peak && here >= static_cast<double>(ncc.at(x + i + reach_x, y + j + reach_y));
      double lowest = 1;
      const int steps = std::max(std::abs(x), y);
      for (int k = 0; k <= steps; ++k)
        lowest = std::min(lowest, static_cast<double>(ncc.at(reach_x + x * k / steps, reach_y + y * k / steps)));
      if (peak && lowest < here - kRepeatDip)
        best = Repeat{static_cast<double>(x * work.px_per_pixel), static_cast<double>(y * work.px_per_pixel), here};
    }
  return best;
}

/// The best likeness near the centre: climbs in steps of one and then half a pixel.
double best_likeness(const Work& work, double angle_deg) {
  double best = likeness(work, angle_deg, 0, 0), best_x = 0, best_y = 0;
  for (double step = 1; step >= 0.5; step /= 2)
    for (int round = 0; round < 8 && best > kHopeless; ++round) {
      const double from_x = best_x, from_y = best_y;
      for (const auto& [mx, my] : {std::pair{1, 0}, {-1, 0}, {0, 1}, {0, -1}}) {
        const double there = likeness(work, angle_deg, from_x + mx * step, from_y + my * step);
        if (there > best) {
          best = there;
          best_x = from_x + mx * step;
          best_y = from_y + my * step;
        }
      }
      if (best_x == from_x && best_y == from_y) break;
    }
  return best;
}

double distance_deg(double a, double b) { return std::abs(std::remainder(a - b, 360.0)); }

double highest_near(const std::vector<TurnedLikeness>& curve, double angle_deg, double within_deg) {
  double best = 0;
  for (const auto& [angle, value] : curve)
    if (distance_deg(angle, angle_deg) <= within_deg) best = std::max(best, value);
  return best;
}

bool is_peak(const std::vector<TurnedLikeness>& curve, std::size_t i) {
  return curve[i].likeness >= highest_near(curve, curve[i].angle_deg, kNearDeg / 2);
}

/// Two equal points beside each other are one peak between them.
void add_peak(std::vector<double>& peaks, double angle_deg) {
  if (!peaks.empty() && angle_deg - peaks.back() < kNearDeg / 2)
    peaks.back() = (peaks.back() + angle_deg) / 2;
  else
    peaks.push_back(angle_deg);
}

}  // namespace

std::vector<TurnedLikeness> turned_likeness(image::ImageView picture, image::ImageView mask) {
  const Work work = make_work(picture, mask);
  std::vector<TurnedLikeness> curve;
  if (work.picture.width() < 2 || work.picture.height() < 2 || work.area < 9) return curve;
  for (double angle = kStepDeg; angle <= 180; angle += kStepDeg) curve.push_back({angle, best_likeness(work, angle)});
  for (std::size_t i = curve.size() - 1; i-- > 0;)  // turning by -a compares the same two pictures
    curve.push_back({360 - curve[i].angle_deg, curve[i].likeness});
  return curve;
}

SelfMatch self_match(image::ImageView picture, image::ImageView mask) {
  const auto curve = turned_likeness(picture, mask);
  SelfMatch found;
  if (curve.empty()) return found;
  found.repeat = repeat_of(make_work(picture, mask));
  if (found.repeat) found.second_best = found.repeat->likeness;
  const Symmetry symmetry = find_symmetry(picture, mask);
  found.symmetry_order = symmetry.order;
  const bool nearly = symmetry.nearly > symmetry.order && symmetry.nearly % symmetry.order == 0;
  const bool some_nearly = nearly && symmetry.nearly != kAnyAngle;
  const bool any_nearly = nearly && !some_nearly && symmetry.order == 1 && symmetry.nearly_likeness >= kAllAlike;
  double told_deg = 360.0 / symmetry.order;
  if (symmetry.order == kAnyAngle || any_nearly) told_deg = kDiscStepDeg;
  if (some_nearly) told_deg = 360.0 / symmetry.nearly;
  for (int i = 1; i < std::lround(360 / told_deg); ++i) found.ambiguous_deg.push_back(i * told_deg);
  if (symmetry.order == kAnyAngle) return found;
  if (some_nearly || any_nearly) found.second_best = std::max(found.second_best, symmetry.nearly_likeness);
  const double near = std::min(kNearDeg, 180.0 / symmetry.order);
  std::vector<double> peaks;
  for (std::size_t i = 0; i < curve.size(); ++i) {
    const double to_symmetric = std::remainder(curve[i].angle_deg, 360.0 / symmetry.order);
    if (std::abs(to_symmetric) < near || !is_peak(curve, i)) continue;
    found.second_best = std::max(found.second_best, curve[i].likeness);
    if (curve[i].likeness >= kNearlySame) add_peak(peaks, curve[i].angle_deg);
  }
  for (const double peak : peaks)
    if (std::abs(std::remainder(peak, told_deg)) >= std::min(kNearDeg / 2, told_deg / 4) && !any_nearly)
      found.ambiguous_deg.push_back(peak);
  std::sort(found.ambiguous_deg.begin(), found.ambiguous_deg.end());
  return found;
}

}  // namespace pickcell::matches
