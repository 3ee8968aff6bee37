#include "pickcell/matches/limits.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace pickcell::matches {

namespace {

constexpr double kMaxAngleDeg = 720;

constexpr double kRounding = 1e-9;

double angle_tolerance_deg(Range r) { return r.lo == r.hi ? kFixedAngleTolerance_deg : kAngleTolerance_deg; }
double scale_tolerance(Range r) { return r.lo == r.hi ? kFixedScaleTolerance : kScaleTolerance; }

std::string words(Range r) {
  char text[80];
  std::snprintf(text, sizeof(text), "%g,%g", r.lo, r.hi);
  return text;
}

tl::unexpected<core::Error> refuse(const std::string& what, Range range, const char* why, const char* remedy) {
  return core::failure(core::ErrorCode::usage, what, "range " + words(range) + " " + why, remedy);
}

core::Status check_order(const std::string& what, Range range) {
  if (!std::isfinite(range.lo) || !std::isfinite(range.hi))
    return refuse(what, range, "is not finite", "write plain numbers");
  if (range.lo > range.hi) return refuse(what, range, "is reversed", "write the smaller number first");
  return {};
}

}  // namespace

core::Status check_angle_range(const std::string& what, Range deg) {
  if (auto order = check_order(what, deg); !order) return order;
  if (deg.hi - deg.lo > 360) return refuse(what, deg, "is wider than a full turn", "use -180,180 for all angles");
  if (std::abs(deg.lo) > kMaxAngleDeg || std::abs(deg.hi) > kMaxAngleDeg)
    return refuse(what, deg, "is not a range of degrees", "use angles within -180 and 360");
  return {};
}

core::Status check_scale_range(const std::string& what, Range scale) {
  if (auto order = check_order(what, scale); !order) return order;
  if (scale.lo < kMinScale || scale.hi > kMaxScale)
    return refuse(what, scale, "is outside 0.1 to 10", "1 is the taught size; 0.9,1.1 allows 10 percent");
  return {};
}

bool angle_answers(double angle_deg, Range range) {
  return angle_in_range(angle_deg, range, angle_tolerance_deg(range) + kRounding);
}

bool scale_answers(double scale, Range range) {
  const double s = scale_tolerance(range) + kRounding;
  return scale >= range.lo * (1 - s) && scale <= range.hi * (1 + s);
}

double nearest_angle(double angle_deg, Range range) {
  if (angle_answers(angle_deg, range)) return angle_deg;
  const double slack_deg = angle_tolerance_deg(range);
  const auto off = [&](double end_deg) { return std::abs(std::remainder(angle_deg - end_deg, 360.0)); };
  if (range.lo == range.hi) return range.lo + std::copysign(slack_deg, std::remainder(angle_deg - range.lo, 360.0));
  return off(range.lo) < off(range.hi) ? range.lo - slack_deg : range.hi + slack_deg;
}

double nearest_scale(double scale, Range range) {
  const double s = scale_tolerance(range);
  return scale_answers(scale, range) ? scale : std::clamp(scale, range.lo * (1 - s), range.hi * (1 + s));
}

bool may_answer(double angle_deg, Range angles_deg, double scale, Range scales) {
  return angle_answers(angle_deg, angles_deg) && std::abs(scale / nearest_scale(scale, scales) - 1) <= kMostGrowthHeld;
}

bool angle_in_range(double angle_deg, Range range, double slack_deg) {
  const double width = range.hi - range.lo + 2 * slack_deg;
  if (width >= 360) return true;
  double above = std::fmod(angle_deg - range.lo + slack_deg, 360.0);
  if (above < 0) above += 360;
  return above <= width;
}

}  // namespace pickcell::matches
