// The kernel of vpdpbusd, in the compiler's own vectors. Included inside a namespace of its own for each encoding of
// the instruction, after that target's attributes and coarse_kernel-inl.hpp (hence no guard and no includes).
// Instruction gives
//   kBytes, kVectors                of one register; vectors whose sums for four templates fit the registers
//   Words                           a vector of int32
//   Words dot(Words sum, Words unsigned_bytes, Words signed_bytes)

template <class Instruction>
struct Vnni {
  static constexpr int kLanes = Instruction::kBytes / 4;
  static constexpr int kVectors = Instruction::kVectors;
  using Words = typename Instruction::Words;
  typedef float Floats __attribute__((vector_size(Instruction::kBytes)));
  using Cells = Words;
  using Sum = Words;
  using Weights = const std::int8_t*;

  static HWY_INLINE Cells load(const std::uint32_t* cells) {
    Cells v;
    std::memcpy(&v, cells, sizeof v);
    return v;
  }
  static HWY_INLINE Sum start(std::int32_t bias) { return Words{} + bias; }
  static HWY_INLINE Weights weights(const std::int8_t* w) { return w; }
  template <int a>
  static HWY_INLINE Sum add(Sum s, Cells v, Weights w) {
    std::int32_t four;
    std::memcpy(&four, w + 4 * a, sizeof four);
    return Instruction::dot(s, v, Words{} + four);
  }
  static HWY_INLINE Floats scaled(Sum s, float norm) { return __builtin_convertvector(s, Floats) * norm; }
  static HWY_INLINE Floats larger(Floats a, Floats b) { return a > b ? a : b; }
  static HWY_INLINE void store_best(const Sum (&four)[4], const FourTemplates& t, float* score) {
    const Floats low = larger(scaled(four[0], t.norm[0]), scaled(four[1], t.norm[1]));
    const Floats best = larger(low, larger(scaled(four[2], t.norm[2]), scaled(four[3], t.norm[3])));
    std::memcpy(score, &best, sizeof best);
  }
};

void run(const CellBlock& c, const FourTemplates& t, float* score, std::ptrdiff_t score_stride) {
  score_block<Vnni<Dot>>(c, t, score, score_stride);
}
