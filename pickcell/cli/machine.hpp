#pragma once
/// Which machine a measurement was taken on.

#include <string>

namespace pickcell::cli {

/// For people: the processor as the system names it, how many threads it runs, and the SIMD target of the kernels, as
/// in "AMD EPYC, 2 threads, avx3_zen4".
[[nodiscard]] std::string machine();

}  // namespace pickcell::cli
