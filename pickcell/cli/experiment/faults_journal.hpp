#pragma once
/// A journal whose process can be made to end at any of its commits.

#include <functional>
#include <utility>

#include "pickcell/robot/journal.hpp"

namespace pickcell::cli {

/// Passes everything on. At the chosen commit it calls the hook right before or right after it. When the hook says that
/// the process ended, neither this commit (before) nor any later one reaches the disk, and whoever commits is told so:
/// the driver then sends nothing more.
class MortalJournal final : public robot::Journal {
 public:
  explicit MortalJournal(robot::Journal& journal) : journal_(journal) {}

  /// countdown: 1 = the next commit. hook: true when the process ends.
  void at_commit(int countdown, bool before, std::function<bool()> hook) {
    countdown_ = countdown;
    before_ = before;
    hook_ = std::move(hook);
  }
  void forget() { countdown_ = 0; }
  [[nodiscard]] bool dead() const { return dead_; }

  [[nodiscard]] core::Status record_intent(const robot::JournalRow& row) override {
    return commit([&] { return journal_.record_intent(row); });
  }
  [[nodiscard]] core::Status record_sent(std::int32_t sequence, std::int64_t t_us) override {
    return commit([&] { return journal_.record_sent(sequence, t_us); });
  }
  [[nodiscard]] core::Status record_end(std::int32_t sequence, robot::CommandState state, int result,
                                        std::int64_t t_us) override {
    return commit([&] { return journal_.record_end(sequence, state, result, t_us); });
  }
  [[nodiscard]] core::Status record_epoch(std::int32_t epoch, std::int32_t last_sequence) override {
    return commit([&] { return journal_.record_epoch(epoch, last_sequence); });
  }
  [[nodiscard]] core::Result<std::int32_t> last_epoch() override { return journal_.last_epoch(); }
  [[nodiscard]] core::Result<std::int32_t> last_sequence() override { return journal_.last_sequence(); }
  [[nodiscard]] core::Result<std::vector<robot::JournalRow>> open_rows() override { return journal_.open_rows(); }

 private:
  template <class Commit>
  core::Status commit(Commit write) {
    const bool now = !dead_ && countdown_ > 0 && --countdown_ == 0;
    if (now && before_) dead_ = std::exchange(hook_, nullptr)();
    if (dead_) return ended();
    auto written = write();
    if (now && !before_) dead_ = std::exchange(hook_, nullptr)();
    return dead_ ? ended() : written;
  }
  static core::Status ended() {
    return core::failure(core::ErrorCode::unreadable, "journal", "the process has ended", "start it again");
  }

  robot::Journal& journal_;
  int countdown_ = 0;
  bool before_ = false, dead_ = false;
  std::function<bool()> hook_;
};

}  // namespace pickcell::cli
