#include "pickcell/matches/fit/score_kernels.hpp"

// clang-format off
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "pickcell/matches/fit/score_kernels.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>
#include "pickcell/matches/fit/gather-inl.hpp"
// clang-format on

HWY_BEFORE_NAMESPACE();
namespace pickcell::matches::HWY_NAMESPACE {

HWY_INLINE float total(VF v) { return hn::GetLane(hn::SumOfLanes(DF(), v)); }

/// 1 in the first `count` lanes, else 0.
HWY_INLINE VF leading(int count) {
  const DF d;
  return hn::IfThenElseZero(hn::Lt(hn::Iota(d, 0.f), hn::Set(d, static_cast<float>(count))), hn::Set(d, 1.f));
}

void sum_block_moments_impl(const PointColumns& points, const float* scene, const float* weight, const int* begin,
                            BlockMoments* out) {
  const DF d;
  const int lanes = static_cast<int>(hn::Lanes(d));
  const VF mid = hn::Set(d, 128.f);
  for (std::size_t block = 0; block < kBlocks; ++block) {
    VF n = hn::Zero(d), s = n, ss = n, t = n, tt = n, st = n;
    for (int i = begin[block]; i < begin[block + 1]; i += lanes) {
      const VF w = hn::Mul(hn::LoadU(d, weight + i), leading(begin[block + 1] - i));
      const VF a = hn::Sub(hn::LoadU(d, scene + i), mid), b = hn::LoadU(d, points.t + i);
      const VF wa = hn::Mul(w, a), wb = hn::Mul(w, b);
      n = hn::Add(n, w);
      s = hn::Add(s, wa);
      ss = hn::MulAdd(wa, a, ss);
      t = hn::Add(t, wb);
      tt = hn::MulAdd(wb, b, tt);
      st = hn::MulAdd(wa, b, st);
    }
    out[block] = {total(n), total(s), total(ss), total(t), total(tt), total(st)};
  }
}

void sum_block_edges_impl(image::View<std::int8_t> field, const EdgeColumns& e, const LevelMap& m, const int* begin,
                          BlockEdges* out) {
  const DF d;
  const DI di;
  const int lanes = static_cast<int>(hn::Lanes(d));
  const VF a = hn::Set(d, m.a), b = hn::Set(d, m.b);
  const float norm = 1 / (m.a * m.a + m.b * m.b);
  const VF c = hn::Set(d, (m.a * m.a - m.b * m.b) * norm), s = hn::Set(d, 2 * m.a * m.b * norm);  // of twice the angle
  const VI before = hn::Set(di, -1), width = hn::Set(di, field.width() / 2), height = hn::Set(di, field.height());
  const VI stride = hn::Set(di, static_cast<std::int32_t>(field.stride()));
  for (std::size_t block = 0; block < kBlocks; ++block) {
    VF both = hn::Zero(d), scene = both, own = both;
    for (int i = begin[block]; i < begin[block + 1]; i += lanes) {
      const VF in_block = hn::Mul(leading(begin[block + 1] - i), hn::Set(d, 1 / 127.f));
      const VF qx = hn::LoadU(d, e.x + i), qy = hn::LoadU(d, e.y + i);
      const VI x = hn::NearestInt(hn::MulAdd(a, qx, hn::MulAdd(b, qy, hn::Set(d, m.x))));
      const VI y = hn::NearestInt(hn::MulAdd(a, qy, hn::NegMulAdd(b, qx, hn::Set(d, m.y))));
      const auto inside =
          hn::And(hn::And(hn::Gt(x, before), hn::Lt(x, width)), hn::And(hn::Gt(y, before), hn::Lt(y, height)));
      const VI place = hn::IfThenElseZero(inside, hn::Add(hn::Mul(y, stride), hn::Add(x, x)));
      const VI bytes = hn::IfThenElseZero(inside, four_bytes(field.row(0), place));
      const VF fc = hn::Mul(in_block, hn::ConvertTo(d, hn::ShiftRight<24>(hn::ShiftLeft<24>(bytes))));
      const VF fs = hn::Mul(in_block, hn::ConvertTo(d, hn::ShiftRight<24>(hn::ShiftLeft<16>(bytes))));
      const VF first = leading(begin[block + 1] - i);
      const VF tc = hn::Mul(first, hn::LoadU(d, e.c2 + i)), ts = hn::Mul(first, hn::LoadU(d, e.s2 + i));
      own = hn::MulAdd(tc, tc, hn::MulAdd(ts, ts, own));
      scene = hn::MulAdd(fc, fc, hn::MulAdd(fs, fs, scene));
      both = hn::MulAdd(fc, hn::MulAdd(tc, c, hn::Mul(ts, s)), both);
      both = hn::MulAdd(fs, hn::NegMulAdd(tc, s, hn::Mul(ts, c)), both);
    }
    out[block] = {total(both), total(scene), total(own)};
  }
}

}  // namespace pickcell::matches::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace pickcell::matches {

HWY_EXPORT(sum_block_moments_impl);
HWY_EXPORT(sum_block_edges_impl);

void sum_block_moments(const PointColumns& points, const float* s, const float* weight, const BlockBegins& begin,
                       std::array<BlockMoments, kBlocks>& out) {
  HWY_DYNAMIC_DISPATCH(sum_block_moments_impl)(points, s, weight, begin.data(), out.data());
}

void sum_block_edges(image::View<std::int8_t> field, const EdgeColumns& points, const LevelMap& map,
                     const BlockBegins& begin, std::array<BlockEdges, kBlocks>& out) {
  HWY_DYNAMIC_DISPATCH(sum_block_edges_impl)(field, points, map, begin.data(), out.data());
}

}  // namespace pickcell::matches
#endif
