#include "pickcell/matches/fit/final_fit.hpp"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "pickcell/matches/fit/fit_quality.hpp"

namespace pickcell::matches {
namespace {

constexpr int kGreyPoints = 4096;
constexpr int kFewGreyPoints = 1024;
constexpr int kRimPoints = 400;
constexpr int kRim_px = 3;      // pixels, lens and interpolation mix part and ground so far from the outline
constexpr int kOutside_px = 3;  // a mask may be so much too small ...
constexpr int kExcess_px = 3;   // ... or too large, which its contours tell
constexpr int kFewestGreyPoints = 40;
constexpr int kRounds = 4;
constexpr double kArrived_px = 0.15;  // of the rim: a step of that length ends within a few hundredths of it
constexpr double kFurthest_px = 3;
constexpr double kTaughtToo = 1.5;  // of the contours' variance: the taught ones are as uncertain, in part
// What all contours may be off together, so that their scatter does not tell: rounding alone; and where grey values
// tell the place as well, what blur and shading do to contours that are no plain steps.
constexpr double kTogether_px = 0.003;
constexpr double kTogetherWithGrey_px = 0.03;
constexpr double kMeanRadius = 0.6;  // of the furthest point's

std::optional<Evidence> grey_evidence(image::ImageView picture, const FinalPoints& points, const Similarity& place,
                                      WeightedSamples& samples) {
  if (points.inside.size() == 0) return {};
  const FitQuality q = judge_fit(picture, points.inside, points.few, at_level(place, 0), samples);
  const Eigen::Matrix4d K = scene_from_template(place);
  const Eigen::FullPivLU<Eigen::Matrix4d> lu(K * q.covariance * K.transpose());
  if (!lu.isInvertible()) return {};
  Evidence e;
  e.movement = K * Eigen::Vector4d(q.step.dx, q.step.dy, q.step.turn_rad, q.step.growth);
  e.information = lu.inverse();
  return e;
}

/// What contours say, if all of them may be off together by so much.
Evidence less_sure(const Evidence& e, double together_px, double radius_px) {
  const double v = together_px * together_px, at_rim = v / (kMeanRadius * kMeanRadius * radius_px * radius_px);
  const Eigen::Vector4d off(v, v, at_rim, at_rim);
  const Eigen::Matrix4d I = e.information / kTaughtToo;
  // (I^-1 + diag(off))^-1, also where I leaves something open.
  return {e.movement, I * (Eigen::Matrix4d::Identity() + off.asDiagonal() * I).inverse()};
}

/// Both together: where to, and how certain that is. None where something stays open.
std::optional<Evidence> joined(const std::optional<Evidence>& a, const std::optional<Evidence>& b) {
  Evidence sum;
  for (const auto* e : {&a, &b})
    if (*e) {
      sum.information += (*e)->information;
      sum.movement += (*e)->information * (*e)->movement;
    }
  const Eigen::FullPivLU<Eigen::Matrix4d> lu(sum.information);
  if (!lu.isInvertible()) return {};
  sum.movement = Eigen::Vector4d(lu.solve(sum.movement));
  const bool sound = sum.movement.allFinite() && (lu.inverse().diagonal().array() > 0).all();
  return sound ? std::optional(sum) : std::nullopt;
}

/// How far inside the mask the part's outline lies, whole pixels: of most contours that lie near the mask's edge.
int mask_excess_px(const TemplatePyramid& t) {
  const ContourPoints seen = choose_rim_points(t, kRimPoints, kExcess_px + 1, kOutside_px, false).points;
  if (seen.count == 0) return 0;
  ByteMask mask = mask_above(t.levels.front().coverage, 0.5f);
  int inside = seen.count;
  for (int excess = 0; excess < kExcess_px; ++excess) {
    mask = erode(mask, 1);
    inside = 0;
    for (std::size_t i = 0; i < static_cast<std::size_t>(seen.count); ++i) {
      const auto x = static_cast<int>(std::lround(static_cast<double>(seen.x[i]) + t.anchor_x_px));
      const auto y = static_cast<int>(std::lround(static_cast<double>(seen.y[i]) + t.anchor_y_px));
      inside += x >= 0 && y >= 0 && x < mask.width() && y < mask.height() && mask.at(x, y);
    }
    if (2 * inside < seen.count) return excess;
  }
  return kExcess_px;
}

/// How far the furthest of the points moves from one place to another.
double rim_movement(const Similarity& from, const Similarity& to, double radius_px) {
  return std::hypot(to.x_px - from.x_px, to.y_px - from.y_px) +
         radius_px * std::hypot(wrap_rad(to.angle_rad - from.angle_rad), to.scale / from.scale - 1);
}

}  // namespace

FinalPoints choose_final_points(const TemplatePyramid& t) {
  FinalPoints p;
  if (!t.masked) return p;
  const int rim_px = kRim_px + mask_excess_px(t);
  p.inside = choose_inner_grey_points(t, 0, kGreyPoints, rim_px);
  const bool grey = p.inside.size() >= kFewestGreyPoints && p.inside.usable() && !p.inside.flat();
  if (!grey) p.inside = {};
  if (p.inside.size() >= 2 * kFewGreyPoints) p.few = choose_inner_grey_points(t, 0, kFewGreyPoints, rim_px);
  p.rim = choose_rim_points(t, kRimPoints, rim_px, kOutside_px, !grey);
  return p;
}

std::optional<FinalFit> fit_finally(image::ImageView picture, const FinalPoints& points, const Similarity& start,
                                    WeightedSamples& samples, ContourScratch& contours) {
  FinalFit fit;
  fit.place = start;
  const double radius_px = static_cast<double>(points.rim.points.radius);
  for (int round = 0; round < kRounds; ++round) {
    const auto grey = grey_evidence(picture, points, fit.place, samples);
    auto rim = contour_evidence(picture, points.rim, fit.place, contours);
    if (rim) rim = less_sure(*rim, grey ? kTogetherWithGrey_px : kTogether_px, radius_px);
    const auto both = joined(grey, rim);
    if (!both) return {};
    const Similarity before = fit.place;
    fit.place.x_px += both->movement[0];
    fit.place.y_px += both->movement[1];
    fit.place.angle_rad = wrap_rad(fit.place.angle_rad + both->movement[2]);
    fit.place.scale *= 1 + both->movement[3];
    fit.covariance = both->information.inverse();
    if (rim_movement(start, fit.place, radius_px) > kFurthest_px) return {};
    if (rim_movement(before, fit.place, radius_px) < kArrived_px) break;
  }
  return fit;
}

}  // namespace pickcell::matches
