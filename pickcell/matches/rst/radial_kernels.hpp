#pragma once
/// The inner loops of step 2 of rst and erst, as in kernels.hpp: one source for every SIMD target, the same whole
/// numbers as the plain forms.

#include <cstddef>
#include <cstdint>
#include <span>

namespace pickcell::matches {

/// out[s] = dot product of a and b + starts[s], 16-bit values; count a multiple of kRstBlock, |sums| < 2^31.
void dots(const std::int16_t* a, const std::int16_t* b, int count, std::span<const int> starts, std::int32_t* out);

/// out[t] = sum of a[j] * b[2 t + j] over j in [0, 2 * pairs), for t in [0, count): the dot products of every second
/// turn, side by side in the lanes. Values up to a multiple of kStepBlock are written, and so far b is read.
constexpr int kStepBlock = 16;
void stepped_dots(const std::int16_t* a, const std::int16_t* b, int pairs, int count, std::int32_t* out);

/// The same in plain C++.
namespace plain {
void dots(const std::int16_t* a, const std::int16_t* b, int count, std::span<const int> starts, std::int32_t* out);
void stepped_dots(const std::int16_t* a, const std::int16_t* b, int pairs, int count, std::int32_t* out);
}  // namespace plain

}  // namespace pickcell::matches
