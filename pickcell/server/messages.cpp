#include "pickcell/server/messages.hpp"

#include <algorithm>
#include <map>
#include <utility>

#include "pickcell/server/client_queue.hpp"

namespace pickcell::server {

namespace {

using core::Json;

constexpr std::size_t kMaxDetections = 1000;

Json robot_json(const cell::RobotView& r) {
  Json out;
  out.set("connected", r.connected).set("link", r.link).set("words", r.words).set("running", r.running);
  out.set("servo", r.servo).set("remote", r.remote).set("held", r.held).set("alarm", r.alarm).set("teach", r.teach);
  out.set("tool_mm", Json::Array{r.tool_mm[0], r.tool_mm[1], r.tool_mm[2]});
  return out;
}

Json camera_json(const cell::CameraView& c) {
  Json losses = Json::object();
  for (const auto& [cause, count] : c.losses) losses.set(cause, count);
  Json out;
  out.set("connected", c.connected).set("id", c.id).set("why", c.why).set("remedy", c.remedy);
  out.set("losses", std::move(losses)).set("reconnects", c.reconnects);
  return out;
}

Json counters_json(const cell::Counters& c) {
  Json rejected = Json::object();
  for (const auto& [reason, count] : c.rejected) rejected.set(reason, count);
  Json out;
  out.set("frames", c.frames).set("found", c.found).set("submitted", c.submitted).set("placed", c.placed);
  out.set("missed", c.missed).set("unknown", c.unknown).set("rejected", std::move(rejected));
  out.set("picks_per_min", c.picks_per_min).set("match_ms_median", c.match_ms_median);
  out.set("match_ms_p95", c.match_ms_p95);
  return out;
}

Json detection_json(const cell::Detection& d) {
  Json grip = Json::array();
  for (const auto& [x, y] : d.grasps_px) grip.push(Json::Array{x, y});
  Json out;
  out.set("id", std::size_t{d.id}).set("part", d.part).set("cx", d.x_px).set("cy", d.y_px).set("deg", d.angle_deg);
  out.set("sc", d.scale).set("w", d.w_px).set("h", d.h_px).set("rx", d.ref_x_px).set("ry", d.ref_y_px);
  out.set("score", d.score).set("st", cell::name(d.state)).set("why", d.why.empty() ? Json() : Json(d.why));
  out.set("grip", std::move(grip));
  return out;
}

}  // namespace

Json state_json(const cell::Snapshot& s) {
  Json out;
  out.set("cell", s.cell_name).set("mode", cell::name(s.mode)).set("step", s.step).set("reason", s.reason);
  out.set("remedy", s.remedy).set("simulated", s.simulated).set("robot", robot_json(s.robot));
  out.set("camera", camera_json(s.camera));
  out.set("recipe", s.recipe).set("counters", counters_json(s.counters));
  return out;
}

Json::Array alarm_rows(const std::vector<cell::CellAlarm>& alarms) {
  std::map<std::string, int> seen;
  Json::Array out;
  for (const cell::CellAlarm& a : alarms) {
    const int nth = ++seen[a.code];
    Json row;
    row.set("id", nth == 1 ? a.code : a.code + "#" + std::to_string(nth))
        .set("code", a.code)
        .set("priority", a.priority);
    row.set("text", a.text).set("cause", a.cause).set("remedies", a.remedies).set("first_us", a.first_unix_us);
    row.set("last_us", a.last_unix_us).set("count", a.count).set("active", a.active);
    out.push_back(std::move(row));
  }
  return out;
}

Json log_row(const NumberedEntry& e) {
  Json out;
  out.set("n", std::size_t{e.number}).set("us", e.entry.unix_us).set("level", core::name(e.entry.level));
  out.set("module", e.entry.module).set("text", e.entry.text);
  return out;
}

Json overlay_json(const cell::ShownFrame& shown) {
  const std::size_t listed = std::min(shown.detections.size(), kMaxDetections);
  Json dets = Json::array();
  for (std::size_t i = 0; i < listed; ++i) dets.push(detection_json(shown.detections[i]));
  Json ms;
  ms.set("grab", shown.grab_ms).set("match", shown.match_ms);
  Json out;
  out.set("f", std::size_t{wire_frame_id(shown)}).set("recipe", shown.recipe).set("ms", std::move(ms));
  out.set("sw", shown.frame.picture->width()).set("sh", shown.frame.picture->height()).set("dets", std::move(dets));
  if (listed < shown.detections.size()) out.set("more", shown.detections.size() - listed);
  return out;
}

const char* word(core::ErrorCode code) {
  switch (code) {
    case core::ErrorCode::usage:
      return "usage";
    case core::ErrorCode::unreadable:
      return "unreadable";
    case core::ErrorCode::negative:
      return "negative";
    case core::ErrorCode::device:
      return "device";
    case core::ErrorCode::link:
      return "link";
    case core::ErrorCode::timeout:
      return "timeout";
    case core::ErrorCode::refused:
      return "refused";
    case core::ErrorCode::safety:
      return "safety";
  }
  return "refused";
}

Json error_json(const core::Error& error) {
  Json details;
  details.set("code", word(error.code)).set("text", error.what + ": " + error.why);
  details.set("remedies", error.remedy.empty() ? Json::array() : Json(Json::Array{error.remedy}));
  Json out;
  out.set("ok", false).set("error", std::move(details));
  return out;
}

}  // namespace pickcell::server
