#pragma once
/// Opening and setting a camera through Aravis; shared by the files aravis_*.cpp alone.

#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "pickcell/core/result.hpp"
#include "pickcell/frames/aravis_locate.hpp"
#include "pickcell/frames/camera_device.hpp"
#include "pickcell/frames/camera_settings.hpp"

typedef struct _ArvCamera ArvCamera;  // NOLINT: names of Aravis
typedef struct _ArvStream ArvStream;  // NOLINT
struct _GError;

namespace pickcell::frames::aravis {

/// Drops one reference to a GObject.
struct Unref {
  void operator()(void* object) const;
};
template <class T>
using Held = std::unique_ptr<T, Unref>;

/// What a call of Aravis reports through its last argument.
class Problem {
 public:
  Problem() = default;
  ~Problem();
  Problem(const Problem&) = delete;
  Problem& operator=(const Problem&) = delete;
  /// For the call; forgets an earlier problem.
  [[nodiscard]] _GError** out();
  [[nodiscard]] explicit operator bool() const { return error_ != nullptr; }
  [[nodiscard]] std::string text() const;

 private:
  _GError* error_ = nullptr;
};

/// With control over it.
[[nodiscard]] core::Result<Held<ArvCamera>> open(const Located& located);

/// Every setting that is set, in an order that cameras accept. Errors name the setting and what the camera allows.
[[nodiscard]] core::Status apply(ArvCamera* camera, const std::string& shown, const CameraSettings& settings);

/// Receive buffer chosen (granted_socket: what the kernel gave, bytes, of GigE Vision); buffers for so many frames are
/// queued.
[[nodiscard]] core::Result<Held<ArvStream>> make_stream(ArvCamera* camera, const std::string& shown,
                                                        const CameraSettings& settings, int buffers,
                                                        std::optional<int>* granted_socket);

[[nodiscard]] DeviceInfo describe(ArvCamera* camera, const Located& located, const CameraSettings& settings,
                                  std::optional<int> granted_socket);

[[nodiscard]] std::vector<std::pair<std::string, std::string>> features(ArvCamera* camera);

}  // namespace pickcell::frames::aravis
