#pragma once
/// The rows of what asks for a person: one per code, counted.

#include <cstdint>
#include <string>
#include <vector>

#include "pickcell/cell/cell_port.hpp"

namespace pickcell::cell {

/// Keeps every active row and the newest inactive ones. One thread at a time.
class AlarmList {
 public:
  static constexpr std::size_t kMaxRows = 100;

  /// A new row, or the row of this code again: active, counted once more unless it was active already, with its newest
  /// words.
  void raise(std::string code, int priority, std::string text, std::string cause, std::vector<std::string> remedies,
             std::int64_t unix_us);
  /// Ends the active row of this code; nothing when there is none.
  void clear(const std::string& code, std::int64_t unix_us);
  void clear_all(std::int64_t unix_us);
  /// Active ones first, then by priority, then newest first.
  [[nodiscard]] std::vector<CellAlarm> rows() const;

 private:
  std::vector<CellAlarm> rows_;
};

}  // namespace pickcell::cell
