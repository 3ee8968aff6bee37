#pragma once
/// The camera under the cell's watch, also while nobody wants a picture.

#include <cstdint>
#include <optional>

#include "pickcell/cell/alarm_list.hpp"
#include "pickcell/cell/cell_port.hpp"
#include "pickcell/cell/robot_watch.hpp"
#include "pickcell/frames/frame_source.hpp"

namespace pickcell::cell {

/// The cell's thread only.
class CameraWatch {
 public:
  /// source must outlive it.
  explicit CameraWatch(const frames::FrameSource& source);

  /// Asks the source how it is, which waits for nothing. A loss raises the alarm CAMERA_LOST, the return clears it.
  /// True when view() is another one than before.
  bool look(AlarmList& alarms, std::int64_t unix_us);
  /// Somebody cleared all alarms: the next look raises anew what still holds.
  void alarms_cleared() { raised_ = false; }
  [[nodiscard]] const CameraView& view() const { return view_; }
  /// Why no picture can be taken, by the last look.
  [[nodiscard]] std::optional<Hindrance> hindrance() const;

 private:
  const frames::FrameSource& source_;
  CameraView view_;
  bool raised_ = false;
};

}  // namespace pickcell::cell
