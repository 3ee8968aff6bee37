#include "pickcell/sim/job_text.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <limits>
#include <utility>

namespace pickcell::sim::job_text {

namespace {

bool blank(char c) { return c == ' ' || c == '\t'; }

std::string_view trimmed(std::string_view s) {
  while (!s.empty() && blank(s.front())) s.remove_prefix(1);
  while (!s.empty() && blank(s.back())) s.remove_suffix(1);
  return s;
}

std::optional<Operand> numbered(Operand::Kind kind, std::string_view digits) {
  const auto index = whole(digits);
  if (!index || *index < 0 || digits.front() == '+' || digits.front() == '-') return std::nullopt;
  return Operand{kind, *index, 0, {}};
}

std::optional<Operand> contact(Operand::Kind kind, std::string_view rest) {
  const auto n = bracketed(rest);
  if (!n || *n < 1) return std::nullopt;
  return Operand{kind, *n, 0, {}};
}

std::optional<Condition::Term> term(std::string_view text) {
  constexpr std::array<std::pair<std::string_view, Compare>, 6> kSigns{{{"<>", Compare::not_equal},
                                                                        {"<=", Compare::less_equal},
                                                                        {">=", Compare::greater_equal},
                                                                        {"=", Compare::equal},
                                                                        {"<", Compare::less},
                                                                        {">", Compare::greater}}};
  for (const auto& [sign, compare] : kSigns) {
    const std::size_t at = text.find(sign);
    if (at == std::string_view::npos) continue;
    const auto left = operand(trimmed(text.substr(0, at)));
    const auto right = operand(trimmed(text.substr(at + sign.size())));
    if (!left || !right) return std::nullopt;
    return Condition::Term{*left, compare, *right};
  }
  return std::nullopt;
}

}  // namespace

std::vector<std::string_view> words(std::string_view line) {
  std::vector<std::string_view> out;
  std::size_t i = 0;
  while (i < line.size()) {
    while (i < line.size() && blank(line[i])) ++i;
    const std::size_t start = i;
    if (i < line.size() && line[i] == '"') {
      i = std::min(line.find('"', i + 1), line.size() - 1) + 1;
    } else {
      while (i < line.size() && !blank(line[i])) ++i;
    }
    if (i > start) out.push_back(line.substr(start, i - start));
  }
  return out;
}

std::optional<double> number(std::string_view word) {
  double v = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), v, std::chars_format::fixed);
  if (error != std::errc{} || end != word.data() + word.size() || !std::isfinite(v)) return std::nullopt;
  return v;
}

std::optional<int> whole(std::string_view word) {
  int v = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), v);
  if (error != std::errc{} || end != word.data() + word.size()) return std::nullopt;
  return v;
}

std::optional<double> setting(std::string_view word, std::string_view key) {
  if (!word.starts_with(key) || word.size() <= key.size() || word[key.size()] != '=') return std::nullopt;
  return number(word.substr(key.size() + 1));
}

std::optional<int> bracketed(std::string_view word) {
  if (word.size() < 3 || word.front() != '(' || word.back() != ')') return std::nullopt;
  return whole(word.substr(1, word.size() - 2));
}

std::optional<Operand> operand(std::string_view word) {
  using Kind = Operand::Kind;
  if (word.empty()) return std::nullopt;
  if (word == "ON") return Operand{Kind::number, 0, 1, {}};
  if (word == "OFF") return Operand{Kind::number, 0, 0, {}};
  if (word.starts_with("IN#")) return contact(Kind::IN, word.substr(3));
  if (word.starts_with("OT#")) return contact(Kind::OT, word.substr(3));
  if (word.size() >= 2 && word.front() == '"' && word.back() == '"')
    return Operand{Kind::text, 0, 0, std::string(word.substr(1, word.size() - 2))};
  constexpr std::array<std::pair<char, Kind>, 7> kVariables{
      {{'B', Kind::B}, {'I', Kind::I}, {'D', Kind::D}, {'R', Kind::R}, {'S', Kind::S}, {'P', Kind::P}, {'C', Kind::C}}};
  for (const auto& [letter, kind] : kVariables)
    if (word.front() == letter) return word.size() > 1 ? numbered(kind, word.substr(1)) : std::nullopt;
  const auto constant = number(word);
  if (!constant) return std::nullopt;
  return Operand{Kind::number, 0, *constant, {}};
}

std::optional<Condition> condition(std::string_view text) {
  Condition found;
  const bool has_and = text.find(" AND ") != std::string_view::npos;
  found.any = text.find(" OR ") != std::string_view::npos;
  if (has_and && found.any) return std::nullopt;
  const std::string_view joint = found.any ? " OR " : " AND ";
  while (true) {
    const std::size_t at = text.find(joint);
    const auto one = term(trimmed(text.substr(0, at)));
    if (!one) return std::nullopt;
    found.terms.push_back(*one);
    if (at == std::string_view::npos) return found;
    text.remove_prefix(at + joint.size());
  }
}

std::optional<std::array<std::int32_t, 6>> six(std::string_view text, int decimals_xyz, int decimals_rxyz) {
  std::array<std::int32_t, 6> out{};
  for (std::size_t i = 0; i < 6; ++i) {
    const std::size_t comma = text.find(',');
    if ((comma == std::string_view::npos) != (i == 5)) return std::nullopt;
    const auto v = number(trimmed(text.substr(0, comma)));
    if (!v) return std::nullopt;
    const double scaled = std::round(*v * std::pow(10.0, i < 3 ? decimals_xyz : decimals_rxyz));
    if (std::abs(scaled) > std::numeric_limits<std::int32_t>::max()) return std::nullopt;
    out[i] = static_cast<std::int32_t>(scaled);
    if (i < 5) text.remove_prefix(comma + 1);
  }
  return out;
}

bool job_name(std::string_view name) {
  return !name.empty() && name.size() <= 32 && std::none_of(name.begin(), name.end(), [](char c) {
    return c <= ' ' || c >= 0x7f || (c >= 'a' && c <= 'z') || c == ',' || c == '*' || c == '"' || c == '/';
  });
}

}  // namespace pickcell::sim::job_text
