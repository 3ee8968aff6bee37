#include "pickcell/cell/alarm_list.hpp"

#include <algorithm>
#include <tuple>
#include <utility>

namespace pickcell::cell {

void AlarmList::raise(std::string code, int priority, std::string text, std::string cause,
                      std::vector<std::string> remedies, std::int64_t unix_us) {
  auto row = std::find_if(rows_.begin(), rows_.end(), [&](const CellAlarm& a) { return a.code == code; });
  if (row == rows_.end()) {
    if (rows_.size() == kMaxRows) {
      const auto oldest = std::min_element(rows_.begin(), rows_.end(), [](const CellAlarm& a, const CellAlarm& b) {
        return std::tie(a.active, a.last_unix_us) < std::tie(b.active, b.last_unix_us);
      });
      rows_.erase(oldest);
    }
    rows_.push_back({});
    row = std::prev(rows_.end());
    row->code = std::move(code);
    row->first_unix_us = unix_us;
  } else if (!row->active) {
    ++row->count;
  }
  row->priority = priority;
  row->text = std::move(text);
  row->cause = std::move(cause);
  row->remedies = std::move(remedies);
  row->last_unix_us = unix_us;
  row->active = true;
}

void AlarmList::clear(const std::string& code, std::int64_t unix_us) {
  for (CellAlarm& row : rows_)
    if (row.active && row.code == code) {
      row.active = false;
      row.last_unix_us = unix_us;
    }
}

void AlarmList::clear_all(std::int64_t unix_us) {
  for (CellAlarm& row : rows_)
    if (row.active) {
      row.active = false;
      row.last_unix_us = unix_us;
    }
}

std::vector<CellAlarm> AlarmList::rows() const {
  std::vector<CellAlarm> sorted = rows_;
  std::stable_sort(sorted.begin(), sorted.end(), [](const CellAlarm& a, const CellAlarm& b) {
    return std::tuple(!a.active, a.priority, -a.last_unix_us) < std::tuple(!b.active, b.priority, -b.last_unix_us);
  });
  return sorted;
}

}  // namespace pickcell::cell
