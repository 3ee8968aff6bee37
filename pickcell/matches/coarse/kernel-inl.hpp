// The walk over positions that all coarse kernels share. Included inside a namespace of its own by each file that is
// compiled for one target, after that target's attributes (hence no guard and no includes). Isa gives
//   kLanes, kVectors              positions per vector; vectors whose sums for four templates fit the registers
//   Cells load(const uint32_t*)
//   Sum start(int32 bias)                               or the bias comes in with store_best
//   Weights weights(const int8_t*)                      of one tap, four templates
//   template <int a> Sum add(Sum, Cells, Weights)       the dot product with template a
//   void store_best(const Sum (&four)[4], const FourTemplates&, float* score)

/// The loops over vectors must be unrolled, for the sums to stay in registers; at -O2 GCC does so only when told.
template <class Isa, int kVectors, int a>
HWY_INLINE void add_tap(typename Isa::Sum (&sum)[kVectors][4], const typename Isa::Cells (&v)[kVectors],
                        const typename Isa::Weights& four) {
#pragma GCC unroll 8
  for (int i = 0; i < kVectors; ++i) sum[i][a] = Isa::template add<a>(sum[i][a], v[i], four);
}

template <class Isa, int kVectors>
HWY_INLINE void score_vectors(const std::uint32_t* const* cells, const FourTemplates& t, float* const* score) {
  typename Isa::Sum sum[kVectors][4];
#pragma GCC unroll 8
  for (int i = 0; i < kVectors; ++i)
#pragma GCC unroll 4
    for (int a = 0; a < 4; ++a) sum[i][a] = Isa::start(t.bias[a]);
  const std::size_t taps = t.offsets.size();
  const std::int32_t* offset = t.offsets.data();
  const std::int8_t* w = t.weights.data();
  for (std::size_t k = 0; k < taps; ++k, w += 16) {
    typename Isa::Cells v[kVectors];
#pragma GCC unroll 8
    for (int i = 0; i < kVectors; ++i) v[i] = Isa::load(cells[i] + offset[k]);
    const typename Isa::Weights four = Isa::weights(w);
    add_tap<Isa, kVectors, 0>(sum, v, four);
    add_tap<Isa, kVectors, 1>(sum, v, four);
    add_tap<Isa, kVectors, 2>(sum, v, four);
    add_tap<Isa, kVectors, 3>(sum, v, four);
  }
#pragma GCC unroll 8
  for (int i = 0; i < kVectors; ++i) Isa::store_best(sum[i], t, score[i]);
}

/// Vectors of all rows are worked off in groups, so that short rows fill the registers as well as long ones.
template <class Isa>
HWY_INLINE void score_block(const CellBlock& c, const FourTemplates& t, float* score, std::ptrdiff_t score_stride) {
  constexpr int kMost = Isa::kVectors;
  const std::uint32_t* from[kMost];
  float* to[kMost];
  int n = 0;
  for (int y = 0; y < c.height; ++y)
    for (int x = 0; x < c.width; x += Isa::kLanes) {
      from[n] = c.origin + y * c.stride + x;
      to[n] = score + y * score_stride + x;
      if (++n < kMost) continue;
      score_vectors<Isa, kMost>(from, t, to);
      n = 0;
    }
  int i = 0;
  for (; i + 2 <= n; i += 2) score_vectors<Isa, 2>(from + i, t, to + i);
  if (i < n) score_vectors<Isa, 1>(from + i, t, to + i);
}
