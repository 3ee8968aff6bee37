#include "pickcell/core/date.hpp"

#include <ctime>

namespace pickcell::core {

std::string utc(std::int64_t unix_us, const char* format) {
  constexpr std::int64_t kSecond = 1'000'000;
  const std::int64_t whole = unix_us / kSecond - (unix_us % kSecond < 0 ? 1 : 0);
  const std::time_t t = static_cast<std::time_t>(whole);
  std::tm parts{};
  gmtime_r(&t, &parts);
  char buffer[80];
  return {buffer, std::strftime(buffer, sizeof buffer, format, &parts)};
}

std::string iso_utc(std::int64_t unix_us) { return utc(unix_us, "%Y-%m-%dT%H:%M:%SZ"); }

}  // namespace pickcell::core
