#pragma once
/// A real camera as a source of frames: a thread of its own receives, judges and counts every frame, maps the camera's
/// clock to the cell's, sees a loss within a second and reconnects by itself.

#include <chrono>
#include <condition_variable>
#include <future>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "pickcell/frames/camera_device.hpp"
#include "pickcell/frames/clock_map.hpp"
#include "pickcell/frames/frame_ring.hpp"
#include "pickcell/frames/frame_source.hpp"
#include "pickcell/frames/picture_pool.hpp"

namespace pickcell::frames {

class LiveSource final : public FrameSource {
 public:
  enum class Policy {
    newest,  ///< for the cell: grab gives a frame exposed after the call
    every    ///< for recording: grab gives all frames, one after the other, and drops none while the reader keeps up
  };
  struct Options {
    std::string camera_id;  ///< empty: the device's own
    Policy policy = Policy::newest;
    bool software_trigger = false;  ///< grab asks for an exposure; otherwise the camera runs free or by its line
    double readout_us = 0;          ///< from the end of exposure until the frame begins to leave the camera
    std::chrono::milliseconds lost_after{600};  ///< without a sign of life
    std::chrono::milliseconds late_after{500};  ///< a frame that arrives so long after the quickest ones is too old
    std::chrono::milliseconds retry_every{200};
    std::size_t queue_max = 64;  ///< of Policy::every; then the oldest is dropped and counted as late
  };

  /// Connects once; its error is the caller's. The clock must outlive the source.
  [[nodiscard]] static core::Result<std::unique_ptr<LiveSource>> open(Connect connect, Options options,
                                                                      const core::Clock& clock);
  ~LiveSource() override;

  [[nodiscard]] SourceInfo info() const override;
  /// With Policy::newest a picture whose exposure began after the call. A loss is waited out until the timeout, so that
  /// a camera that comes back in time is not an error; then the error says why it is gone.
  [[nodiscard]] core::Result<Frame> grab(core::Seat& seat, core::Duration timeout) override;
  [[nodiscard]] core::Status health() const override;
  [[nodiscard]] FrameCounters counters() const override;
  /// Of the present connection, or of the last one. Thread-safe.
  [[nodiscard]] DeviceInfo device() const;
  [[nodiscard]] double drift_ppm() const;

 private:
  using Time = std::chrono::steady_clock::time_point;
  LiveSource(Connect connect, Options options, const core::Clock& clock, std::unique_ptr<CameraDevice> device);

  void run();
  void receive(CameraDevice& device);
  void look_after(CameraDevice& device);
  void take(const Arrival& arrival);
  void hand_out(Frame frame);
  [[nodiscard]] bool wanted(core::TimePoint exposure_began) const;
  [[nodiscard]] std::optional<Frame> frame_of(const Arrival& arrival, core::TimePoint left_camera);
  [[nodiscard]] core::TimePoint arrival_time(const Arrival& arrival) const;
  void mark_lost(core::Error why);
  void bury();
  void reconnect();
  void adopt(std::shared_ptr<CameraDevice> device);
  [[nodiscard]] core::Status ask_for_exposure(std::unique_lock<std::mutex>& lock);
  [[nodiscard]] core::Error why_nothing(bool had_device) const;

  const Connect connect_;
  const Options options_;
  const core::Clock& clock_;
  PicturePool pool_;

  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::shared_ptr<CameraDevice> device_;  ///< null while there is none
  DeviceInfo device_info_;
  CameraId camera_id_;
  std::shared_ptr<const ExposureSettings> settings_;
  std::optional<core::Error> lost_;
  FrameRing ready_;
  std::optional<core::TimePoint> wanted_since_;
  std::uint64_t spoilt_ = 0;      ///< exposures that did not become a frame
  std::uint64_t connection_ = 0;  ///< counts devices
  FrameLedger ledger_;
  ClockMap map_;
  std::uint64_t resends_before_ = 0, reconnects_ = 0;
  bool quit_ = false;

  // Of the camera's thread alone.
  Time last_sign_{};
  Unpacker unpacker_;
  std::vector<std::future<void>> graves_;
  std::thread thread_;
};

}  // namespace pickcell::frames
