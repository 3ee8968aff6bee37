#pragma once
/// Wall time in words.

#include <cstdint>
#include <string>

namespace pickcell::core {

/// By strftime's format, in UTC.
[[nodiscard]] std::string utc(std::int64_t unix_us, const char* format);
/// ISO 8601: "2026-01-01T00:00:00Z".
[[nodiscard]] std::string iso_utc(std::int64_t unix_us);

}  // namespace pickcell::core
