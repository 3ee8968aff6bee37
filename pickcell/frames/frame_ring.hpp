#pragma once
/// Frames that wait for their reader, in places made once.

#include <cstddef>
#include <utility>
#include <vector>

#include "pickcell/frames/frame.hpp"

namespace pickcell::frames {

/// First in, first out. Not thread-safe.
class FrameRing {
 public:
  /// At least one place.
  explicit FrameRing(std::size_t places) : places_(places < 1 ? 1 : places) {}

  [[nodiscard]] bool empty() const { return count_ == 0; }
  [[nodiscard]] bool full() const { return count_ == places_.size(); }
  /// Must not be full.
  void push(Frame frame) { places_[(first_ + count_++) % places_.size()] = std::move(frame); }
  /// Must not be empty.
  [[nodiscard]] Frame pop() {
    --count_;
    return std::exchange(places_[std::exchange(first_, (first_ + 1) % places_.size())], Frame{});
  }
  void clear() {
    while (!empty()) (void)pop();
  }

 private:
  std::vector<Frame> places_;
  std::size_t first_ = 0, count_ = 0;
};

}  // namespace pickcell::frames
