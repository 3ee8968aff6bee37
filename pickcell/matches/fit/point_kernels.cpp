#include "pickcell/matches/fit/point_kernels.hpp"

// clang-format off
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "pickcell/matches/fit/point_kernels.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>
#include "pickcell/matches/fit/gather-inl.hpp"
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
  const LevelMap less_half{map.x - 0.5f, map.y - 0.5f, map.a, map.b};
  for (int i = 0; i < points.count; i += lanes) {
    VF v = hn::Sub(sample_inside(picture, place_of(points.qx + i, points.qy + i, less_half)), mid);
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

int sample_points_impl(image::ImageView picture, const PointColumns& points, const LevelMap& map, float* s,
                       float* weight) {
  const DF d;
  const int lanes = static_cast<int>(hn::Lanes(d));
  VF inside = hn::Zero(d);
  for (int i = 0; i < points.count; i += lanes) {
    const Place p = place_of(points.qx + i, points.qy + i, map);
    VF w = ones_inside(p, picture.width(), picture.height());
    if (i + lanes > points.count) w = hn::Mul(w, first_lanes(points.count - i));
    inside = hn::Add(inside, w);
    hn::StoreU(sample(picture, p), d, s + i);
    hn::StoreU(w, d, weight + i);
  }
  return static_cast<int>(total(inside));
}

/// Rows [from, to) of the normal matrix, and their right sides. Loops unrolled, and only some rows at once, keep the
/// sums in registers.
template <int from, int to>
HWY_INLINE void sum_rows(const PointColumns& points, const float* s, const float* weight, float* products,
                         float* right) {
  const DF d;
  const int lanes = static_cast<int>(hn::Lanes(d));
  const float* const columns[6] = {nullptr, points.t, points.j[0], points.j[1], points.j[2], points.j[3]};
  const VF mid = hn::Set(d, 128.f), one = hn::Set(d, 1.f);
  VF sum[to - from][6], scene[to - from];
#pragma GCC unroll 6
  for (int a = from; a < to; ++a) {
    scene[a - from] = hn::Zero(d);
#pragma GCC unroll 6
    for (int b = a; b < 6; ++b) sum[a - from][b] = hn::Zero(d);
  }
  for (int i = 0; i < points.count; i += lanes) {
    const VF w = hn::LoadU(d, weight + i), v = hn::Sub(hn::LoadU(d, s + i), mid);
    VF c[6];
#pragma GCC unroll 6
    for (int b = from; b < 6; ++b) c[b] = b == 0 ? one : hn::LoadU(d, columns[b] + i);
#pragma GCC unroll 6
    for (int a = from; a < to; ++a) {
      const VF wa = a == 0 ? w : hn::Mul(w, c[a]);
      scene[a - from] = hn::MulAdd(wa, v, scene[a - from]);
#pragma GCC unroll 6
      for (int b = a; b < 6; ++b)
        sum[a - from][b] = b == 0 ? hn::Add(sum[a - from][b], wa) : hn::MulAdd(wa, c[b], sum[a - from][b]);
    }
  }
#pragma GCC unroll 6
  for (int a = from; a < to; ++a) {
    right[a] = hn::GetLane(hn::SumOfLanes(d, scene[a - from]));
#pragma GCC unroll 6
    for (int b = a; b < 6; ++b) *products++ = hn::GetLane(hn::SumOfLanes(d, sum[a - from][b]));
  }
}

void sum_weighted_impl(const PointColumns& points, const float* s, const float* weight, float* sums) {
  sum_rows<0, 2>(points, s, weight, sums, sums + 21);
  sum_rows<2, 6>(points, s, weight, sums + 11, sums + 21);
}

void residual_sizes_impl(const PointColumns& points, const float* s, float offset, float gain, float* size) {
  const DF d;
  const VF from = hn::Set(d, offset), k = hn::Set(d, gain);
  for (int i = 0; i < points.count; i += static_cast<int>(hn::Lanes(d)))
    hn::StoreU(hn::Abs(hn::NegMulAdd(k, hn::LoadU(d, points.t + i), hn::Sub(hn::LoadU(d, s + i), from))), d, size + i);
}

void keep_agreeing_impl(const PointColumns& points, const float* s, float offset, float gain, float limit,
                        float* weight, Agreement& out) {
  const DF d;
  const VF from = hn::Set(d, offset), k = hn::Set(d, gain), most = hn::Set(d, limit), one = hn::Set(d, 1.f);
  VF n = hn::Zero(d), square = n;
  for (int i = 0; i < points.count; i += static_cast<int>(hn::Lanes(d))) {
    const VF r = hn::NegMulAdd(k, hn::LoadU(d, points.t + i), hn::Sub(hn::LoadU(d, s + i), from));
    const auto keep = hn::And(hn::Gt(hn::LoadU(d, weight + i), hn::Zero(d)), hn::Le(hn::Abs(r), most));
    const VF w = hn::IfThenElseZero(keep, one);
    hn::StoreU(w, d, weight + i);
    n = hn::Add(n, w);
    square = hn::MulAdd(hn::Mul(w, r), r, square);
  }
  out = {static_cast<int>(total(n)), total(square)};
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
HWY_EXPORT(keep_agreeing_impl);
HWY_EXPORT(weigh_points_impl);
HWY_EXPORT(sum_edges_impl);

PointSums sum_points(image::ImageView picture, const PointColumns& points, const LevelMap& map) {
  PointSums out;
  HWY_DYNAMIC_DISPATCH(sum_points_impl)(picture, points, map, out);
  return out;
}

int sample_points(image::ImageView picture, const PointColumns& points, const LevelMap& map, float* s, float* weight) {
  return HWY_DYNAMIC_DISPATCH(sample_points_impl)(picture, points, map, s, weight);
}

void sum_weighted(const PointColumns& points, const float* s, const float* weight, float* sums) {
  HWY_DYNAMIC_DISPATCH(sum_weighted_impl)(points, s, weight, sums);
}

void residual_sizes(const PointColumns& points, const float* s, float offset, float gain, float* size) {
  HWY_DYNAMIC_DISPATCH(residual_sizes_impl)(points, s, offset, gain, size);
}

Agreement keep_agreeing(const PointColumns& points, const float* s, float offset, float gain, float limit,
                        float* weight) {
  Agreement out;
  HWY_DYNAMIC_DISPATCH(keep_agreeing_impl)(points, s, offset, gain, limit, weight, out);
  return out;
}

void weigh_points(const float* size, float cut, float trace, int count, float* weight) {
  HWY_DYNAMIC_DISPATCH(weigh_points_impl)(size, cut, trace, count, weight);
}

float sum_edges(image::View<std::int8_t> field, const EdgeColumns& points, const LevelMap& map) {
  return HWY_DYNAMIC_DISPATCH(sum_edges_impl)(field, points, map);
}

}  // namespace pickcell::matches
#endif
