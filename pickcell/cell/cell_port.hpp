#pragma once
/// The door through which the HMI and the command line see and steer the cell. Everything here may be called from any
/// thread and returns at once.

#include <array>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "pickcell/core/result.hpp"
#include "pickcell/frames/frame.hpp"

namespace pickcell::cell {

enum class Mode { idle, running, stopping, fault };
[[nodiscard]] const char* name(Mode mode);

enum class DetectionState { found, queued, picking, placed, missed, unknown, rejected };
[[nodiscard]] const char* name(DetectionState state);

/// One part in the shown picture; sensor pixels, degrees.
struct Detection {
  std::uint64_t id = 0;
  std::string part;
  double x_px = 0, y_px = 0, angle_deg = 0, scale = 1;
  double w_px = 0, h_px = 0;          ///< of the template, at scale 1
  double ref_x_px = 0, ref_y_px = 0;  ///< the reference point in the template
  double score = 0;
  DetectionState state = DetectionState::found;
  std::string code;                              ///< of a rejection when it was seen: "score", "clearance", ...
  std::string why;                               ///< reason of a rejection, in words
  std::vector<std::array<double, 2>> grasps_px;  ///< grasp points in the picture
};

/// A picture with what was found in it; never changed after it is published, except that a newer version with the same
/// frame sequence may replace it when detections change state.
struct ShownFrame {
  frames::Frame frame;
  std::vector<Detection> detections;
  double grab_ms = 0;
  double match_ms = 0;
  std::string recipe;
};

/// Something that asks for a person.
struct CellAlarm {
  std::string code;  ///< "ROBOT_ALARM", "LINK_LOST", ...
  int priority = 2;  ///< 1 high .. 3 low
  std::string text;
  std::string cause;
  std::vector<std::string> remedies;
  std::int64_t first_unix_us = 0, last_unix_us = 0;
  int count = 1;
  bool active = true;
};

struct Counters {
  std::int64_t frames = 0, found = 0, submitted = 0, placed = 0, missed = 0, unknown = 0;
  std::map<std::string, std::int64_t> rejected;  ///< by reason
  double picks_per_min = 0;
  double match_ms_median = 0, match_ms_p95 = 0;
};

struct RobotView {
  bool connected = false;
  std::string link;   ///< "tcp80://127.0.0.1:8000"
  std::string words;  ///< "play, remote, servo on, running"
  bool running = false, servo = false, remote = false, held = false, alarm = false, teach = false;
  std::array<double, 3> tool_mm{};
};

struct CameraView {
  bool connected = true;
  std::string id;
  std::string why;                             ///< no picture can come, in words; "" while connected
  std::string remedy;                          ///< what to do about it
  std::map<std::string, std::int64_t> losses;  ///< frames that were not used, by cause; causes without any are absent
  std::int64_t reconnects = 0;
  bool operator==(const CameraView&) const = default;
};

struct Snapshot {
  std::uint64_t revision = 0;  ///< grows with every change
  std::string cell_name;
  Mode mode = Mode::idle;
  std::string step;         ///< what it is doing: "looking", "waiting for the arm", ...
  std::string reason_code;  ///< why it stopped or faulted: "LINK_LOST", "REFUSED_IN_ROW", ...; empty while it works
  std::string reason;       ///< the same in words
  std::string remedy;
  std::string start_hindrance;  ///< why Start would be refused because of arm or camera, "" when it would not
  std::string start_remedy;
  RobotView robot;
  CameraView camera;
  Counters counters;
  std::vector<CellAlarm> alarms;
  std::string recipe;
  bool simulated = false;
};

class CellPort {
 public:
  virtual ~CellPort() = default;
  [[nodiscard]] virtual Snapshot snapshot() const = 0;
  /// The newest picture with its detections; null before the first.
  [[nodiscard]] virtual std::shared_ptr<const ShownFrame> latest_frame() const = 0;
  /// Begins picking; refused in words when the cell is not ready.
  [[nodiscard]] virtual core::Status start() = 0;
  /// Finishes the pick in flight, then stands.
  [[nodiscard]] virtual core::Status stop_cycle() = 0;
  /// After a fault: clears what can be cleared, reconnects, settles open picks; then idle.
  [[nodiscard]] virtual core::Status reset() = 0;
  /// Called (from any thread, briefly) after every change of snapshot or frame. Returns a handle.
  virtual int on_change(std::function<void()> listener) = 0;
  virtual void remove_listener(int handle) = 0;
};

}  // namespace pickcell::cell
