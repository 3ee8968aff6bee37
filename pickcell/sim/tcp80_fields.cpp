#include "pickcell/sim/tcp80_fields.hpp"

#include <charconv>
#include <cmath>

namespace pickcell::sim::tcp80_fields {

namespace {

bool padding(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\n' || c == '\0'; }

}  // namespace

std::string_view trimmed(std::string_view s) {
  while (!s.empty() && padding(s.front())) s.remove_prefix(1);
  while (!s.empty() && padding(s.back())) s.remove_suffix(1);
  return s;
}

std::vector<std::string_view> split(std::string_view operands) {
  std::vector<std::string_view> fields;
  std::string_view rest = trimmed(operands);
  if (rest.empty()) return fields;
  while (true) {
    const std::size_t comma = rest.find(',');
    fields.push_back(trimmed(rest.substr(0, comma)));
    if (comma == std::string_view::npos) return fields;
    rest.remove_prefix(comma + 1);
  }
}

std::optional<double> number(std::string_view text) {
  if (text.starts_with('+')) text.remove_prefix(1);
  double v = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), v, std::chars_format::fixed);
  if (error != std::errc{} || end != text.data() + text.size() || !std::isfinite(v)) return std::nullopt;
  return v;
}

std::optional<std::int32_t> whole(std::string_view text, double low, double high) {
  const auto v = number(text);
  if (!v || *v < low || *v > high || *v != std::floor(*v)) return std::nullopt;
  return static_cast<std::int32_t>(*v);
}

}  // namespace pickcell::sim::tcp80_fields
