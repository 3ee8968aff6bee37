#pragma once
/// Where frames come from. One implementation per kind of camera; the simulated one lives in sim and is handed in by
/// cli.

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

class FrameSource {
 public:
  virtual ~FrameSource() = default;
  [[nodiscard]] virtual SourceInfo info() const = 0;
  /// A frame whose exposure began after this call. Waits at most timeout, on the caller's seat where the source is
  /// simulated, in wall time where it is a device. Errors: device (lost, held by another program), timeout; the end of
  /// a finite source is negative. One thread at a time.
  [[nodiscard]] virtual core::Result<Frame> grab(core::Seat& seat, core::Duration timeout) = 0;
};

}  // namespace pickcell::frames
