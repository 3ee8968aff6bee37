#include "pickcell/matches/rst/kernels.hpp"

#include <algorithm>
#include <cmath>

// clang-format off
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "pickcell/matches/rst/kernels.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>
// clang-format on

#ifndef PICKCELL_RST_FLAT
#define PICKCELL_RST_FLAT 0.01f  // grey values squared: less variance than this is a flat place
#endif

HWY_BEFORE_NAMESPACE();
namespace pickcell::matches::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

#if HWY_TARGET == HWY_SCALAR

void mean_lists_impl(const std::uint8_t* first, const OffsetLists& lists, int n, float* means, std::ptrdiff_t stride) {
  plain::mean_lists(first, lists, n, means, stride);
}
void score_rings_impl(const float* means, std::ptrdiff_t stride, int n, const RingQuery& query, float* best,
                      std::int32_t* scale) {
  plain::score_rings(means, stride, n, query, best, scale);
}
void sum_window_impl(image::ImageView picture, const Window& window, int x, int y, WindowSums& out) {
  out = plain::sum_window(picture, window, x, y);
}
void sum_clipped_impl(image::ImageView picture, const Window& window, int x, int y, WindowSums& out) {
  out = plain::sum_window(picture, window, x, y);
}

#else

// At most 32 lanes: the promise of kRstBlock and kWindowBlock.
using DU16 = hn::CappedTag<std::uint16_t, kRstBlock>;
using DU8 = hn::Rebind<std::uint8_t, DU16>;
using D16 = hn::RebindToSigned<DU16>;
using D32 = hn::Repartition<std::int32_t, D16>;
using DF = hn::CappedTag<float, 16>;
using DFI = hn::RebindToSigned<DF>;

/// Means of 16 positions from their sums.
template <class V>
HWY_INLINE void store_means(V sums, float inverse_length, float* out) {
  const hn::Rebind<float, hn::DFromV<V>> d;
  hn::StoreU(hn::Mul(hn::ConvertTo(d, sums), hn::Set(d, inverse_length)), d, out);
}

/// kPositions neighbours over one list: bytes summed in 16 bits, which hold 256 of them, then in 32.
template <std::size_t kPositions>
HWY_INLINE void mean_list(const std::uint8_t* first, const std::int32_t* offset, int count, float inverse_length,
                          float* out) {
  using D = hn::CappedTag<std::uint16_t, kPositions>;
  const D d;
  const hn::Rebind<std::uint8_t, D> bytes;
  const hn::Half<D> half;
  const hn::Rebind<std::int32_t, hn::Half<D>> wide;
  const std::size_t lanes = hn::Lanes(d);
  for (std::size_t at = 0; at < kPositions; at += lanes) {
    auto low = hn::Zero(wide), high = hn::Zero(wide);
    for (int from = 0; from < count; from += 256) {
      const int to = std::min(count, from + 256);
      auto even = hn::Zero(d), odd = hn::Zero(d);
      int k = from;
      for (; k + 1 < to; k += 2) {
        even = hn::Add(even, hn::PromoteTo(d, hn::LoadU(bytes, first + offset[k] + at)));
        odd = hn::Add(odd, hn::PromoteTo(d, hn::LoadU(bytes, first + offset[k + 1] + at)));
      }
      if (k < to) even = hn::Add(even, hn::PromoteTo(d, hn::LoadU(bytes, first + offset[k] + at)));
      even = hn::Add(even, odd);
      low = hn::Add(low, hn::PromoteTo(wide, hn::LowerHalf(half, even)));
      high = hn::Add(high, hn::PromoteTo(wide, hn::UpperHalf(half, even)));
    }
    store_means(low, inverse_length, out + at);
    store_means(high, inverse_length, out + at + lanes / 2);
  }
}

template <std::size_t kPositions>
HWY_INLINE void mean_block(const std::uint8_t* first, const OffsetLists& lists, float* means, std::ptrdiff_t stride) {
  for (std::size_t k = 0; k < lists.inverse_length.size(); ++k)
    mean_list<kPositions>(first, lists.offsets.data() + lists.start[k], lists.start[k + 1] - lists.start[k],
                          lists.inverse_length[k], means + static_cast<std::ptrdiff_t>(k) * stride);
}

void mean_lists_impl(const std::uint8_t* first, const OffsetLists& lists, int n, float* means, std::ptrdiff_t stride) {
  int i = 0;
  for (; i + kRstBlock / 2 < n; i += kRstBlock) mean_block<kRstBlock>(first + i, lists, means + i, stride);
  if (i < n) mean_block<kRstBlock / 2>(first + i, lists, means + i, stride);
}

