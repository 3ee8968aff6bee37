#pragma once
/// The simulated camera: a frame source that looks at the world.

#include <cstdint>
#include <deque>
#include <memory>
#include <mutex>
#include <optional>
#include <vector>

#include "pickcell/frames/frame_source.hpp"
#include "pickcell/sim/camera_model.hpp"
#include "pickcell/sim/perspective.hpp"
#include "pickcell/sim/world.hpp"

namespace pickcell::sim {

struct CameraSettings {
  std::string camera_id = "sim-camera";
  Intrinsics intrinsics;
  core::Transform<core::Base, core::Camera> T_base_camera;
  Surface surface = Surface::belt;
  Light light{.from_deg = 130, .strength = 0.1};
  SensorSettings sensor;
  double psf_sigma_px = 0.45;  ///< blur of the lens
  double exposure_us = 4000;
  double readout_us = 16000;
  double counts_per_mm = 10;  ///< belt encoder
  std::uint64_t seed = 1;
};

/// 1280x1024 over a field of about 400 mm from 0.8 m, lens distortion of 1 % in the corners, inclined by 1.4 degrees
/// and turned by 2.
[[nodiscard]] CameraSettings default_camera(const core::Transform<core::Base, core::Plane>& T_base_plane,
                                            std::uint64_t seed);

/// The same camera with another sensor over the same field in x; in y as much as its height shows, centred.
[[nodiscard]] CameraSettings resized(CameraSettings camera, int width_px, int height_px);

/// Where a part truly was in a frame, at mid-exposure.
struct SeenPart {
  PartTruth truth;
  double x_px = 0;  ///< of the part's origin
  double y_px = 0;
  double angle_deg = 0;   ///< of the part's x axis there, counter-clockwise on the screen
  bool complete = false;  ///< the whole top face lies in the picture
};

/// Deterministic for seed, world and times. grab by one thread at a time; truth and settings by any.
class SimulatedCamera final : public frames::FrameSource {
 public:
  /// World and clock must outlive it.
  SimulatedCamera(CameraSettings settings, World& world, const core::Clock& clock);

  [[nodiscard]] frames::SourceInfo info() const override;
  /// Exposes from now on: sleeps to mid-exposure, takes the picture, sleeps until it is read out. A belt that moves
  /// smears it.
  [[nodiscard]] core::Result<frames::Frame> grab(core::Seat& seat, core::Duration timeout) override;

  /// Without waiting: the exposure that begins at `begin`, with another time of exposure than the settings' where one
  /// is given (the picture is brighter for it) and with gain_db on top. For a camera that is served to others.
  [[nodiscard]] frames::Frame expose_at(core::TimePoint begin, std::optional<double> exposure_us = {},
                                        double gain_db = 0);

  /// Of one of the last 1000 frames; empty for others.
  [[nodiscard]] std::vector<SeenPart> truth(std::uint64_t sequence) const;
  [[nodiscard]] const CameraSettings& settings() const { return settings_; }

 private:
  [[nodiscard]] LightPlane smear(core::TimePoint begin, core::TimePoint end);
  [[nodiscard]] LightPlane render(core::TimePoint t);
  void remember(std::uint64_t sequence, core::TimePoint t);

  const CameraSettings settings_;
  World& world_;
  const core::Clock& clock_;
  Perspective perspective_;
  std::uint64_t sequence_ = 0;
  mutable std::mutex mutex_;
  std::deque<std::pair<std::uint64_t, std::vector<SeenPart>>> seen_;
};

}  // namespace pickcell::sim
