#include "pickcell/matches/fit/contour_kernel.hpp"

#include <algorithm>
#include <cmath>

// clang-format off
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "pickcell/matches/fit/contour_kernel.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>
#include "pickcell/matches/fit/gather-inl.hpp"
// clang-format on

HWY_BEFORE_NAMESPACE();
namespace pickcell::matches::HWY_NAMESPACE {

constexpr int kMostSamples = 41;
constexpr float kLeastSlope = 5.f;  // grey values, see slope()

/// Grey values along the normals of one block of points, `half` samples to each side.
struct Profiles {
  VF grey[kMostSamples];
  int count;

  /// at: less half a pixel each way; all places must lie inside the picture.
  HWY_INLINE void read(image::ImageView picture, const Place& at, const Place& normal, int half, bool smooth) {
    const DF d;
    count = 2 * half + 1;
    for (int i = 0; i < count; ++i) {
      const VF t = hn::Set(d, static_cast<float>(i - half) * kNormalStep_px);
      const Place p{hn::MulAdd(normal.x, t, at.x), hn::MulAdd(normal.y, t, at.y)};
      grey[i] = sample_inside(picture, p);
      if (!smooth) continue;
      const VF a = sample_inside(picture, {hn::Sub(p.x, normal.y), hn::Add(p.y, normal.x)});
      const VF b = sample_inside(picture, {hn::Add(p.x, normal.y), hn::Sub(p.y, normal.x)});
      grey[i] = hn::MulAdd(hn::Set(d, 0.25f), hn::Add(a, b), hn::Mul(hn::Set(d, 0.5f), grey[i]));
    }
  }

  /// |derivative| from kArm samples to each side; about two grey values for one per pixel.
  template <int kArm>
  HWY_INLINE VF slope(int i) const {
    const DF d;
    const auto step = [&](int k) HWY_ATTR { return hn::Sub(grey[i + k], grey[i - k]); };
    if constexpr (kArm == 2) return hn::Abs(hn::MulAdd(hn::Set(d, 0.5f), step(2), step(1)));
    // k exp(-(k step / 0.75 px)^2 / 2), as large as the other for a ramp.
    VF v = hn::Mul(hn::Set(d, 0.796f), step(1));
    v = hn::MulAdd(hn::Set(d, 0.818f), step(2), v);
    v = hn::MulAdd(hn::Set(d, 0.404f), step(3), v);
    return hn::Abs(hn::MulAdd(hn::Set(d, 0.114f), step(4), v));
  }
};

/// The steepest of the local maxima so far, lane by lane.
struct Steepest {
  VF value, t, before, here, after;

