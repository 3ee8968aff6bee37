#pragma once
/// SQLite, as much of it as the cell's records need: a file that survives a power cut, and prepared statements.

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "pickcell/core/result.hpp"

struct sqlite3;
struct sqlite3_stmt;

namespace pickcell::cell {

/// A column or parameter: NULL, INTEGER, REAL or TEXT.
using SqlValue = std::variant<std::monostate, std::int64_t, double, std::string>;
using SqlRow = std::vector<SqlValue>;

/// One SQLite file in WAL mode with synchronous=FULL: what execute() has returned from is on the disk, even after a
/// power cut. One thread at a time. Errors: unreadable, naming the file and SQLite's reason (disk full, damaged,
/// locked, not a database).
class Database {
 public:
  /// Opens or makes the file; its folder must exist. Checks that it is a sound database.
  [[nodiscard]] static core::Result<Database> open(const std::filesystem::path& path);
  /// An existing file of anybody, to be read only: neither it nor its folder is changed where no writer left a log
  /// beside it (FILE-wal). Texts are at most a megabyte long, and nothing that its schema holds is run.
  [[nodiscard]] static core::Result<Database> open_to_read(const std::filesystem::path& path);

  Database(Database&&) noexcept = default;
  Database& operator=(Database&&) noexcept = default;

  /// Runs statements without parameters (schema, BEGIN, COMMIT).
  [[nodiscard]] core::Status script(std::string_view sql);
  /// Runs one statement with its parameters (?1, ?2, ...) and returns its rows.
  [[nodiscard]] core::Result<std::vector<SqlRow>> execute(std::string_view sql, const SqlRow& parameters = {});
  /// Rows changed by the last execute().
  [[nodiscard]] std::int64_t changes() const;

 private:
  struct Close {
    void operator()(sqlite3* handle) const;
  };
  Database(std::unique_ptr<sqlite3, Close> handle, std::string name)
      : handle_(std::move(handle)), name_(std::move(name)) {}
  [[nodiscard]] core::Error error(std::string_view doing) const;
  [[nodiscard]] core::Status check_sound();

  std::unique_ptr<sqlite3, Close> handle_;
  std::string name_;
};

/// The value, or a neutral one when the column holds another type.
[[nodiscard]] std::int64_t as_integer(const SqlValue& value);
[[nodiscard]] double as_real(const SqlValue& value);
[[nodiscard]] std::string as_text(const SqlValue& value);

}  // namespace pickcell::cell
