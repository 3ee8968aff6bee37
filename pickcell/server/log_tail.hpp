#pragma once
/// The last log lines, numbered, for pages that come and go.

#include <cstdint>
#include <deque>
#include <mutex>
#include <vector>

#include "pickcell/core/log.hpp"

namespace pickcell::server {

struct NumberedEntry {
  std::uint64_t number = 0;  ///< from 1, without gaps
  core::LogEntry entry;
};

/// Keeps the last 200 entries. Thread-safe; add() is short enough for a log sink.
class LogTail {
 public:
  static constexpr std::size_t kKept = 200;
  void add(const core::LogEntry& entry);
  /// Entries with a number above this one, oldest first; older ones than kept are gone.
  [[nodiscard]] std::vector<NumberedEntry> after(std::uint64_t number) const;
  [[nodiscard]] std::uint64_t last() const;

 private:
  mutable std::mutex mutex_;
  std::deque<NumberedEntry> entries_;
  std::uint64_t last_ = 0;
};

}  // namespace pickcell::server
