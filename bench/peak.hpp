#pragma once
/// What this machine can do at most with the instructions of one SIMD target, measured on registers and the first
/// cache alone: what a kernel's rate is a fraction of.

#include <cstdint>
#include <string>

namespace pickcell::bench {

/// Per second.
struct Peak {
  double products = 0;  ///< of two small whole numbers, added up: what the coarse kernel consists of
  double steps = 0;     ///< float multiply-adds, or anything else done in one instruction per vector
  double reads = 0;     ///< 32-bit values gathered from scattered places
};

/// Of a target of Highway. Measured once (some milliseconds each), then remembered.
[[nodiscard]] const Peak& peak_of(std::int64_t highway_target);

/// Products of a dot-product instruction that Highway does not know: "avx512vnni", "avxvnni", "neon-dotprod".
[[nodiscard]] double dot_product_peak(const std::string& kernel);

}  // namespace pickcell::bench
