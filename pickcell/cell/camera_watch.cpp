#include "pickcell/cell/camera_watch.hpp"

#include <utility>

namespace pickcell::cell {

namespace {

constexpr const char* kCode = "CAMERA_LOST";

std::map<std::string, std::int64_t> losses(const frames::FrameCounters& c) {
  std::map<std::string, std::int64_t> out;
  for (const auto& [cause, count] : {std::pair{"incomplete", c.incomplete},
                                     {"torn", c.torn},
                                     {"missing", c.missing},
                                     {"repeated", c.repeated},
                                     {"late", c.late}})
    if (count > 0) out[cause] = static_cast<std::int64_t>(count);
  return out;
}

}  // namespace

CameraWatch::CameraWatch(const frames::FrameSource& source) : source_(source) { view_.id = source.info().camera_id; }

bool CameraWatch::look(AlarmList& alarms, std::int64_t unix_us) {
  CameraView now;
  now.id = source_.info().camera_id;
  const frames::FrameCounters counters = source_.counters();
  now.losses = losses(counters);
  now.reconnects = static_cast<std::int64_t>(counters.reconnects);
  if (const auto health = source_.health(); !health) {
    now.connected = false;
    now.why = health.error().what.empty() ? health.error().why : health.error().what + ": " + health.error().why;
    now.remedy = health.error().remedy.empty() ? "check the camera's power and cable" : health.error().remedy;
  }
  const bool changed = now != view_;
  // Once, not at every look: each raising is news to everybody who watches.
  if (!now.connected && (changed || !raised_)) {
    alarms.raise(kCode, 1, "No camera: " + now.why, now.why, {now.remedy}, unix_us);
    raised_ = true;
  } else if (now.connected && raised_) {
    alarms.clear(kCode, unix_us);
    raised_ = false;
  }
  view_ = std::move(now);
  return changed;
}

std::optional<Hindrance> CameraWatch::hindrance() const {
  if (view_.connected) return std::nullopt;
  return Hindrance{kCode, view_.why, view_.remedy};
}

}  // namespace pickcell::cell
