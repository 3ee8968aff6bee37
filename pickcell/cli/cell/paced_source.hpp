#pragma once
/// A camera that is a device, in a cell that lives on a simulated clock.

#include "pickcell/frames/frame_source.hpp"

namespace pickcell::cli {

/// A device knows nothing of simulated time and takes none of it. This source lets the time of exposure and readout
/// pass as a camera on the same clock would, so that both cells live through the same moments. The device is waited for
/// in wall time, as long as the machine needs: simulated time stands still meanwhile.
class PacedSource final : public frames::FrameSource {
 public:
  /// camera must outlive it.
  PacedSource(frames::FrameSource& camera, core::Duration exposure, core::Duration readout)
      : camera_(camera), exposure_(exposure), readout_(readout) {}

  [[nodiscard]] frames::SourceInfo info() const override { return camera_.info(); }
  [[nodiscard]] core::Status health() const override { return camera_.health(); }
  [[nodiscard]] frames::FrameCounters counters() const override { return camera_.counters(); }
  [[nodiscard]] core::Result<frames::Frame> grab(core::Seat& seat, core::Duration) override {
    seat.sleep_for(exposure_);
    auto frame = camera_.grab(seat, kPatience);
    if (frame) seat.sleep_for(readout_);
    return frame;
  }

 private:
  static constexpr core::Duration kPatience = std::chrono::seconds(30);
  frames::FrameSource& camera_;
  core::Duration exposure_, readout_;
};

}  // namespace pickcell::cli
