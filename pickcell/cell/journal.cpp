#include "pickcell/cell/journal.hpp"

#include <array>
#include <utility>

namespace pickcell::cell {

using core::ErrorCode;
using robot::CommandState;
using robot::JournalRow;

namespace {

constexpr int kSchemaVersion = 2;

// Live are the rows whose outcome is open: at most one per part and per place, however often the PC restarts.
constexpr std::string_view kSchema = R"sql(
BEGIN IMMEDIATE;
CREATE TABLE cmd (
  seq INTEGER PRIMARY KEY, epoch INTEGER NOT NULL, track INTEGER NOT NULL, slot INTEGER NOT NULL, model TEXT NOT NULL,
  payload TEXT NOT NULL, state TEXT NOT NULL CHECK (state IN ('intent','sent','done','refused','void','unknown')),
  result INTEGER NOT NULL, t_intent INTEGER NOT NULL, t_sent INTEGER NOT NULL, t_done INTEGER NOT NULL
) STRICT;
CREATE UNIQUE INDEX one_live_per_track ON cmd (track) WHERE state IN ('intent','sent');
CREATE UNIQUE INDEX one_live_per_slot ON cmd (model, slot) WHERE state IN ('intent','sent');
CREATE TABLE fence (epoch INTEGER PRIMARY KEY, last_seq INTEGER NOT NULL) STRICT;
COMMIT;
)sql";

// Version 2: after which pick the tray of a model was last exchanged.
constexpr std::string_view kTraySchema = R"sql(
BEGIN IMMEDIATE;
CREATE TABLE tray (model TEXT PRIMARY KEY, after_seq INTEGER NOT NULL) STRICT;
PRAGMA user_version = 2;
COMMIT;
)sql";

constexpr std::string_view kColumns =
    "SELECT seq, epoch, track, slot, model, payload, state, result, t_intent, t_sent, t_done FROM cmd ";

constexpr std::array kStates = {CommandState::intent,  CommandState::sent,  CommandState::done,
                                CommandState::refused, CommandState::void_, CommandState::unknown};

/// SQLite's reasons with what a person should do; a journal must not be thrown away lightly.
core::Error explained(core::Error error) {
  if (error.why.find("locked") != std::string::npos) {
    error.why = "in use by another process";
    error.remedy = "stop the other pickcell of this cell; two must never drive one arm";
  } else if (error.why.find("full") != std::string::npos || error.why.find("I/O") != std::string::npos) {
    error.remedy = "make room on the disk; no pick is sent while the journal cannot be written";
  } else {
    error.remedy = "keep the file; move it aside and start again: a person must then confirm before anything moves";
  }
  return error;
}

JournalRow row_from(const SqlRow& c) {
  JournalRow row;
  row.sequence = static_cast<std::int32_t>(as_integer(c[0]));
  row.epoch = static_cast<std::int32_t>(as_integer(c[1]));
  row.detection_id = static_cast<std::uint64_t>(as_integer(c[2]));
  row.place_slot = static_cast<int>(as_integer(c[3]));
  row.model = as_text(c[4]);
  row.payload = as_text(c[5]);
  for (const CommandState s : kStates) {
    if (as_text(c[6]) == name(s)) row.state = s;
  }
  row.result = static_cast<int>(as_integer(c[7]));
  row.t_intent_us = as_integer(c[8]);
  row.t_sent_us = as_integer(c[9]);
  row.t_done_us = as_integer(c[10]);
  return row;
}

/// Makes the tables of a new file, brings those of version 1 up to date.
core::Status prepare(Database& database, const std::string& name) {
  auto version = database.execute("PRAGMA user_version");
  if (!version) return core::forward(version);
  auto tables = database.execute("SELECT count(*) FROM sqlite_master");
  if (!tables) return core::forward(tables);
  const auto found = as_integer(version->front().front());
  if (found == kSchemaVersion) return {};
  if (found == 1) return database.script(kTraySchema);
  if (found == 0 && as_integer(tables->front().front()) == 0) {
    if (auto made = database.script(kSchema); !made) return made;
    return database.script(kTraySchema);
  }
  return core::failure(ErrorCode::unreadable, name,
                       found == 0 ? "a database, but no journal"
                                  : "journal of version " + std::to_string(found) + "; this program knows 1 and 2",
                       "use the pickcell that wrote it, or move the file aside: a person must then confirm");
}

}  // namespace

