#include "pickcell/frames/frame_ledger.hpp"

#include <algorithm>

namespace pickcell::frames {

namespace {

constexpr std::uint64_t kSixteen = 0xffff;   ///< largest 16-bit id; also how many there are, as 0 is none
constexpr std::int64_t kFarBack = 1000;      ///< further back than any network keeps a frame
constexpr std::int64_t kFarAhead = 1 << 20;  ///< more than any outage loses

}  // namespace

std::optional<std::int64_t> FrameLedger::steps_to(std::uint64_t id) const {
  const std::uint64_t last = *last_id_;
  std::int64_t steps = 0;
  if (!wide_ && id <= kSixteen && last <= kSixteen) {
    // A ring of 65535: what is more than half a turn ahead lies behind.
    const auto ahead = static_cast<std::int64_t>((id + kSixteen - last) % kSixteen);
    steps = ahead > static_cast<std::int64_t>(kSixteen / 2) ? ahead - static_cast<std::int64_t>(kSixteen) : ahead;
  } else {
    steps = static_cast<std::int64_t>(id - last);
  }
  if (steps < -kFarBack || steps > kFarAhead) return std::nullopt;
  return steps;
}

Verdict FrameLedger::enter(std::uint64_t id, std::int64_t stamp_ns, Wholeness wholeness) {
  wide_ = wide_ || id > kSixteen;
  const auto steps = last_id_ ? steps_to(id) : std::nullopt;
  const bool same_stamp = stamp_ns != 0 && stamp_ns == last_stamp_ns_ && wholeness == Wholeness::whole;
  if (steps && (*steps == 0 || (same_stamp && *steps == 1))) {
    if (*steps == 1) last_id_ = id, ++sequence_;
    ++counters_.repeated;
    return Verdict::repeated;
  }
  if (steps && *steps < 0) {
    // It was counted as missing when it was overtaken.
    if (counters_.missing > 0) --counters_.missing;
    ++counters_.late;
    return Verdict::late;
  }
  if (steps) {
    const auto gap = static_cast<std::uint64_t>(*steps - 1);
    counters_.missing += gap - std::min(gap, unnumbered_);
    sequence_ += static_cast<std::uint64_t>(*steps);
  } else {
    ++sequence_;
  }
  last_id_ = id;
  unnumbered_ = 0;
  if (wholeness != Wholeness::incomplete) last_stamp_ns_ = stamp_ns;
  switch (wholeness) {
    case Wholeness::whole:
      ++counters_.frames;
      return Verdict::good;
    case Wholeness::incomplete:
      ++counters_.incomplete;
      return Verdict::incomplete;
    case Wholeness::torn:
      ++counters_.torn;
      return Verdict::torn;
  }
  return Verdict::torn;
}

Verdict FrameLedger::enter_unnumbered() {
  ++unnumbered_;
  ++counters_.incomplete;
  return Verdict::incomplete;
}

void FrameLedger::too_old() {
  --counters_.frames;
  ++counters_.late;
}

void FrameLedger::not_a_picture() {
  --counters_.frames;
  ++counters_.torn;
}

void FrameLedger::restart() {
  last_id_.reset();
  last_stamp_ns_ = 0;
  unnumbered_ = 0;
  wide_ = false;
}

}  // namespace pickcell::frames
