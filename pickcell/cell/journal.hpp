#pragma once
/// The hand-over journal on disk: STATE_DIR/journal.db, one per cell and controller, never per run
/// (docs/interfaces.md; docs/belt.md section 10).

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "pickcell/cell/database.hpp"
#include "pickcell/cell/tray.hpp"
#include "pickcell/robot/journal.hpp"

namespace pickcell::cell {

/// What a call has returned from is on the disk, even after a power cut. The file is held for this process alone. One
/// thread at a time. Errors: unreadable (disk full, damaged, in use by another process, of another version), with a
/// remedy that never loses the past by accident.
class SqliteJournal final : public robot::Journal, public TrayRecord {
 public:
  /// Opens or makes the file; makes its folder.
  [[nodiscard]] static core::Result<std::unique_ptr<SqliteJournal>> open(const std::filesystem::path& path);

  [[nodiscard]] core::Status record_intent(const robot::JournalRow& row) override;
  [[nodiscard]] core::Status record_sent(std::int32_t sequence, std::int64_t t_us) override;
  [[nodiscard]] core::Status record_end(std::int32_t sequence, robot::CommandState state, int result,
                                        std::int64_t t_us) override;
  [[nodiscard]] core::Status record_epoch(std::int32_t epoch, std::int32_t last_sequence) override;
  [[nodiscard]] core::Result<std::int32_t> last_epoch() override;
  [[nodiscard]] core::Result<std::int32_t> last_sequence() override;
  [[nodiscard]] core::Result<std::vector<robot::JournalRow>> open_rows() override;
  [[nodiscard]] core::Result<std::vector<FilledPlace>> filled() override;
  [[nodiscard]] core::Status exchanged(const std::string& model) override;

  /// The newest rows, newest first: for a person who wants to know what happened.
  [[nodiscard]] core::Result<std::vector<robot::JournalRow>> newest_rows(int count);

 private:
  SqliteJournal(Database database, std::string name) : database_(std::move(database)), name_(std::move(name)) {}
  [[nodiscard]] core::Status write(std::string_view sql, const SqlRow& parameters);
  [[nodiscard]] core::Status update_open_row(std::int32_t sequence, std::string_view sql, const SqlRow& parameters);
  [[nodiscard]] core::Result<std::int32_t> number(std::string_view sql);
  [[nodiscard]] core::Result<std::vector<robot::JournalRow>> rows(std::string_view where, const SqlRow& parameters);

  Database database_;
  std::string name_;
};

}  // namespace pickcell::cell