  HWY_INLINE void clear() {
    value = before = here = after = hn::Zero(DF());
    t = hn::Set(DF(), kNoEdge);
  }
  HWY_INLINE void offer(VF s0, VF s1, VF s2, float t_px, float reach_px) {
    const DF d;
    const VF worth = hn::Mul(s1, hn::Set(d, 1 - 0.5f * std::abs(t_px) / (reach_px + kNormalStep_px)));
    const auto better = hn::And(hn::And(hn::Ge(s1, s0), hn::Ge(s1, s2)), hn::Gt(worth, value));
    value = hn::IfThenElse(better, worth, value);
    t = hn::IfThenElse(better, hn::Set(d, t_px), t);
    before = hn::IfThenElse(better, s0, before);
    here = hn::IfThenElse(better, s1, here);
    after = hn::IfThenElse(better, s2, after);
  }
  /// The vertex of the parabola through the three slopes.
  HWY_INLINE VF distance(float reach_px) const {
    const DF d;
    const VF none = hn::Set(d, kNoEdge);
    const VF bend = hn::Sub(hn::Add(before, after), hn::Add(here, here));
    const VF shift =
        hn::Div(hn::Mul(hn::Set(d, 0.5f * kNormalStep_px), hn::Sub(before, after)), hn::Min(bend, hn::Set(d, -1e-6f)));
    const VF at = hn::Add(t, shift);
    const auto good = hn::And(hn::Ge(here, hn::Set(d, kLeastSlope)), hn::Le(hn::Abs(at), hn::Set(d, reach_px)));
    return hn::IfThenElse(good, at, none);
  }
};

template <int kArm>
HWY_INLINE void find_steepest(image::ImageView picture, const ContourColumns& c, const LevelMap& m, float reach_px,
                              bool smooth, float* distance) {
  const DF d;
  const int lanes = static_cast<int>(hn::Lanes(d));
  const int half = std::min(kMostSamples / 2, static_cast<int>(std::ceil(reach_px / kNormalStep_px)) + kArm + 1);
  const float scale = std::sqrt(m.a * m.a + m.b * m.b);
  const VF a = hn::Set(d, m.a), b = hn::Set(d, m.b), unit = hn::Set(d, 1 / scale);
  const float far = static_cast<float>(half + 1) * kNormalStep_px + (smooth ? 1.f : 0.f);
  if (static_cast<float>(std::min(picture.width(), picture.height()) - 1) <= 2 * far) {
    std::fill(distance, distance + (c.count + lanes - 1) / lanes * lanes, kNoEdge);
    return;
  }
  const VF lo = hn::Set(d, far);
  const VF hi_x = hn::Set(d, static_cast<float>(picture.width() - 1) - far);
  const VF hi_y = hn::Set(d, static_cast<float>(picture.height() - 1) - far);
  for (int i = 0; i < c.count; i += lanes) {
    const VF x = hn::LoadU(d, c.x + i), y = hn::LoadU(d, c.y + i);
    const VF nx = hn::LoadU(d, c.nx + i), ny = hn::LoadU(d, c.ny + i);
    const Place at{hn::MulAdd(a, x, hn::MulAdd(b, y, hn::Set(d, m.x))),
                   hn::MulAdd(a, y, hn::NegMulAdd(b, x, hn::Set(d, m.y)))};
    const Place normal{hn::Mul(unit, hn::MulAdd(a, nx, hn::Mul(b, ny))),
                       hn::Mul(unit, hn::NegMulAdd(b, nx, hn::Mul(a, ny)))};
    const VF half_px = hn::Set(d, 0.5f);
    const Place read_at{hn::Sub(hn::Min(hn::Max(at.x, lo), hi_x), half_px),
                        hn::Sub(hn::Min(hn::Max(at.y, lo), hi_y), half_px)};
    Profiles profiles;
    profiles.read(picture, read_at, normal, half, smooth);
    Steepest best;
    best.clear();
    VF s0 = profiles.slope<kArm>(kArm), s1 = profiles.slope<kArm>(kArm + 1);
    for (int k = kArm + 1; k + kArm + 1 < profiles.count; ++k) {
      const VF s2 = profiles.slope<kArm>(k + 1);
      best.offer(s0, s1, s2, static_cast<float>(k - half) * kNormalStep_px, reach_px);
      s0 = s1;
      s1 = s2;
    }
    const auto in_x = hn::And(hn::Ge(at.x, lo), hn::Le(at.x, hi_x));
    const auto in_y = hn::And(hn::Ge(at.y, lo), hn::Le(at.y, hi_y));
    hn::StoreU(hn::IfThenElse(hn::And(in_x, in_y), best.distance(reach_px), hn::Set(d, kNoEdge)), d, distance + i);
  }
}

void find_edges_impl(image::ImageView picture, const ContourColumns& c, const LevelMap& m, float reach_px,
                     EdgeReading reading, float* distance) {
  if (reading == EdgeReading::exact)
    find_steepest<4>(picture, c, m, reach_px, false, distance);
  else
    find_steepest<2>(picture, c, m, reach_px, reading == EdgeReading::smooth, distance);
}

int make_lines_impl(const ContourColumns& c, const LevelMap& m, const LineOutput& out) {
  const DF d;
  const int lanes = static_cast<int>(hn::Lanes(d));
  const VF a = hn::Set(d, m.a), b = hn::Set(d, m.b), unit = hn::Set(d, 1 / std::sqrt(m.a * m.a + m.b * m.b));
  const VF one = hn::Set(d, 1.f), n = hn::Set(d, static_cast<float>(c.count)), none = hn::Set(d, kNoEdge);
  VF found = hn::Zero(d);
  for (int i = 0; i < c.count; i += lanes) {
    const VF x = hn::LoadU(d, c.x + i), y = hn::LoadU(d, c.y + i);
    const VF px = hn::LoadU(d, c.nx + i), py = hn::LoadU(d, c.ny + i);
    const VF nx = hn::Mul(unit, hn::MulAdd(a, px, hn::Mul(b, py)));
    const VF ny = hn::Mul(unit, hn::NegMulAdd(b, px, hn::Mul(a, py)));
    const VF rx = hn::MulAdd(a, x, hn::Mul(b, y));
    const VF ry = hn::NegMulAdd(b, x, hn::Mul(a, y));
    const VF distance = hn::LoadU(d, out.distance + i);
    const auto seen = hn::And(hn::Lt(distance, none), hn::Lt(hn::Iota(d, static_cast<float>(i)), n));
    const VF weight = hn::IfThenElseZero(seen, one);
    found = hn::Add(found, weight);
    hn::StoreU(nx, d, out.nx + i);
    hn::StoreU(ny, d, out.ny + i);
    hn::StoreU(hn::MulSub(nx, ry, hn::Mul(ny, rx)), d, out.turn + i);
    hn::StoreU(hn::MulAdd(nx, rx, hn::Mul(ny, ry)), d, out.growth + i);
    hn::StoreU(hn::IfThenElseZero(seen, distance), d, out.distance + i);
    hn::StoreU(weight, d, out.found + i);
  }
  return static_cast<int>(hn::GetLane(hn::SumOfLanes(d, found)));
}

void sum_lines_impl(const LineColumns& c, float* sums) {
  const DF d;
  const int lanes = static_cast<int>(hn::Lanes(d));
  VF product[10], right[4];
#pragma GCC unroll 10
  for (VF& v : product) v = hn::Zero(d);
#pragma GCC unroll 4
  for (VF& v : right) v = hn::Zero(d);
  for (int i = 0; i < c.count; i += lanes) {
    const VF row[4] = {hn::LoadU(d, c.nx + i), hn::LoadU(d, c.ny + i), hn::LoadU(d, c.turn + i),
                       hn::LoadU(d, c.growth + i)};
    const VF w = hn::LoadU(d, c.weight + i);
    const VF distance = hn::LoadU(d, c.distance + i);
    int k = 0;
#pragma GCC unroll 4
    for (int p = 0; p < 4; ++p) {
      const VF wp = hn::Mul(w, row[p]);
      right[p] = hn::MulAdd(wp, distance, right[p]);
#pragma GCC unroll 4
      for (int q = p; q < 4; ++q, ++k) product[k] = hn::MulAdd(wp, row[q], product[k]);
    }
  }
#pragma GCC unroll 10
  for (int k = 0; k < 10; ++k) sums[k] = hn::GetLane(hn::SumOfLanes(d, product[k]));
#pragma GCC unroll 4
  for (int k = 0; k < 4; ++k) sums[10 + k] = hn::GetLane(hn::SumOfLanes(d, right[k]));
}

void line_residuals_impl(const LineColumns& c, const float* movement, float* residual) {
  const DF d;
  const int lanes = static_cast<int>(hn::Lanes(d));
  const float* const columns[4] = {c.nx, c.ny, c.turn, c.growth};
  for (int i = 0; i < c.count; i += lanes) {
    VF r = hn::LoadU(d, c.distance + i);
#pragma GCC unroll 4
    for (int k = 0; k < 4; ++k) r = hn::NegMulAdd(hn::LoadU(d, columns[k] + i), hn::Set(d, movement[k]), r);
    hn::StoreU(hn::Abs(r), d, residual + i);
  }
}

void weigh_lines_impl(const float* residual, const float* found, float cut, int count, float* weight) {
  const DF d;
  const VF per_cut = hn::Set(d, 1 / cut), one = hn::Set(d, 1.f);
  for (int i = 0; i < count; i += static_cast<int>(hn::Lanes(d))) {
    const VF r = hn::Mul(hn::LoadU(d, residual + i), per_cut);
    const VF u = hn::Max(hn::Zero(d), hn::NegMulAdd(r, r, one));
    hn::StoreU(hn::Mul(hn::LoadU(d, found + i), hn::Mul(u, u)), d, weight + i);
  }
}

}  // namespace pickcell::matches::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace pickcell::matches {

