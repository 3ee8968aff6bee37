#include "pickcell/server/log_tail.hpp"

namespace pickcell::server {

void LogTail::add(const core::LogEntry& entry) {
  const std::lock_guard lock(mutex_);
  entries_.push_back(NumberedEntry{++last_, entry});
  if (entries_.size() > kKept) entries_.pop_front();
}

std::vector<NumberedEntry> LogTail::after(std::uint64_t number) const {
  const std::lock_guard lock(mutex_);
  std::vector<NumberedEntry> out;
  for (const NumberedEntry& e : entries_)
    if (e.number > number) out.push_back(e);
  return out;
}

std::uint64_t LogTail::last() const {
  const std::lock_guard lock(mutex_);
  return last_;
}

}  // namespace pickcell::server