void score_rings_impl(const float* means, std::ptrdiff_t stride, int n, const RingQuery& query, float* best,
                      std::int32_t* scale) {
  const DF d;
  const DFI di;
  const int lanes = static_cast<int>(hn::Lanes(d));
  for (int i = 0; i < n; i += lanes) {
    auto top = hn::Set(d, -2.f);
    auto which = hn::Zero(di);
    const auto origin = hn::LoadU(d, means + i);
    for (std::size_t s = 0; s < query.q.size(); ++s) {
      const std::vector<float>& q = query.q[s];
      auto sum = hn::Zero(d), square = hn::Zero(d), product = hn::Zero(d);
      for (std::size_t k = 0; k < q.size(); ++k) {
        const auto c = hn::Sub(hn::LoadU(d, means + static_cast<std::ptrdiff_t>(k) * stride + i), origin);
        sum = hn::Add(sum, c);
        square = hn::Add(square, hn::Mul(c, c));
        product = hn::Add(product, hn::Mul(c, hn::Set(d, q[k])));
      }
      const float count = static_cast<float>(q.size());
      const auto variance = hn::Sub(square, hn::Mul(hn::Mul(sum, sum), hn::Set(d, 1.f / count)));
      const auto flat = hn::Le(variance, hn::Set(d, PICKCELL_RST_FLAT * count));
      auto ncc = hn::Div(product, hn::Sqrt(hn::IfThenElse(flat, hn::Set(d, 1.f), variance)));
      if (query.negative) ncc = hn::Abs(ncc);
      ncc = hn::IfThenElse(flat, hn::Set(d, -2.f), ncc);
      const auto better = hn::Gt(ncc, top);
      top = hn::IfThenElse(better, ncc, top);
      which = hn::IfThenElse(hn::RebindMask(di, better), hn::Set(di, static_cast<std::int32_t>(s)), which);
    }
    hn::StoreU(top, d, best + i);
    hn::StoreU(which, di, scale + i);
  }
}

template <class V>
HWY_INLINE std::int64_t total(V v) {
  const D32 d;
  return hn::GetLane(hn::SumOfLanes(d, v));
}

/// i, i * i and i * t over one run: two products of a step fit 2^16, so 2^15 steps fit a lane.
struct RunSums {
  hn::Vec<D32> i, i2, ii, ii2, it, it2;
  int steps;

  HWY_INLINE void clear() {
    i = i2 = ii = ii2 = it = it2 = hn::Zero(D32());
    steps = 0;
  }

  template <class V16>
  HWY_INLINE void add(V16 picture, V16 part) {
    const D32 d;
    i = hn::ReorderWidenMulAccumulate(d, picture, hn::Set(D16(), std::int16_t{1}), i, i2);
    ii = hn::ReorderWidenMulAccumulate(d, picture, picture, ii, ii2);
    it = hn::ReorderWidenMulAccumulate(d, picture, part, it, it2);
    ++steps;
  }
  HWY_INLINE void drain(WindowSums& out) {
    out.i += total(hn::Add(i, i2));
    out.ii += wide(ii, ii2);
    out.it += wide(it, it2);
    clear();
  }
  /// Lanes fit 32 bits, their sum need not.
  static HWY_INLINE std::int64_t wide(hn::Vec<D32> a, hn::Vec<D32> b) {
    alignas(64) std::int32_t lane[2][kRstBlock / 2];
    hn::StoreU(a, D32(), lane[0]);
    hn::StoreU(b, D32(), lane[1]);
    std::int64_t sum = 0;
    for (std::size_t k = 0; k < hn::Lanes(D32()); ++k)
      sum += static_cast<std::int64_t>(lane[0][k]) + static_cast<std::int64_t>(lane[1][k]);
    return sum;
  }
};

HWY_INLINE void drain_own(RunSums& own, WindowSums& out) {
  WindowSums part;
  own.drain(part);
  out.t += part.i;
  out.tt += part.ii;
}

struct GreyLoad {
  HWY_INLINE hn::Vec<D16> operator()(const std::uint8_t* p) const {
    return hn::Sub(hn::PromoteTo(D16(), hn::LoadU(DU8(), p)), hn::Set(D16(), std::int16_t{128}));
  }
};

void sum_window_impl(image::ImageView picture, const Window& window, int x, int y, WindowSums& out) {
  const D16 d;
  const GreyLoad grey;
  const int lanes = static_cast<int>(hn::Lanes(d));
  RunSums sums;
  sums.clear();
  for (const Window::Run& run : window.runs) {
    const std::uint8_t* p = picture.row(y + run.dy) + x + run.dx;
    const std::uint8_t* t = window.values.data() + run.first;
    int k = 0;
    for (; k + lanes <= run.length; k += lanes) sums.add(grey(p + k), grey(t + k));
    if (k < run.length) {
      const auto rest = hn::FirstN(d, static_cast<std::size_t>(run.length - k));
      sums.add(hn::IfThenElseZero(rest, grey(p + k)), grey(t + k));
    }
    if (sums.steps > 16000) sums.drain(out);
  }
  sums.drain(out);
  out.n = window.pixels;
  out.t = window.sum;
  out.tt = window.sum_sq;
}

