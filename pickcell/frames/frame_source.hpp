#pragma once
/// Where frames come from. One implementation per kind of camera; the simulated one lives in sim and is handed in by
/// cli.

#include <cstdint>
#include <string>

#include "pickcell/core/clock.hpp"
#include "pickcell/core/result.hpp"
#include "pickcell/frames/frame.hpp"

namespace pickcell::frames {

struct SourceInfo {
  std::string camera_id;
  int width_px = 0;
  int height_px = 0;
  bool simulated = false;
};

/// What became of every exposure that the source knows of. Only `frames` were ever handed out or could have been.
struct FrameCounters {
  std::uint64_t frames = 0;      ///< whole and in time
  std::uint64_t incomplete = 0;  ///< a part of the pixels never arrived
  std::uint64_t torn = 0;        ///< all arrived, but size or format is not what was announced
  std::uint64_t missing = 0;     ///< gaps in the camera's numbers: nothing arrived at all
  std::uint64_t repeated = 0;    ///< the same exposure a second time
  std::uint64_t late = 0;        ///< whole, but overtaken by a newer one or too old on arrival
  std::uint64_t resends = 0;     ///< packets that were asked for again
  std::uint64_t reconnects = 0;  ///< times the camera came back after a loss
};

class FrameSource {
 public:
  virtual ~FrameSource() = default;
  [[nodiscard]] virtual SourceInfo info() const = 0;
  /// A frame whose exposure began after this call. Waits at most timeout, on the caller's seat where the source is
  /// simulated, in wall time where it is a device. Errors: device (lost, held by another program), timeout; the end of
  /// a finite source is negative. One thread at a time.
  [[nodiscard]] virtual core::Result<Frame> grab(core::Seat& seat, core::Duration timeout) = 0;
  /// Why no frame can come right now, as an error of kind device; ok while the source lives. Thread-safe.
  [[nodiscard]] virtual core::Status health() const { return {}; }
  /// Since the source was opened. Thread-safe.
  [[nodiscard]] virtual FrameCounters counters() const { return {}; }
};

}  // namespace pickcell::frames
