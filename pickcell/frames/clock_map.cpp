#include "pickcell/frames/clock_map.hpp"

#include <algorithm>
#include <cmath>

namespace pickcell::frames {

namespace {

constexpr std::int64_t kSecond = 1'000'000'000;
constexpr std::size_t kSeconds = 30;    ///< of history
constexpr std::size_t kForDrift = 5;    ///< seconds before a slope is worth anything
constexpr double kMostDrift = 1000e-6;  ///< no crystal is that bad: then it is no drift

}  // namespace

ClockMap::ClockMap() {
  minima_.reserve(kSeconds + 1);
  slopes_.reserve(kSeconds * (kSeconds - 1) / 2);
}

void ClockMap::reset() {
  minima_.clear();
  bin_begin_ns_ = last_device_ns_ = reference_ns_ = 0;
  slope_ = offset_ns_ = 0;
}

bool ClockMap::is_new_start(std::int64_t device_ns, std::int64_t delta_ns) const {
  if (device_ns < last_device_ns_) return true;
  const double expected = offset_ns_ + slope_ * static_cast<double>(device_ns - reference_ns_);
  // Early by a second is impossible on the old line; late by so much is a jump of the camera's clock, or a line that
  // has aged beyond use.
  return std::abs(static_cast<double>(delta_ns) - expected) > static_cast<double>(kSecond);
}

void ClockMap::observe(std::int64_t device_ns, core::TimePoint arrived) {
  const std::int64_t delta_ns = arrived.time_since_epoch().count() - device_ns;
  if (known() && is_new_start(device_ns, delta_ns)) reset();
  last_device_ns_ = device_ns;
  if (minima_.empty() || device_ns - bin_begin_ns_ >= kSecond) {
    bin_begin_ns_ = device_ns;
    minima_.push_back({device_ns, delta_ns});
    if (minima_.size() > kSeconds) minima_.erase(minima_.begin());
  } else if (delta_ns < minima_.back().delta_ns) {
    minima_.back() = {device_ns, delta_ns};
  } else {
    return;
  }
  fit();
}

void ClockMap::fit() {
  reference_ns_ = minima_.front().device_ns;
  const std::int64_t base_ns = minima_.front().delta_ns;
  slope_ = 0;
  if (minima_.size() >= kForDrift) {
    // Median of the slopes of all pairs (Theil and Sen): a second in which everything was slow does not turn the line.
    slopes_.clear();
    for (std::size_t i = 0; i < minima_.size(); ++i)
      for (std::size_t j = i + 1; j < minima_.size(); ++j)
        slopes_.push_back(static_cast<double>(minima_[j].delta_ns - minima_[i].delta_ns) /
                          static_cast<double>(minima_[j].device_ns - minima_[i].device_ns));
    const auto middle = slopes_.begin() + static_cast<std::ptrdiff_t>(slopes_.size() / 2);
    std::nth_element(slopes_.begin(), middle, slopes_.end());
    if (std::abs(*middle) < kMostDrift) slope_ = *middle;
  }
  double least = 0;
  bool first = true;
  for (const Minimum& m : minima_) {
    const double above =
        static_cast<double>(m.delta_ns - base_ns) - slope_ * static_cast<double>(m.device_ns - reference_ns_);
    if (first || above < least) least = above;
    first = false;
  }
  offset_ns_ = static_cast<double>(base_ns) + least;
}

core::TimePoint ClockMap::at(std::int64_t device_ns) const {
  if (!known()) return core::TimePoint{};
  // Large stamps lose nanoseconds in a double: only differences go through it.
  const std::int64_t base_ns = minima_.front().delta_ns;
  const double rest =
      (offset_ns_ - static_cast<double>(base_ns)) + slope_ * static_cast<double>(device_ns - reference_ns_);
  return core::TimePoint(core::Duration(device_ns + base_ns + std::llround(rest)));
}

}  // namespace pickcell::frames
