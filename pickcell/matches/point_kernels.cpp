#include "pickcell/matches/point_kernels.hpp"

// clang-format off
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "pickcell/matches/point_kernels.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>
#include "pickcell/matches/gather-inl.hpp"
// clang-format on

HWY_BEFORE_NAMESPACE();
namespace pickcell::matches::HWY_NAMESPACE {

HWY_INLINE Place place_of(const float* qx, const float* qy, const LevelMap& m) {
  const DF d;
  const VF a = hn::Set(d, m.a), b = hn::Set(d, m.b);
  const VF x = hn::LoadU(d, qx), y = hn::LoadU(d, qy);
  return {hn::MulAdd(a, x, hn::MulAdd(b, y, hn::Set(d, m.x))), hn::MulAdd(a, y, hn::NegMulAdd(b, x, hn::Set(d, m.y)))};
}

/// 1 for the first `count` lanes, else 0.
HWY_INLINE VF first_lanes(int count) {
  const DF d;
  return hn::IfThenElseZero(hn::Lt(hn::Iota(d, 0.f), hn::Set(d, static_cast<float>(count))), hn::Set(d, 1.f));
}

HWY_INLINE VF ones_inside(const Place& p, int width, int height) {
  const DF d;
  const VF zero = hn::Zero(d);
  const auto x = hn::And(hn::Ge(p.x, zero), hn::Le(p.x, hn::Set(d, static_cast<float>(width - 1))));
  const auto y = hn::And(hn::Ge(p.y, zero), hn::Le(p.y, hn::Set(d, static_cast<float>(height - 1))));
  return hn::IfThenElseZero(hn::And(x, y), hn::Set(d, 1.f));
}

HWY_INLINE double total(VF v) { return static_cast<double>(hn::GetLane(hn::SumOfLanes(DF(), v))); }

void sum_points_impl(image::ImageView picture, const PointColumns& points, const LevelMap& map, PointSums& out) {
  const DF d;
  const int lanes = static_cast<int>(hn::Lanes(d));
  const VF mid = hn::Set(d, 128.f);
  VF s = hn::Zero(d), ss = s, st = s, j0 = s, j1 = s, j2 = s, j3 = s;
  for (int i = 0; i < points.count; i += lanes) {
    VF v = hn::Sub(sample(picture, place_of(points.qx + i, points.qy + i, map)), mid);
    if (i + lanes > points.count) v = hn::Mul(v, first_lanes(points.count - i));
    s = hn::Add(s, v);
    ss = hn::MulAdd(v, v, ss);
    st = hn::MulAdd(v, hn::LoadU(d, points.t + i), st);
    j0 = hn::MulAdd(v, hn::LoadU(d, points.j[0] + i), j0);
    j1 = hn::MulAdd(v, hn::LoadU(d, points.j[1] + i), j1);
    j2 = hn::MulAdd(v, hn::LoadU(d, points.j[2] + i), j2);
    j3 = hn::MulAdd(v, hn::LoadU(d, points.j[3] + i), j3);
  }
  out = {total(s), total(ss), total(st), {total(j0), total(j1), total(j2), total(j3)}};
}

void sample_points_impl(image::ImageView picture, const PointColumns& points, const LevelMap& map, float* s,
                        float* weight) {
  const DF d;
  const int lanes = static_cast<int>(hn::Lanes(d));
  for (int i = 0; i < points.count; i += lanes) {
    const Place p = place_of(points.qx + i, points.qy + i, map);
    hn::StoreU(sample(picture, p), d, s + i);
    hn::StoreU(ones_inside(p, picture.width(), picture.height()), d, weight + i);
  }
}

/// One row of the normal matrix from column a on, and its right side; a row at a time, and loops unrolled, keep the
/// sums in registers.
template <int a>
HWY_INLINE float* sum_row(const PointColumns& points, const float* s, const float* weight, float* products,
                          float* right) {
  const DF d;
  const int lanes = static_cast<int>(hn::Lanes(d));
  const float* const columns[6] = {nullptr, points.t, points.j[0], points.j[1], points.j[2], points.j[3]};
  const VF mid = hn::Set(d, 128.f);
  VF sum[6];
#pragma GCC unroll 6
  for (int b = a; b < 6; ++b) sum[b] = hn::Zero(d);
  VF scene = hn::Zero(d);
  for (int i = 0; i < points.count; i += lanes) {
    VF wa = hn::LoadU(d, weight + i);
    if constexpr (a > 0) wa = hn::Mul(wa, hn::LoadU(d, columns[a] + i));
    scene = hn::MulAdd(wa, hn::Sub(hn::LoadU(d, s + i), mid), scene);
#pragma GCC unroll 6
    for (int b = a; b < 6; ++b)
      sum[b] = b == 0 ? hn::Add(sum[0], wa) : hn::MulAdd(wa, hn::LoadU(d, columns[b] + i), sum[b]);
  }
#pragma GCC unroll 6
  for (int b = a; b < 6; ++b) *products++ = hn::GetLane(hn::SumOfLanes(d, sum[b]));
  *right = hn::GetLane(hn::SumOfLanes(d, scene));
  return products;
}

void sum_weighted_impl(const PointColumns& points, const float* s, const float* weight, float* sums) {
  float* const right = sums + 21;
  sums = sum_row<0>(points, s, weight, sums, right);
  sums = sum_row<1>(points, s, weight, sums, right + 1);
  sums = sum_row<2>(points, s, weight, sums, right + 2);
  sums = sum_row<3>(points, s, weight, sums, right + 3);
  sums = sum_row<4>(points, s, weight, sums, right + 4);
  sum_row<5>(points, s, weight, sums, right + 5);
}

void residual_sizes_impl(const PointColumns& points, const float* s, float offset, float gain, float* size) {
  const DF d;
  const VF from = hn::Set(d, offset), k = hn::Set(d, gain);
  for (int i = 0; i < points.count; i += static_cast<int>(hn::Lanes(d)))
    hn::StoreU(hn::Abs(hn::NegMulAdd(k, hn::LoadU(d, points.t + i), hn::Sub(hn::LoadU(d, s + i), from))), d, size + i);
}

void weigh_points_impl(const float* size, float cut, float trace, int count, float* weight) {
  const DF d;
  const VF per_cut = hn::Set(d, 1 / cut), one = hn::Set(d, 1.f), least = hn::Set(d, trace);
  for (int i = 0; i < count; i += static_cast<int>(hn::Lanes(d))) {
    const VF r = hn::Mul(hn::LoadU(d, size + i), per_cut);
    const VF u = hn::Max(hn::Zero(d), hn::NegMulAdd(r, r, one));
    const auto in = hn::Gt(hn::LoadU(d, weight + i), hn::Zero(d));
    hn::StoreU(hn::IfThenElseZero(in, hn::Max(least, hn::Mul(u, u))), d, weight + i);
  }
}

float sum_edges_impl(image::View<std::int8_t> field, const EdgeColumns& e, const LevelMap& m) {
  const DF d;
  const DI di;
  const int lanes = static_cast<int>(hn::Lanes(d));
  const int width = field.width() / 2;
  const int height = field.height();
  const float scale2 = m.a * m.a + m.b * m.b;
  // exp(-2ia), see orientation_field.hpp.
  const VF ca = hn::Set(d, (m.a * m.a - m.b * m.b) / scale2);
  const VF sa = hn::Set(d, 2 * m.a * m.b / scale2);
  VF sum = hn::Zero(d);
  for (int i = 0; i < e.count; i += lanes) {
    const Place p = place_of(e.x + i, e.y + i, m);
    const Corner c = corner_of(p, width, height);
    const VI offset =
        hn::Add(hn::Mul(c.y, hn::Set(di, static_cast<std::int32_t>(field.stride()))), hn::ShiftLeft<1>(c.x));
    const VI up = four_bytes(field.row(0), offset);  // c2, s2 of a pixel and of its right neighbour
    const VI down = four_bytes(field.row(1), offset);
    const auto part = [&](auto left) HWY_ATTR {
      constexpr int kLeft = decltype(left)::value;  // brings the byte to the top, its neighbour two bytes on
      const auto at = [&](VI v) HWY_ATTR { return hn::ConvertTo(d, hn::ShiftRight<24>(hn::ShiftLeft<kLeft>(v))); };
      const auto next = [&](VI v)
                            HWY_ATTR { return hn::ConvertTo(d, hn::ShiftRight<24>(hn::ShiftLeft<kLeft - 16>(v))); };
      return blend(blend(at(up), next(up), c.fx), blend(at(down), next(down), c.fx), c.fy);
    };
    const VF c2 = part(std::integral_constant<int, 24>());
    const VF s2 = part(std::integral_constant<int, 16>());
    const VF tc = hn::LoadU(d, e.c2 + i);
    const VF ts = hn::LoadU(d, e.s2 + i);
    const VF dot =
        hn::MulAdd(c2, hn::MulAdd(tc, ca, hn::Mul(ts, sa)), hn::Mul(s2, hn::NegMulAdd(tc, sa, hn::Mul(ts, ca))));
    sum = hn::MulAdd(dot, ones_inside(p, width, height), sum);
  }
  return hn::GetLane(hn::SumOfLanes(d, sum));
}

}  // namespace pickcell::matches::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace pickcell::matches {

