#pragma once
/// One connection to one real camera, from open to loss. What is the same for all cameras (accounting, clocks, coming
/// back after a loss) is LiveSource's.

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "pickcell/core/result.hpp"
#include "pickcell/frames/frame.hpp"
#include "pickcell/frames/frame_ledger.hpp"
#include "pickcell/frames/unpack.hpp"

namespace pickcell::frames {

struct DeviceInfo {
  std::string id;        ///< what names this one camera among all: "Aravis-Fake-GV01"
  std::string protocol;  ///< "GigE Vision", "USB3 Vision", "V4L2"
  std::string address;   ///< where it was found
  int width_px = 0;
  int height_px = 0;
  ExposureSettings settings;
  /// Further facts for people, in order: name and value.
  std::vector<std::pair<std::string, std::string>> facts;
};

/// One frame as it arrived, whole or not.
struct Arrival {
  RawPicture picture;  ///< valid until the next call of next()
  Wholeness wholeness = Wholeness::whole;
  bool numbered = true;                           ///< false: the part that carries the number is among what was lost
  std::uint64_t id = 0;                           ///< the camera's number of the exposure
  std::int64_t device_ns = 0;                     ///< the camera's time stamp; 0: none
  std::chrono::steady_clock::time_point began{};  ///< when its first bytes were here
  int offset_x_px = 0, offset_y_px = 0;
  std::optional<double> exposure_us, gain;  ///< where each frame tells its own
  std::optional<std::int64_t> encoder;
};

/// next() and check() by one thread, trigger() and resends() by any beside it. Waits are in wall time. The destructor
/// may wait seconds for a camera that is gone.
class CameraDevice {
 public:
  virtual ~CameraDevice() = default;
  [[nodiscard]] virtual const DeviceInfo& info() const = 0;
  /// The next frame in the order of arrival; empty when none came in time. An error means that the camera is gone.
  [[nodiscard]] virtual core::Result<std::optional<Arrival>> next(std::chrono::milliseconds timeout) = 0;
  /// Asks for one exposure (software trigger).
  [[nodiscard]] virtual core::Status trigger() = 0;
  /// Is it still there and ours? Waits at most 0.15 s. timeout: no answer this time; device: gone for good.
  [[nodiscard]] virtual core::Status check() = 0;
  /// Packets asked for again since it was opened.
  [[nodiscard]] virtual std::uint64_t resends() const { return 0; }
};

/// Connects anew, settings and all; gives up after a few seconds at most.
using Connect = std::function<core::Result<std::unique_ptr<CameraDevice>>()>;

}  // namespace pickcell::frames
