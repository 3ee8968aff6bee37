#pragma once
/// A cell behind CellPort whose every change is a call: for tests of the server and of its pages. It is a whole
/// CellPort, not a recording: start, stop and reset act on its mode and are counted.

#include <array>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "pickcell/cell/cell_port.hpp"

namespace pickcell::testing {

constexpr int kFrameWidthPx = 640, kFrameHeightPx = 512;
constexpr int kBits = 16, kBitPx = 32;  ///< the frame's number as white and black squares along the upper edge

/// The part of frame f lies here, so that picture and overlay can be compared without a common source.
inline std::array<double, 2> part_place_px(std::uint64_t f) {
  return {100.0 + static_cast<double>(f * 37 % 440), 120.0 + static_cast<double>(f * 53 % 330)};
}

/// A grey picture that says its own number, with a dark part where part_place_px() says.
inline std::shared_ptr<const image::Image> numbered_picture(std::uint64_t f) {
  auto picture = std::make_shared<image::Image>(kFrameWidthPx, kFrameHeightPx);
  const auto [part_x, part_y] = part_place_px(f);
  for (int y = 0; y < kFrameHeightPx; ++y)
    for (int x = 0; x < kFrameWidthPx; ++x) {
      int value = 118 + x * 40 / kFrameWidthPx + (x * 7 + y * 13) % 5;
      if (std::abs(x - part_x) < 45 && std::abs(y - part_y) < 22) value = 60;
      if (y < kBitPx && x < kBits * kBitPx) value = (f >> (x / kBitPx)) & 1u ? 250 : 5;
      picture->at(x, y) = static_cast<std::uint8_t>(value);
    }
  return picture;
}

class ScriptedCell final : public cell::CellPort {
 public:
  ScriptedCell() {
    state_.cell_name = "Cell 7";
    state_.mode = cell::Mode::idle;
    state_.step = "ready";
    state_.recipe = "brackets@3";
    state_.simulated = true;
    state_.robot.connected = state_.robot.remote = state_.robot.servo = true;
    state_.robot.link = "tcp80://192.168.255.1";
    state_.robot.words = "play, remote, servo on";
    state_.robot.tool_mm = {412.3, -88.1, 305};
  }

  [[nodiscard]] cell::Snapshot snapshot() const override {
    const std::lock_guard lock(mutex_);
    return state_;
  }
  [[nodiscard]] std::shared_ptr<const cell::ShownFrame> latest_frame() const override {
    const std::lock_guard lock(mutex_);
    return frame_;
  }
  [[nodiscard]] core::Status start() override {
    {
      const std::lock_guard lock(mutex_);
      ++commands_["start"];
      if (state_.mode != cell::Mode::idle)
        return failure(core::ErrorCode::refused, "start", "the cell is not idle", "wait until it stands, or reset it");
    }
    change([](cell::Snapshot& s) {
      s.mode = cell::Mode::running;
      s.step = "looking";
    });
    return {};
  }
  [[nodiscard]] core::Status stop_cycle() override {
    {
      const std::lock_guard lock(mutex_);
      ++commands_["stop"];
    }
    change([](cell::Snapshot& s) {
      if (s.mode == cell::Mode::running) s.mode = cell::Mode::idle;
      s.step = "ready";
    });
    return {};
  }
  [[nodiscard]] core::Status reset() override {
    {
      const std::lock_guard lock(mutex_);
      ++commands_["reset"];
    }
    change([](cell::Snapshot& s) {
      s.mode = cell::Mode::idle;
      s.step = "ready";
      s.reason.clear();
      s.remedy.clear();
      s.alarms.clear();
    });
    return {};
  }
  int on_change(std::function<void()> listener) override {
    const std::lock_guard lock(listeners_mutex_);
    listeners_[++last_handle_] = std::move(listener);
    return last_handle_;
  }
  void remove_listener(int handle) override {
    const std::lock_guard lock(listeners_mutex_);
    listeners_.erase(handle);
  }

  /// Changes the snapshot and rings.
  void change(const std::function<void(cell::Snapshot&)>& edit) {
    {
      const std::lock_guard lock(mutex_);
      edit(state_);
      ++state_.revision;
    }
    ring();
  }

  /// Publishes the next numbered picture with its part, and further parts in every state when asked. Returns its
  /// number.
  std::uint64_t publish_frame(std::int64_t unix_us, bool many_states = false) {
    auto shown = std::make_shared<cell::ShownFrame>();
    {
      const std::lock_guard lock(mutex_);
      shown->frame.sequence = ++state_.counters.frames;
    }
    const std::uint64_t f = shown->frame.sequence;
    shown->frame.picture = numbered_picture(f);
    shown->frame.exposed_unix_us = unix_us;
    shown->frame.camera_id = "scripted";
    shown->frame.simulated = true;
    shown->recipe = "brackets@3";
    shown->grab_ms = 4;
    shown->match_ms = 21.5;
    const auto [x, y] = part_place_px(f);
    shown->detections.push_back(detection(f * 10, "bracket", x, y, 0, cell::DetectionState::queued));
    if (many_states) add_parts_in_every_state(*shown);
    {
      const std::lock_guard lock(mutex_);
      frame_ = shown;
      ++state_.revision;
    }
    ring();
    return f;
  }

  [[nodiscard]] int commands(const std::string& name) const {
    const std::lock_guard lock(mutex_);
    const auto found = commands_.find(name);
    return found == commands_.end() ? 0 : found->second;
  }

 private:
  static cell::Detection detection(std::uint64_t id, std::string part, double x, double y, double deg,
                                   cell::DetectionState state) {
    cell::Detection d;
    d.id = id;
    d.part = std::move(part);
    d.x_px = x;
    d.y_px = y;
    d.angle_deg = deg;
    d.w_px = 91;
    d.h_px = 45;
    d.ref_x_px = 45;
    d.ref_y_px = 22;
    d.score = 0.91;
    d.state = state;
    d.grasps_px = {{x, y}};
    return d;
  }
  static void add_parts_in_every_state(cell::ShownFrame& shown) {
    using cell::DetectionState;
    double x = 90;
    std::uint64_t id = 1;
    for (const auto state : {DetectionState::found, DetectionState::picking, DetectionState::placed,
                             DetectionState::missed, DetectionState::unknown, DetectionState::rejected}) {
      shown.detections.push_back(
          detection(id, "washer", x, 440 - 30 * static_cast<double>(id % 2), 15.0 * static_cast<double>(id), state));
      if (state == DetectionState::rejected) shown.detections.back().why = "another part lies 3 mm beside the grasp";
      x += 92;
      ++id;
    }
  }
  void ring() {
    const std::lock_guard lock(listeners_mutex_);
    for (const auto& [handle, listener] : listeners_) listener();
  }

  mutable std::mutex mutex_;
  cell::Snapshot state_;
  std::shared_ptr<const cell::ShownFrame> frame_;
  std::map<std::string, int> commands_;
  std::mutex listeners_mutex_;
  std::map<int, std::function<void()>> listeners_;
  int last_handle_ = 0;
};

}  // namespace pickcell::testing