/// As above for a window that sticks out of the picture: its own sums differ, too.
void sum_clipped_impl(image::ImageView picture, const Window& window, int x, int y, WindowSums& out) {
  const D16 d;
  const GreyLoad grey;
  const int lanes = static_cast<int>(hn::Lanes(d));
  RunSums sums, own;
  sums.clear();
  own.clear();
  for (const Window::Run& run : window.runs) {
    if (y + run.dy < 0 || y + run.dy >= picture.height()) continue;
    const int from = std::max(0, -(x + run.dx)), to = std::min(run.length, picture.width() - (x + run.dx));
    if (from >= to) continue;
    const std::uint8_t* p = picture.row(y + run.dy) + x + run.dx;
    const std::uint8_t* t = window.values.data() + run.first;
    for (int k = from; k < to; k += lanes) {
      const auto rest = hn::FirstN(d, static_cast<std::size_t>(std::min(lanes, to - k)));
      const auto v = hn::IfThenElseZero(rest, grey(t + k));
      sums.add(hn::IfThenElseZero(rest, grey(p + k)), v);
      own.add(v, v);
    }
    out.n += to - from;
    if (sums.steps > 16000) {
      sums.drain(out);
      drain_own(own, out);
    }
  }
  sums.drain(out);
  drain_own(own, out);
}

#endif

}  // namespace pickcell::matches::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace pickcell::matches {

HWY_EXPORT(mean_lists_impl);
HWY_EXPORT(score_rings_impl);
HWY_EXPORT(sum_window_impl);
HWY_EXPORT(sum_clipped_impl);

void mean_lists(const std::uint8_t* first, const OffsetLists& lists, int n, float* means, std::ptrdiff_t stride) {
  HWY_DYNAMIC_DISPATCH(mean_lists_impl)(first, lists, n, means, stride);
}

void score_rings(const float* means, std::ptrdiff_t stride, int n, const RingQuery& query, float* best,
                 std::int32_t* scale) {
  HWY_DYNAMIC_DISPATCH(score_rings_impl)(means, stride, n, query, best, scale);
}

WindowSums sum_window(image::ImageView picture, const Window& window, int x, int y) {
  WindowSums out;
  if (x + window.x_lo >= 0 && y + window.y_lo >= 0 && x + window.x_hi < picture.width() &&
      y + window.y_hi < picture.height())
    HWY_DYNAMIC_DISPATCH(sum_window_impl)(picture, window, x, y, out);
  else
    HWY_DYNAMIC_DISPATCH(sum_clipped_impl)(picture, window, x, y, out);
  return out;
}

namespace plain {

void mean_lists(const std::uint8_t* first, const OffsetLists& lists, int n, float* means, std::ptrdiff_t stride) {
  for (std::size_t k = 0; k < lists.inverse_length.size(); ++k)
    for (int i = 0; i < n; ++i) {
      std::int32_t sum = 0;
      for (int p = lists.start[k]; p < lists.start[k + 1]; ++p)
        sum += first[i + lists.offsets[static_cast<std::size_t>(p)]];
      means[static_cast<std::ptrdiff_t>(k) * stride + i] = static_cast<float>(sum) * lists.inverse_length[k];
    }
}

void score_rings(const float* means, std::ptrdiff_t stride, int n, const RingQuery& query, float* best,
                 std::int32_t* scale) {
  for (int i = 0; i < n; ++i) {
    best[i] = -2;
    scale[i] = 0;
    for (std::size_t s = 0; s < query.q.size(); ++s) {
      const std::vector<float>& q = query.q[s];
      float sum = 0, square = 0, product = 0;
      for (std::size_t k = 0; k < q.size(); ++k) {
        const float c = means[static_cast<std::ptrdiff_t>(k) * stride + i] - means[i];
        sum += c;
        square += c * c;
        product += c * q[k];
      }
      const float count = static_cast<float>(q.size());
      const float variance = square - sum * sum * (1.f / count);
      if (variance <= PICKCELL_RST_FLAT * count) continue;
      const float ncc = query.negative ? std::abs(product / std::sqrt(variance)) : product / std::sqrt(variance);
      if (ncc > best[i]) {
        best[i] = ncc;
        scale[i] = static_cast<std::int32_t>(s);
      }
    }
  }
}

WindowSums sum_window(image::ImageView picture, const Window& window, int x, int y) {
  WindowSums out;
  for (const Window::Run& run : window.runs)
    for (int k = 0; k < run.length; ++k) {
      const int u = x + run.dx + k, v = y + run.dy;
      if (u < 0 || v < 0 || u >= picture.width() || v >= picture.height()) continue;
      const int i = picture.at(u, v) - 128;
      const int t = window.values[run.first + static_cast<std::size_t>(k)] - 128;
      ++out.n;
      out.i += i;
      out.ii += i * i;
      out.t += t;
      out.tt += t * t;
      out.it += i * t;
    }
  return out;
}

}  // namespace plain
}  // namespace pickcell::matches
#endif
