#pragma once
/// Small tables of text with a header line, separated by commas, semicolons or tabs.

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "pickcell/core/result.hpp"

namespace pickcell::poses {

class CsvTable {
 public:
  /// Blank lines and lines that begin with '#' are skipped; blanks around fields, CR and a byte order mark too. The
  /// header says what separates: a comma, else a semicolon, else a tab; numbers have a decimal point in any case. Every
  /// row must have as many fields as the header; at most 10000 rows, 64 columns. name: for errors.
  [[nodiscard]] static core::Result<CsvTable> parse(std::string_view text, std::string name);

  [[nodiscard]] std::size_t rows() const { return rows_.size(); }
  [[nodiscard]] const std::vector<std::string>& header() const { return header_; }
  [[nodiscard]] std::optional<std::size_t> column(std::string_view title) const;
  [[nodiscard]] const std::string& text(std::size_t row, std::size_t column) const;
  /// A finite number, or an error that names line and column.
  [[nodiscard]] core::Result<double> number(std::size_t row, std::size_t column) const;
  [[nodiscard]] core::Result<int> whole_number(std::size_t row, std::size_t column) const;
  /// An error about a row: `NAME line N: why; remedy`.
  [[nodiscard]] tl::unexpected<core::Error> bad_row(std::size_t row, std::string why, std::string remedy) const;
  /// Columns under these titles; the error names the first that is missing and what there is.
  [[nodiscard]] core::Result<std::vector<std::size_t>> columns(const std::vector<std::string>& titles) const;

 private:
  struct Row {
    int line = 0;
    std::vector<std::string> fields;
  };
  std::string name_;
  std::vector<std::string> header_;
  std::vector<Row> rows_;
};

}  // namespace pickcell::poses
