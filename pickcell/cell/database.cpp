#include "pickcell/cell/database.hpp"

#include <sqlite3.h>

#include <algorithm>
#include <cctype>
#include <system_error>

namespace pickcell::cell {

using core::ErrorCode;

namespace {

constexpr int kBusyTimeoutMs = 2000;
constexpr int kLongestReadBytes = 1 << 20;

/// A path in a file: URI.
std::string percent_encoded(const std::string& path) {
  constexpr char kHex[] = "0123456789ABCDEF";
  std::string out;
  for (const char c : path) {
    const auto byte = static_cast<unsigned char>(c);
    if (std::isalnum(byte) || c == '/' || c == '-' || c == '_' || c == '.')
      out += c;
    else
      out += {'%', kHex[byte >> 4], kHex[byte & 15]};
  }
  return out;
}

struct Finalize {
  void operator()(sqlite3_stmt* statement) const { sqlite3_finalize(statement); }
};
using Statement = std::unique_ptr<sqlite3_stmt, Finalize>;

int bind(sqlite3_stmt* statement, int index, const SqlValue& value) {
  if (const auto* i = std::get_if<std::int64_t>(&value)) return sqlite3_bind_int64(statement, index, *i);
  if (const auto* d = std::get_if<double>(&value)) return sqlite3_bind_double(statement, index, *d);
  if (const auto* s = std::get_if<std::string>(&value))
    return sqlite3_bind_text(statement, index, s->data(), static_cast<int>(s->size()), SQLITE_TRANSIENT);
  return sqlite3_bind_null(statement, index);
}

SqlValue column(sqlite3_stmt* statement, int index) {
  switch (sqlite3_column_type(statement, index)) {
    case SQLITE_INTEGER:
      return static_cast<std::int64_t>(sqlite3_column_int64(statement, index));
    case SQLITE_FLOAT:
      return sqlite3_column_double(statement, index);
    case SQLITE_NULL:
      return std::monostate{};
    default: {
      const void* bytes = sqlite3_column_blob(statement, index);
      const auto size = static_cast<std::size_t>(sqlite3_column_bytes(statement, index));
      return bytes ? std::string(static_cast<const char*>(bytes), size) : std::string();
    }
  }
}

}  // namespace

void Database::Close::operator()(sqlite3* handle) const { sqlite3_close_v2(handle); }

core::Error Database::error(std::string_view doing) const {
  std::string why = std::string(doing) + ": " + (handle_ ? sqlite3_errmsg(handle_.get()) : "out of memory");
  // SQLite quotes what it found in the file.
  std::replace_if(why.begin(), why.end(), [](unsigned char c) { return c < 0x20 || c > 0x7e; }, '?');
  return {ErrorCode::unreadable, name_, std::move(why), "check the disk and the file; move a damaged file aside", {}};
}

core::Result<Database> Database::open(const std::filesystem::path& path) {
  sqlite3* raw = nullptr;
  const int opened =
      sqlite3_open_v2(path.c_str(), &raw, SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE | SQLITE_OPEN_NOMUTEX, nullptr);
  Database database(std::unique_ptr<sqlite3, Close>(raw), path.string());
  if (opened != SQLITE_OK) return tl::unexpected(database.error("cannot be opened"));
  sqlite3_busy_timeout(raw, kBusyTimeoutMs);
  if (auto sound = database.check_sound(); !sound) return core::forward(sound);
  if (auto set = database.script("PRAGMA journal_mode=WAL; PRAGMA synchronous=FULL; PRAGMA foreign_keys=ON;"); !set)
    return core::forward(set);
  return database;
}

core::Result<Database> Database::open_to_read(const std::filesystem::path& path) {
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(path, ignored))
    return core::failure(ErrorCode::unreadable, path.string(), "no such file", "check the path");
  // Without a writer's log nothing can change the file: SQLite then needs no files of its own beside it, and it can lie
  // in a read-only archive.
  const bool has_log = std::filesystem::exists(path.string() + "-wal", ignored);
  const std::string uri = "file:" + percent_encoded(std::filesystem::absolute(path).string()) +
                          (has_log ? "?mode=ro" : "?mode=ro&immutable=1");
  sqlite3* raw = nullptr;
  const int opened =
      sqlite3_open_v2(uri.c_str(), &raw, SQLITE_OPEN_READONLY | SQLITE_OPEN_URI | SQLITE_OPEN_NOMUTEX, nullptr);
  Database database(std::unique_ptr<sqlite3, Close>(raw), path.string());
  if (opened != SQLITE_OK) return tl::unexpected(database.error("cannot be opened"));
  sqlite3_busy_timeout(raw, kBusyTimeoutMs);
  sqlite3_limit(raw, SQLITE_LIMIT_LENGTH, kLongestReadBytes);
  sqlite3_db_config(raw, SQLITE_DBCONFIG_DEFENSIVE, 1, nullptr);
  sqlite3_db_config(raw, SQLITE_DBCONFIG_TRUSTED_SCHEMA, 0, nullptr);
  if (auto sound = database.check_sound(); !sound) return core::forward(sound);
  return database;
}

core::Status Database::check_sound() {
  const auto sound = execute("PRAGMA quick_check(1)");
  if (!sound) return tl::unexpected(sound.error());
  if (!sound->empty() && as_text(sound->front().front()) == "ok") return {};
  return core::failure(ErrorCode::unreadable, name_, "the database is damaged", "move the file aside");
}

core::Status Database::script(std::string_view sql) {
  const std::string text(sql);
  if (sqlite3_exec(handle_.get(), text.c_str(), nullptr, nullptr, nullptr) != SQLITE_OK)
    return tl::unexpected(error("cannot be written"));
  return {};
}

core::Result<std::vector<SqlRow>> Database::execute(std::string_view sql, const SqlRow& parameters) {
  sqlite3_stmt* raw = nullptr;
  if (sqlite3_prepare_v2(handle_.get(), sql.data(), static_cast<int>(sql.size()), &raw, nullptr) != SQLITE_OK)
    return tl::unexpected(error("statement refused"));
  const Statement statement(raw);
  for (std::size_t i = 0; i < parameters.size(); ++i)
    if (bind(raw, static_cast<int>(i) + 1, parameters[i]) != SQLITE_OK)
      return tl::unexpected(error("parameter refused"));
  std::vector<SqlRow> rows;
  int step = SQLITE_ROW;
  while ((step = sqlite3_step(raw)) == SQLITE_ROW) {
    SqlRow row;
    for (int c = 0; c < sqlite3_column_count(raw); ++c) row.push_back(column(raw, c));
    rows.push_back(std::move(row));
  }
  if (step != SQLITE_DONE) return tl::unexpected(error("cannot be read or written"));
  return rows;
}

std::int64_t Database::changes() const { return sqlite3_changes64(handle_.get()); }

std::int64_t as_integer(const SqlValue& value) {
  const auto* i = std::get_if<std::int64_t>(&value);
  return i ? *i : 0;
}

double as_real(const SqlValue& value) {
  if (const auto* d = std::get_if<double>(&value)) return *d;
  return static_cast<double>(as_integer(value));
}

std::string as_text(const SqlValue& value) {
  const auto* s = std::get_if<std::string>(&value);
  return s ? *s : std::string();
}

}  // namespace pickcell::cell
