#pragma once
/// The yardstick Y: how fast this machine is right now, so that times of different machines can be compared
/// (docs/interfaces.md, bench). One cv::matchTemplate(TM_CCOEFF_NORMED) of a 128x128 template in a 640x480 image on one
/// thread. OpenCV is linked for this alone, by the build option PICKCELL_WITH_YARDSTICK.

#include <memory>
#include <optional>

namespace pickcell::cli {

/// Above this the machine is busy or memory comes from fresh pages: figures in yardsticks mean nothing then.
constexpr double kSlowYardstickMs = 9;

/// Keeps freed memory in the process (1 GiB mmap threshold, no trimming, 256 MiB steps): with malloc's defaults every
/// correlation pays page faults and the yardstick is more than three times slower. Call it before anything else.
void keep_freed_memory();

/// Not thread-safe. Sets OpenCV to one thread.
class Yardstick {
 public:
  Yardstick();  ///< one warm-up run
  ~Yardstick();
  Yardstick(const Yardstick&) = delete;
  Yardstick& operator=(const Yardstick&) = delete;
  Yardstick(Yardstick&&) = delete;
  Yardstick& operator=(Yardstick&&) = delete;

  /// True when built with PICKCELL_WITH_YARDSTICK.
  [[nodiscard]] static bool available();
  /// Thread CPU time of one run, milliseconds; empty when not available.
  [[nodiscard]] std::optional<double> measure_ms();

 private:
  struct Pictures;
  std::unique_ptr<Pictures> pictures_;
};

}  // namespace pickcell::cli
