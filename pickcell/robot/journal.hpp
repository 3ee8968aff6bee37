#pragma once
/// The record that makes a hand-over happen at most once (docs/belt.md section 10): an intent is durable before the
/// first byte of a pick is sent. The SQLite implementation lives in cell; the rules that use it live in hand_over.

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "pickcell/core/result.hpp"

namespace pickcell::robot {

enum class CommandState { intent, sent, done, refused, void_, unknown };
[[nodiscard]] const char* name(CommandState state);

struct JournalRow {
  std::int32_t sequence = 0;
  std::int32_t epoch = 0;
  std::uint64_t detection_id = 0;
  int place_slot = 0;
  std::string model;
  std::string payload;  ///< the poses as sent, for people
  CommandState state = CommandState::intent;
  int result = 0;  ///< B013 / B011 of the controller
  std::int64_t t_intent_us = 0, t_sent_us = 0, t_done_us = 0;
};

/// Durable when a call returns. One thread at a time. Errors: unreadable (disk full, damaged file).
class Journal {
 public:
  virtual ~Journal() = default;
  [[nodiscard]] virtual core::Status record_intent(const JournalRow& row) = 0;
  [[nodiscard]] virtual core::Status record_sent(std::int32_t sequence, std::int64_t t_us) = 0;
  [[nodiscard]] virtual core::Status record_end(std::int32_t sequence, CommandState state, int result,
                                                std::int64_t t_us) = 0;
  /// The fence is about to be raised; last_sequence: the highest number that journal or controller know of.
  [[nodiscard]] virtual core::Status record_epoch(std::int32_t epoch, std::int32_t last_sequence) = 0;
  /// Highest epoch and sequence ever recorded; 0 when nothing was. A controller that has accepted more than
  /// last_sequence has another past than this journal: a person must say whether to go on.
  [[nodiscard]] virtual core::Result<std::int32_t> last_epoch() = 0;
  [[nodiscard]] virtual core::Result<std::int32_t> last_sequence() = 0;
  /// Rows in state intent or sent.
  [[nodiscard]] virtual core::Result<std::vector<JournalRow>> open_rows() = 0;
};

}  // namespace pickcell::robot
