#pragma once
/// From a camera's own clock to the cell's: offset and drift, estimated from what arrives.
///
/// A frame arrives some time after the moment its stamp stands for, never before. Over a few seconds the quickest
/// arrivals lie on a line: its slope is the drift between the clocks, its height the offset plus the least delay.
/// Frames that were held up lie above it and change nothing.

#include <cstddef>
#include <cstdint>
#include <vector>

#include "pickcell/core/clock.hpp"

namespace pickcell::frames {

/// Not thread-safe. Allocates at construction only.
class ClockMap {
 public:
  ClockMap();
  /// One frame: the camera's stamp and when it began to arrive on the cell's clock. A stamp that goes back, or leaves
  /// the line by more than a second, means that the camera started anew: everything before is forgotten.
  void observe(std::int64_t device_ns, core::TimePoint arrived);

  /// When a frame with that stamp left the camera, at least delay. Never later than `arrived` of an observed frame.
  /// Zero time before the first observation.
  [[nodiscard]] core::TimePoint at(std::int64_t device_ns) const;
  /// How much faster the cell's clock runs than the camera's; 0 until seconds have been seen.
  [[nodiscard]] double drift_ppm() const { return slope_ * 1e6; }
  [[nodiscard]] bool known() const { return !minima_.empty(); }
  void reset();

 private:
  /// The quickest arrival of one second.
  struct Minimum {
    std::int64_t device_ns;
    std::int64_t delta_ns;  ///< arrival minus stamp
  };
  [[nodiscard]] bool is_new_start(std::int64_t device_ns, std::int64_t delta_ns) const;
  void fit();

  std::vector<Minimum> minima_;  ///< oldest first
  std::vector<double> slopes_;   ///< of fit()
  std::int64_t bin_begin_ns_ = 0;
  std::int64_t last_device_ns_ = 0;
  double slope_ = 0;
  std::int64_t reference_ns_ = 0;
  double offset_ns_ = 0;  ///< at reference_ns_
};

}  // namespace pickcell::frames
