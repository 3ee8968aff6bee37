#include "pickcell/server/adaptive_video.hpp"

#include <algorithm>

namespace pickcell::server {

void AdaptiveVideo::acknowledged(WallDuration round_trip, WallTime now) {
  if (changed_ == WallTime{}) changed_ = now;
  sample_.push_back(round_trip);
  if (sample_.size() < kSample) return;
  const auto p90 = sample_.begin() + static_cast<std::ptrdiff_t>(kSample * 9 / 10) - 1;  // nearest rank
  std::nth_element(sample_.begin(), p90, sample_.end());
  const bool slow = *p90 > kSlow;
  sample_.clear();
  if (slow && rung_ + 1 < kRungs) {
    ++rung_;
    changed_ = now;
  } else if (!slow && rung_ > 0 && now - changed_ >= kRecovery) {
    --rung_;
    changed_ = now;
  }
}

VideoRequest AdaptiveVideo::limit(VideoRequest asked) const {
  if (rung_ >= 1) asked.max_fps /= 2;
  if (rung_ >= 2) asked.max_width_px = std::min(asked.max_width_px, 960);
  if (rung_ >= 3) asked.max_width_px = std::min(asked.max_width_px, 640);
  if (rung_ >= 4) asked.quality = std::min(asked.quality, 60);
  return asked;
}

}  // namespace pickcell::server
