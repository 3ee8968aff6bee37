#include "pickcell/cli/replay/report.hpp"

#include <algorithm>
#include <cstdio>

#include "pickcell/core/statistics.hpp"

namespace pickcell::cli {

using cell::RecordedFind;
using core::Json;

namespace {

constexpr std::size_t kMostLines = 40;  ///< of changes, for people

template <class... Args>
std::string line(const char* format, Args... args) {
  char buffer[600];
  std::snprintf(buffer, sizeof buffer, format, args...);
  return buffer;
}

Json number(const std::optional<double>& value) { return value ? Json(*value) : Json(); }

Json to_json(const std::optional<RecordedFind>& find) {
  if (!find) return {};
  Json out = Json::object();
  out.set("x_px", find->pose.x_px).set("y_px", find->pose.y_px).set("angle_deg", find->pose.angle_deg);
  out.set("scale", find->pose.scale).set("score", find->score);
  const auto& place = find->place;
  out.set("x_mm", place ? Json(place->x_mm) : Json()).set("y_mm", place ? Json(place->y_mm) : Json());
  out.set("z_mm", place ? Json(place->z_mm) : Json()).set("base_angle_deg", place ? Json(place->angle_deg) : Json());
  out.set("rejected", find->rejected).set("code", find->code ? Json(*find->code) : Json()).set("reason", find->why);
  return out;
}

Json to_json(const ChangedFrame& frame, const FindChange& find) {
  Json what = Json::array();
  if (find.moved) what.push("pose");
  if (find.scored) what.push("score");
  if (find.judged) what.push("reason");
  const bool both = find.recorded && find.now;
  const auto of_both = [&](double value) { return both ? Json(value) : Json(); };
  Json out = Json::object();
  out.set("frame", frame.sequence).set("file", frame.file);
  out.set("part", find.recorded ? find.recorded->part : find.now->part).set("change", name(find.change));
  out.set("what", std::move(what));
  out.set("off_px", of_both(find.off_px)).set("off_deg", of_both(find.off_deg));
  out.set("off_scale_pct", of_both(find.off_scale * 100)).set("off_score", of_both(find.off_score));
  out.set("off_mm", number(find.off_mm)).set("off_base_deg", number(find.off_base_deg));
  out.set("recorded", to_json(find.recorded)).set("now", to_json(find.now));
  return out;
}

/// Texts of a log may come from anywhere, and a terminal obeys control characters.
std::string printable(std::string text) {
  std::replace_if(text.begin(), text.end(), [](unsigned char c) { return c < 0x20 || c == 0x7f; }, '?');
  return text;
}

std::string where(const RecordedFind& find) {
  return line(" (at %.1f, %.1f px, score %.2f)", find.pose.x_px, find.pose.y_px, find.score);
}

std::string fate(const RecordedFind& find) {
  if (!find.rejected) return "good to pick";
  return "turned down: " + printable(find.why.empty() ? find.code.value_or("?") : find.why);
}

std::string words_of(const FindChange& find) {
  if (find.change == Change::lost) return "was " + fate(*find.recorded) + where(*find.recorded);
  if (find.change == Change::added) return "is " + fate(*find.now) + where(*find.now);
  std::string out;
  const auto add = [&](const char* word) { out += (out.empty() ? "" : ", ") + std::string(word); };
  if (find.moved) add("moved");
  if (find.scored) add("scored");
  if (!find.judged) return out;
  return out + (out.empty() ? "" : "; ") + "was " + fate(*find.recorded) + ", is " + fate(*find.now);
}

std::string cell_text(const char* format, const std::optional<double>& value) {
  return value ? line(format, *value) : std::string("-");
}

std::string row(const ChangedFrame& frame, const FindChange& find) {
  const bool both = find.recorded && find.now;
  const auto of_both = [&](double value) { return both ? std::optional(value) : std::nullopt; };
  const std::string part = printable(find.recorded ? find.recorded->part : find.now->part);
  return line("%8lld  %-14.40s %-8s %8s %9s %8s %7s  %.400s\n", static_cast<long long>(frame.sequence), part.c_str(),
              name(find.change), cell_text("%.2f", of_both(find.off_px)).c_str(),
              cell_text("%+.2f", of_both(find.off_deg)).c_str(), cell_text("%.2f", find.off_mm).c_str(),
              cell_text("%+.3f", of_both(find.off_score)).c_str(), words_of(find).c_str());
}

std::string table(const Replay& replay) {
  if (replay.changed.empty()) return {};
  std::string out = line("\n%8s  %-14s %-8s %8s %9s %8s %7s  %s\n", "frame", "part", "change", "px", "deg", "mm",
                         "score", "(now less recorded, worst first)");
  std::size_t lines = 0, left_out = 0;
  for (const ChangedFrame& frame : replay.changed)
    for (const FindChange& find : frame.finds)
      if (lines < kMostLines) {
        out += row(frame, find);
        ++lines;
      } else {
        ++left_out;
      }
  if (left_out > 0) out += line("%8s  %zu more; --json has all\n", "...", left_out);
  return out;
}

}  // namespace

Json to_json(const Replay& r) {
  Json changes = Json::array(), notes = Json::array();
  for (const ChangedFrame& frame : r.changed)
    for (const FindChange& find : frame.finds) changes.push(to_json(frame, find));
  for (const std::string& text : r.notes) notes.push(text);
  const Tolerance& t = r.options.tolerance;
  Json out = Json::object();
  out.set("run", r.options.run.string()).set("started", r.info.started).set("format", r.info.format);
  out.set("cell", r.cell).set("engine", r.engine);
  out.set("shard", std::to_string(r.options.shard.index) + "/" + std::to_string(r.options.shard.count));
  out.set("frames", r.frames).set("same", r.same).set("changed", r.changed.size());
  out.set("without_picture", r.without_picture).set("unreadable", r.unreadable);
  out.set("finds", Json::object()
                       .set("recorded", r.finds_recorded)
                       .set("same", r.finds_same)
                       .set("changed", r.finds_changed)
                       .set("lost", r.finds_lost)
                       .set("new", r.finds_new));
  out.set("largest", Json::object().set("px", r.most_px).set("deg", r.most_deg).set("mm", r.most_mm));
  out.set(
      "match_ms",
      Json::object().set("recorded", number(core::median(r.recorded_ms))).set("now", number(core::median(r.now_ms))));
  out.set("tolerance", Json::object()
                           .set("px", t.px)
                           .set("deg", t.deg)
                           .set("mm", t.mm)
                           .set("scale_pct", t.scale_pct)
                           .set("score", t.score));
  return out.set("notes", std::move(notes)).set("changes", std::move(changes));
}

std::string to_words(const Replay& r) {
  std::string out = line("frames %zu: %zu same, %zu changed, %zu without a picture, %zu unreadable\n", r.frames, r.same,
                         r.changed.size(), r.without_picture, r.unreadable);
  out += line("finds %zu: %zu same, %zu changed, %zu lost; %zu new\n", r.finds_recorded, r.finds_same, r.finds_changed,
              r.finds_lost, r.finds_new);
  out += line("largest difference: %.3f px, %.3f deg, %.3f mm\n", r.most_px, r.most_deg, r.most_mm);
  if (const auto then = core::median(r.recorded_ms), now = core::median(r.now_ms); then && now)
    out += line("matching: median %.1f ms as recorded, %.1f ms now\n", *then, *now);
  out += "models and calibration: " + (r.cell == "recorded" ? "as recorded with the run" : r.cell) + "\n";
  for (const std::string& text : r.notes) out += "note: " + text + "\n";
  return out + table(r);
}

}  // namespace pickcell::cli