HWY_EXPORT(find_edges_impl);
HWY_EXPORT(make_lines_impl);
HWY_EXPORT(sum_lines_impl);
HWY_EXPORT(line_residuals_impl);
HWY_EXPORT(weigh_lines_impl);

void find_edges(image::ImageView picture, const ContourColumns& points, const LevelMap& map, float reach_px,
                EdgeReading reading, float* distance) {
  HWY_DYNAMIC_DISPATCH(find_edges_impl)(picture, points, map, reach_px, reading, distance);
}

int make_lines(const ContourColumns& points, const LevelMap& map, const LineOutput& out) {
  return HWY_DYNAMIC_DISPATCH(make_lines_impl)(points, map, out);
}

void sum_lines(const LineColumns& lines, float (&sums)[14]) { HWY_DYNAMIC_DISPATCH(sum_lines_impl)(lines, sums); }

void line_residuals(const LineColumns& lines, const float (&movement)[4], float* residual) {
  HWY_DYNAMIC_DISPATCH(line_residuals_impl)(lines, movement, residual);
}

void weigh_lines(const float* residual, const float* found, float cut, int count, float* weight) {
  HWY_DYNAMIC_DISPATCH(weigh_lines_impl)(residual, found, cut, count, weight);
}

}  // namespace pickcell::matches
#endif
