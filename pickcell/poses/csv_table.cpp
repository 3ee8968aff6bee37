#include "pickcell/poses/csv_table.hpp"

#include <charconv>
#include <cmath>

namespace pickcell::poses {

namespace {

using core::ErrorCode;
using core::failure;

constexpr std::size_t kMaxRows = 10'000, kMaxColumns = 64;

std::string_view trimmed(std::string_view text) {
  const std::size_t begin = text.find_first_not_of(" \t\r\"");
  if (begin == std::string_view::npos) return {};
  return text.substr(begin, text.find_last_not_of(" \t\r\"") - begin + 1);
}

std::vector<std::string> fields_of(std::string_view line, char separator) {
  std::vector<std::string> out;
  while (out.size() <= kMaxColumns) {
    const std::size_t at = line.find(separator);
    out.emplace_back(trimmed(line.substr(0, at)));
    if (at == std::string_view::npos) break;
    line.remove_prefix(at + 1);
  }
  return out;
}

/// Titles hold none of these: the header says what spreadsheets of other countries write between fields.
char separator_of(std::string_view header) {
  for (const char c : {',', ';', '\t'})
    if (header.find(c) != std::string_view::npos) return c;
  return ',';
}

}  // namespace

core::Result<CsvTable> CsvTable::parse(std::string_view text, std::string name) {
  CsvTable out;
  out.name_ = std::move(name);
  if (text.starts_with("\xEF\xBB\xBF")) text.remove_prefix(3);
  char separator = ',';
  for (int line = 1; !text.empty(); ++line) {
    const std::size_t end = text.find('\n');
    const std::string_view whole = trimmed(text.substr(0, end));
    text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
    if (whole.empty() || whole.front() == '#') continue;
    if (out.header_.empty()) separator = separator_of(whole);
    auto fields = fields_of(whole, separator);
    if (out.header_.empty()) {
      if (fields.size() > kMaxColumns) return failure(ErrorCode::unreadable, out.name_, "has too many columns");
      out.header_ = std::move(fields);
      continue;
    }
    out.rows_.push_back({line, std::move(fields)});
    const std::size_t row = out.rows_.size() - 1;
    if (out.rows_.back().fields.size() != out.header_.size())
      return out.bad_row(row,
                         "has " + std::to_string(out.rows_.back().fields.size()) + " fields, the header " +
                             std::to_string(out.header_.size()),
                         "write one value for every title, separated as the titles are");
    if (row >= kMaxRows) return failure(ErrorCode::unreadable, out.name_, "has more than 10000 rows");
  }
  if (out.header_.empty()) return failure(ErrorCode::unreadable, out.name_, "is empty", "begin with a header line");
  return out;
}

std::optional<std::size_t> CsvTable::column(std::string_view title) const {
  for (std::size_t i = 0; i < header_.size(); ++i)
    if (header_[i] == title) return i;
  return std::nullopt;
}

const std::string& CsvTable::text(std::size_t row, std::size_t column) const { return rows_[row].fields[column]; }

tl::unexpected<core::Error> CsvTable::bad_row(std::size_t row, std::string why, std::string remedy) const {
  return failure(ErrorCode::unreadable, name_ + " line " + std::to_string(rows_[row].line), std::move(why),
                 std::move(remedy));
}

core::Result<double> CsvTable::number(std::size_t row, std::size_t column) const {
  const std::string& field = text(row, column);
  double value = 0;
  const char* begin = field.data() + (field.starts_with('+') ? 1 : 0);
  const char* end = field.data() + field.size();
  const auto [used, error] = std::from_chars(begin, end, value);
  if (error != std::errc{} || used != end)
    return bad_row(row, header_[column] + " is '" + field + "', which is no number",
                   field.find(',') == std::string::npos ? "write plain numbers" : "write a decimal point, no comma");
  if (!std::isfinite(value))
    return bad_row(row, header_[column] + " is " + field + ", which is not finite", "record this pose again");
  return value;
}

core::Result<int> CsvTable::whole_number(std::size_t row, std::size_t column) const {
  const auto value = number(row, column);
  if (!value) return tl::unexpected(value.error());
  if (*value != std::floor(*value) || std::abs(*value) > 1e6)
    return bad_row(row, header_[column] + " is '" + text(row, column) + "', which is no whole number", "count from 0");
  return static_cast<int>(*value);
}

core::Result<std::vector<std::size_t>> CsvTable::columns(const std::vector<std::string>& titles) const {
  std::vector<std::size_t> out;
  for (const std::string& title : titles) {
    const auto at = column(title);
    if (!at) {
      std::string wanted, there;
      for (const std::string& t : titles) wanted += (wanted.empty() ? "" : ",") + t;
      for (const std::string& h : header_) there += (there.empty() ? "" : ",") + h;
      return failure(ErrorCode::unreadable, name_, "its header has no column '" + title + "': " + there,
                     "begin the file with the line " + wanted);
    }
    out.push_back(*at);
  }
  return out;
}

}  // namespace pickcell::poses
