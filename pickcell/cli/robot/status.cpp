#include "pickcell/cli/robot/status.hpp"

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <utility>

#include "pickcell/cli/robot/names.hpp"
#include "pickcell/robot/readiness.hpp"

namespace pickcell::cli {

using core::Json;

namespace {

template <class... Args>
std::string text(const char* format, Args... args) {
  char buffer[240];
  std::snprintf(buffer, sizeof buffer, format, args...);
  return buffer;
}

core::Status measure(robot::ControllerLink& link, int reads, RobotReport& report) {
  for (int i = 0; i < reads; ++i) {
    const auto start = std::chrono::steady_clock::now();
    auto state = link.read_status();
    if (!state) return core::forward(state);
    report.state = *state;
    report.answer_ms.push_back(
        std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count());
  }
  std::sort(report.answer_ms.begin(), report.answer_ms.end());
  return {};
}

void add_missing(RobotReport& report, std::string what, std::string remedy) {
  report.missing.push_back(std::move(what));
  report.to_do.push_back(std::move(remedy));
}

core::Status find_missing(robot::ControllerLink& link, const std::string& job, RobotReport& report) {
  for (const robot::Hindrance& h : robot::hindrances(report.state)) add_missing(report, h.what, h.remedy);
  auto jobs = link.list_jobs();
  if (!jobs && !link.connected()) return core::forward(jobs);
  if (!jobs && jobs.error().code == core::ErrorCode::usage) {
    add_missing(report, "picks need the job " + job + ", and " + jobs.error().why, jobs.error().remedy);
  } else if (!jobs) {
    add_missing(report, "the job list cannot be read: " + jobs.error().why, jobs.error().remedy);
  } else if (std::find(jobs->begin(), jobs->end(), job) == jobs->end()) {
    add_missing(report, "there is no job " + job,
                "load it: pickcell robot hses://HOST job upload " + job + ".JBI, or from a card");
  }
  return {};
}

core::Status read_poses(robot::ControllerLink& link, int frame, RobotReport& report) {
  auto base = link.read_position(robot::kBaseFrame);
  if (!base && !link.connected()) return core::forward(base);
  if (base)
    report.in_base = *base;
  else
    add_missing(report, "the pose: " + base.error().why, base.error().remedy);
  if (frame == robot::kBaseFrame) return {};
  auto other = link.read_position(frame);
  if (!other && !link.connected()) return core::forward(other);
  if (other)
    report.in_frame = *other;
  else
    add_missing(report, "the pose in frame " + std::to_string(frame) + ": " + other.error().why, other.error().remedy);
  return {};
}

std::string position_words(const robot::CartesianPosition& p) {
  return text("X %.3f Y %.3f Z %.3f mm, Rx %.4f Ry %.4f Rz %.4f deg, tool %d", p.x_mm, p.y_mm, p.z_mm, p.rx_deg,
              p.ry_deg, p.rz_deg, p.tool);
}

std::string mode_words(const robot::RobotState& s) {
  std::string out = s.teach ? "teach" : s.play ? "play" : "no mode";
  out += s.remote ? ", command remote" : ", no command remote";
  out += s.step ? ", step" : s.one_cycle ? ", one cycle" : s.continuous ? ", continuous" : "";
  out += s.servo ? ", servo on" : ", servo off";
  out += s.running ? ", running" : ", standing";
  if (s.hold_pendant) out += ", held from the pendant";
  if (s.hold_external) out += ", held from outside";
  if (s.hold_command) out += ", held by command";
  if (s.alarm) out += ", ALARM";
  if (s.error) out += ", ERROR";
  if (s.speed_limited) out += ", speed limited";
  return out;
}

double at_share(const std::vector<double>& sorted, double share) {
  return sorted.empty() ? 0 : sorted[static_cast<std::size_t>(share * static_cast<double>(sorted.size() - 1))];
}

}  // namespace

core::Result<RobotReport> read_report(robot::ControllerLink& link, int frame, const std::string& job, int reads) {
  RobotReport r;
  r.peer = link.peer();
  auto identity = link.identity();
  if (identity) r.identity = *identity;
  if (!identity && !link.connected()) return core::forward(identity);
  if (auto measured = measure(link, reads, r); !measured) return core::forward(measured);
  auto alarms = link.read_alarms();
  if (!alarms && !link.connected()) return core::forward(alarms);
  if (alarms)
    r.alarms = *alarms;
  else
    add_missing(r, "the alarms: " + alarms.error().why, alarms.error().remedy);
  auto current = link.read_job();
  if (current) r.job = *current;
  if (!current && !link.connected()) return core::forward(current);  // refused: none is set
  if (auto poses = read_poses(link, frame, r); !poses) return core::forward(poses);
  auto pulses = link.read_pulses();
  if (pulses) r.pulses = *pulses;
  if (!pulses && !link.connected()) return core::forward(pulses);
  if (auto found = find_missing(link, job, r); !found) return core::forward(found);
  return r;
}

Json report_json(const RobotReport& r) {
  const robot::RobotState& s = r.state;
  Json out = Json::object();
  out.set("peer", r.peer).set("identity", r.identity);
  out.set("mode", s.teach ? "teach" : "play").set("remote", s.remote).set("servo", s.servo).set("running", s.running);
  out.set("cycle", s.step         ? Json("step")
                   : s.one_cycle  ? Json("one_cycle")
                   : s.continuous ? Json("continuous")
                                  : Json())
      .set("speed_limited", s.speed_limited);
  out.set("hold_pendant", s.hold_pendant).set("hold_external", s.hold_external).set("hold_command", s.hold_command);
  out.set("alarm", s.alarm).set("error", s.error);
  Json alarms = Json::array();
  for (const robot::Alarm& a : r.alarms)
    alarms.push(Json::object().set("code", a.code).set("data", a.data).set("text", a.text));
  out.set("alarms", alarms);
  out.set("job", r.job.name.empty() ? Json() : Json(r.job.name)).set("line", r.job.line).set("step", r.job.step);
  if (r.in_base) out.set("pose_base", position_json(*r.in_base));
  if (r.in_frame) out.set("pose_frame", position_json(*r.in_frame));
  Json pulses = Json::array();
  for (const std::int32_t p : r.pulses) pulses.push(std::int64_t{p});
  out.set("pulses", pulses);
  out.set("answer_ms", Json::object()
                           .set("reads", r.answer_ms.size())
                           .set("median", at_share(r.answer_ms, 0.5))
                           .set("p99", at_share(r.answer_ms, 0.99))
                           .set("max", at_share(r.answer_ms, 1)));
  Json missing = Json::array();
  for (std::size_t i = 0; i < r.missing.size(); ++i)
    missing.push(Json::object().set("what", r.missing[i]).set("remedy", r.to_do[i]));
  return out.set("missing", missing).set("ready", r.missing.empty());
}

std::string report_words(const RobotReport& r) {
  std::string out = r.peer + (r.identity.empty() ? "" : ": " + r.identity) + "\n";
  out += "state:     " + mode_words(r.state) + "\n";
  for (const robot::Alarm& a : r.alarms) out += "alarm:     " + a.text + "\n";
  out += "job:       " +
         (r.job.name.empty() ? "none is set" : r.job.name + text(", line %d, step %d", r.job.line, r.job.step)) + "\n";
  if (r.in_base) out += "base:      " + position_words(*r.in_base) + "\n";
  if (r.in_frame) out += text("frame %-3d  ", r.in_frame->frame) + position_words(*r.in_frame) + "\n";
  if (!r.pulses.empty()) out += "pulses:   ";
  for (const std::int32_t p : r.pulses) out += " " + std::to_string(p);
  if (!r.pulses.empty()) out += "\n";
  out += text("answers:   %zu status reads, median %.2f ms, p99 %.2f ms, longest %.2f ms\n", r.answer_ms.size(),
              at_share(r.answer_ms, 0.5), at_share(r.answer_ms, 0.99), at_share(r.answer_ms, 1));
  for (std::size_t i = 0; i < r.missing.size(); ++i) out += "missing:   " + r.missing[i] + "; " + r.to_do[i] + "\n";
  if (r.missing.empty()) out += "ready:     nothing is missing for picks\n";
  return out;
}

}  // namespace pickcell::cli
