#include "pickcell/cli/replay/shard.hpp"

#include <charconv>
#include <optional>
#include <string_view>

namespace pickcell::cli {

namespace {

constexpr std::size_t kMostShards = 1'000'000;

std::optional<std::size_t> whole(std::string_view text) {
  std::size_t out = 0;
  const auto [end, problem] = std::from_chars(text.data(), text.data() + text.size(), out);
  if (problem != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return out;
}

}  // namespace

core::Result<Shard> parse_shard(const std::string& text) {
  const std::size_t slash = text.find('/');
  if (slash != std::string::npos) {
    const auto index = whole(std::string_view(text).substr(0, slash));
    const auto count = whole(std::string_view(text).substr(slash + 1));
    if (index && count && *index >= 1 && *index <= *count && *count <= kMostShards) return Shard{*index, *count};
  }
  return core::failure(core::ErrorCode::usage, "--shard", "'" + text + "' is no share of a whole",
                       "use i/n with 1 <= i <= n, from 1/4 to 4/4 for four shares");
}

}  // namespace pickcell::cli
