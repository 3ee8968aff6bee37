#pragma once
/// Between the cell's thread and everybody who watches or steers it.

#include <array>
#include <condition_variable>
#include <functional>
#include <map>
#include <memory>
#include <mutex>

#include "pickcell/cell/cell_port.hpp"

namespace pickcell::cell {

enum class Command { start, stop, reset };

/// Thread-safe. Watchers get whole snapshots and pictures that never change; nobody who watches can hold up the cell.
class Desk {
 public:
  [[nodiscard]] Snapshot snapshot() const;
  [[nodiscard]] std::shared_ptr<const ShownFrame> frame() const;
  /// Listeners are called one after the other in the publisher's thread; after remove() has returned, never again.
  int listen(std::function<void()> listener);
  void remove(int handle);

  /// Replaces the snapshot, counts its revision up, tells the listeners.
  void publish(Snapshot snapshot);
  void publish(std::shared_ptr<const ShownFrame> frame);

  void ask(Command command);
  /// True once for every asking; asking twice before that is one.
  bool take(Command command);
  [[nodiscard]] bool asked(Command command) const;

  /// Returns when the condition holds for a published snapshot.
  void wait_until(const std::function<bool(const Snapshot&)>& condition) const;

 private:
  void tell();

  mutable std::mutex mutex_;
  mutable std::condition_variable published_;
  Snapshot snapshot_;
  std::shared_ptr<const ShownFrame> frame_;
  std::array<bool, 3> asked_{};

  std::mutex listeners_mutex_;
  std::map<int, std::function<void()>> listeners_;
  int next_handle_ = 1;
};

}  // namespace pickcell::cell
