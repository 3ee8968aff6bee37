#pragma once
/// One share of a large run, for whatever scheduler hands the shares out.

#include <cstddef>
#include <string>

#include "pickcell/core/result.hpp"

namespace pickcell::cli {

/// Every count-th frame, beginning with the index-th; from 1.
struct Shard {
  std::size_t index = 1, count = 1;
};

/// Value of --shard: `i/n` with 1 <= i <= n <= 1000000. Errors: usage.
[[nodiscard]] core::Result<Shard> parse_shard(const std::string& text);

}  // namespace pickcell::cli
