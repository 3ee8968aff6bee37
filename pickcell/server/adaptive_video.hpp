#pragma once
/// How much picture a client's link and browser can take: slower first, then smaller, then coarser.

#include <chrono>
#include <vector>

namespace pickcell::server {

using WallTime = std::chrono::steady_clock::time_point;
using WallDuration = std::chrono::steady_clock::duration;

/// What a client asked for.
struct VideoRequest {
  int camera = 0;
  int max_width_px = 1280;
  double max_fps = 15;
  int quality = 80;
};

/// Steps down when the 90th percentile of the acknowledgement times exceeds 200 ms, one rung at a time with a fresh
/// sample between: half the rate, 960 px, 640 px, quality 60. Recovers one rung per 10 s (docs/hmi.md, Back-pressure).
/// Pure.
class AdaptiveVideo {
 public:
  static constexpr int kRungs = 5;
  static constexpr std::size_t kSample = 10;
  static constexpr WallDuration kSlow = std::chrono::milliseconds(200);
  static constexpr WallDuration kRecovery = std::chrono::seconds(10);

  void acknowledged(WallDuration round_trip, WallTime now);
  /// The request with the present rung applied; never more than was asked for.
  [[nodiscard]] VideoRequest limit(VideoRequest asked) const;
  [[nodiscard]] int rung() const { return rung_; }

 private:
  int rung_ = 0;
  WallTime changed_{};
  std::vector<WallDuration> sample_;
};

}  // namespace pickcell::server