core::Result<std::unique_ptr<SqliteJournal>> SqliteJournal::open(const std::filesystem::path& path) {
  std::error_code problem;
  if (!path.parent_path().empty()) std::filesystem::create_directories(path.parent_path(), problem);
  if (problem)
    return core::failure(ErrorCode::unreadable, path.parent_path().string(), problem.message(),
                         "make the folder writable");
  auto database = Database::open(path);
  if (!database) return tl::unexpected(explained(std::move(database.error())));
  // Held from here on: the exclusive lock is taken by the first write and never given back.
  if (auto held = database->script("PRAGMA locking_mode=EXCLUSIVE; BEGIN IMMEDIATE; COMMIT;"); !held)
    return tl::unexpected(explained(std::move(held.error())));
  if (auto prepared = prepare(*database, path.string()); !prepared) return core::forward(prepared);
  return std::unique_ptr<SqliteJournal>(new SqliteJournal(std::move(*database), path.string()));
}

core::Status SqliteJournal::write(std::string_view sql, const SqlRow& parameters) {
  if (auto done = database_.execute(sql, parameters); !done) return tl::unexpected(explained(std::move(done.error())));
  return {};
}

core::Status SqliteJournal::record_intent(const JournalRow& row) {
  return write("INSERT INTO cmd VALUES (?1, ?2, ?3, ?4, ?5, ?6, 'intent', 0, ?7, 0, 0)",
               {std::int64_t{row.sequence}, std::int64_t{row.epoch}, static_cast<std::int64_t>(row.detection_id),
                std::int64_t{row.place_slot}, row.model, row.payload, row.t_intent_us});
}

core::Status SqliteJournal::update_open_row(std::int32_t sequence, std::string_view sql, const SqlRow& parameters) {
  if (auto done = write(sql, parameters); !done) return done;
  if (database_.changes() == 1) return {};
  return core::failure(ErrorCode::unreadable, name_, "pick " + std::to_string(sequence) + " is not open in the journal",
                       "connect again");
}

core::Status SqliteJournal::record_sent(std::int32_t sequence, std::int64_t t_us) {
  return update_open_row(sequence, "UPDATE cmd SET state = 'sent', t_sent = ?2 WHERE seq = ?1 AND state = 'intent'",
                         {std::int64_t{sequence}, t_us});
}

core::Status SqliteJournal::record_end(std::int32_t sequence, CommandState state, int result, std::int64_t t_us) {
  return update_open_row(
      sequence, "UPDATE cmd SET state = ?2, result = ?3, t_done = ?4 WHERE seq = ?1 AND state IN ('intent','sent')",
      {std::int64_t{sequence}, std::string(name(state)), std::int64_t{result}, t_us});
}

core::Status SqliteJournal::record_epoch(std::int32_t epoch, std::int32_t last_sequence) {
  return write("INSERT OR REPLACE INTO fence VALUES (?1, ?2)", {std::int64_t{epoch}, std::int64_t{last_sequence}});
}

core::Result<std::int32_t> SqliteJournal::number(std::string_view sql) {
  auto found = database_.execute(sql);
  if (!found) return tl::unexpected(explained(std::move(found.error())));
  return static_cast<std::int32_t>(as_integer(found->front().front()));
}

core::Result<std::int32_t> SqliteJournal::last_epoch() {
  return number("SELECT max(e) FROM (SELECT max(epoch) AS e FROM fence UNION ALL SELECT max(epoch) FROM cmd)");
}

core::Result<std::int32_t> SqliteJournal::last_sequence() {
  return number("SELECT max(s) FROM (SELECT max(last_seq) AS s FROM fence UNION ALL SELECT max(seq) FROM cmd)");
}

core::Result<std::vector<JournalRow>> SqliteJournal::rows(std::string_view where, const SqlRow& parameters) {
  auto found = database_.execute(std::string(kColumns) + std::string(where), parameters);
  if (!found) return tl::unexpected(explained(std::move(found.error())));
  std::vector<JournalRow> out;
  for (const SqlRow& row : *found) out.push_back(row_from(row));
  return out;
}

core::Result<std::vector<JournalRow>> SqliteJournal::open_rows() {
  return rows("WHERE state IN ('intent','sent') ORDER BY seq", {});
}

core::Result<std::vector<JournalRow>> SqliteJournal::newest_rows(int count) {
  return rows("ORDER BY seq DESC LIMIT ?1", {std::int64_t{count}});
}

core::Result<std::vector<FilledPlace>> SqliteJournal::filled() {
  auto found = database_.execute(
      "SELECT DISTINCT c.model, c.slot FROM cmd c WHERE c.state IN ('done','unknown','intent','sent') AND "
      "c.seq > coalesce((SELECT after_seq FROM tray t WHERE t.model = c.model), 0)");
  if (!found) return tl::unexpected(explained(std::move(found.error())));
  std::vector<FilledPlace> out;
  for (const SqlRow& row : *found) out.push_back({as_text(row[0]), static_cast<int>(as_integer(row[1]))});
  return out;
}

core::Status SqliteJournal::exchanged(const std::string& model) {
  return write("INSERT OR REPLACE INTO tray VALUES (?1, (SELECT coalesce(max(seq), 0) FROM cmd))", {model});
}

}  // namespace pickcell::cell
