#pragma once
/// The median of many small numbers without sorting them.

#include <algorithm>
#include <array>
#include <cstddef>

namespace pickcell::matches {

/// Counts numbers >= 0 in kBins bins of 1 / per_unit; larger ones fall into the last. No heap.
template <int kBins>
class HistogramMedian {
 public:
  explicit HistogramMedian(float per_unit) : per_unit_(per_unit) {}

  void add(float value) {
    ++bins_[static_cast<std::size_t>(std::min(kBins - 1.f, per_unit_ * value))];
    ++count_;
  }

  [[nodiscard]] int count() const { return count_; }

  /// Exact to a bin, within it by straight line; 0 of nothing.
  [[nodiscard]] float median() const {
    int below = 0;
    std::size_t bin = 0;
    while (bin + 1 < kBins && 2 * (below + bins_[bin]) < count_) below += bins_[bin++];
    const auto here = static_cast<float>(std::max(1, bins_[bin]));
    const float into = 0.5f * static_cast<float>(count_) - static_cast<float>(below);
    return (static_cast<float>(bin) + into / here) / per_unit_;
  }

 private:
  std::array<int, kBins> bins_{};
  int count_ = 0;
  float per_unit_;
};

}  // namespace pickcell::matches