HWY_EXPORT(sum_points_impl);
HWY_EXPORT(sample_points_impl);
HWY_EXPORT(sum_weighted_impl);
HWY_EXPORT(residual_sizes_impl);
HWY_EXPORT(weigh_points_impl);
HWY_EXPORT(sum_edges_impl);

PointSums sum_points(image::ImageView picture, const PointColumns& points, const LevelMap& map) {
  PointSums out;
  HWY_DYNAMIC_DISPATCH(sum_points_impl)(picture, points, map, out);
  return out;
}

void sample_points(image::ImageView picture, const PointColumns& points, const LevelMap& map, float* s, float* weight) {
  HWY_DYNAMIC_DISPATCH(sample_points_impl)(picture, points, map, s, weight);
}

void sum_weighted(const PointColumns& points, const float* s, const float* weight, float* sums) {
  HWY_DYNAMIC_DISPATCH(sum_weighted_impl)(points, s, weight, sums);
}

void residual_sizes(const PointColumns& points, const float* s, float offset, float gain, float* size) {
  HWY_DYNAMIC_DISPATCH(residual_sizes_impl)(points, s, offset, gain, size);
}

void weigh_points(const float* size, float cut, float trace, int count, float* weight) {
  HWY_DYNAMIC_DISPATCH(weigh_points_impl)(size, cut, trace, count, weight);
}

float sum_edges(image::View<std::int8_t> field, const EdgeColumns& points, const LevelMap& map) {
  return HWY_DYNAMIC_DISPATCH(sum_edges_impl)(field, points, map);
}

}  // namespace pickcell::matches
#endif
