#pragma once
/// Every exposure of a camera accounted for by the number that the camera gave it.

#include <cstdint>
#include <optional>

#include "pickcell/frames/frame_source.hpp"

namespace pickcell::frames {

/// What the transport says of a frame's pixels.
enum class Wholeness { whole, incomplete, torn };
/// What is to be done with it.
enum class Verdict { good, incomplete, torn, repeated, late };

/// Not thread-safe.
class FrameLedger {
 public:
  /// Judges and counts one arrival. id: the camera's number; GigE Vision's is 16 bits without 0 unless the device has
  /// extended ids (then it passes 65535), others count on. stamp_ns: the camera's time stamp, 0 for none; the same
  /// twice is the same exposure twice.
  Verdict enter(std::uint64_t id, std::int64_t stamp_ns, Wholeness wholeness);
  /// An incomplete arrival whose number is unknown: it stands for one of the gap that the next one leaves.
  Verdict enter_unnumbered();
  /// A frame that was good but arrived too long after its exposure.
  void too_old();
  /// A frame that was good but whose bytes are no picture.
  void not_a_picture();
  /// The camera starts anew: numbers begin again.
  void restart();

  /// Of the last exposure entered, counted from 1 across restarts, with gaps where frames are missing.
  [[nodiscard]] std::uint64_t sequence() const { return sequence_; }
  [[nodiscard]] const FrameCounters& counters() const { return counters_; }

 private:
  /// Exposures from the last to this one; 0 the same, negative: earlier. Unset: no relation, the camera began anew.
  [[nodiscard]] std::optional<std::int64_t> steps_to(std::uint64_t id) const;

  FrameCounters counters_;
  std::optional<std::uint64_t> last_id_;
  std::int64_t last_stamp_ns_ = 0;
  std::uint64_t unnumbered_ = 0;  ///< since the last numbered one
  bool wide_ = false;             ///< ids beyond 16 bits were seen
  std::uint64_t sequence_ = 0;
};

}  // namespace pickcell::frames
