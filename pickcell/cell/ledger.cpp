#include "pickcell/cell/ledger.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "pickcell/cell/fate.hpp"
#include "pickcell/core/statistics.hpp"
#include "pickcell/core/units.hpp"

namespace pickcell::cell {

namespace {

constexpr core::Duration kRateWindow = std::chrono::minutes(5);
constexpr std::size_t kNewestMatchTimes = 200;

/// A cell runs for months: the report of a run needs the figures of its picks, not of all time.
void keep(std::vector<double>& figures, double next) {
  constexpr std::size_t kMost = 200'000;
  if (figures.size() == kMost) figures.erase(figures.begin(), figures.begin() + kMost / 2);
  figures.push_back(next);
}

Detection shown_detection(const Sight::Seen& seen, const matches::Model& model) {
  Detection d;
  d.id = seen.detection_id;
  d.part = seen.match.model;
  d.x_px = seen.match.pose.x_px;
  d.y_px = seen.match.pose.y_px;
  d.angle_deg = seen.match.pose.angle_deg;
  d.scale = seen.match.pose.scale;
  d.w_px = model.picture.width();
  d.h_px = model.picture.height();
  d.ref_x_px = model.ref_x_px;
  d.ref_y_px = model.ref_y_px;
  d.score = seen.match.score;
  const double a = core::rad_from_deg(d.angle_deg);
  for (const matches::Grasp& g : model.grasps) {
    const double u = g.x_px - model.ref_x_px, v = g.y_px - model.ref_y_px;
    d.grasps_px.push_back({d.x_px + d.scale * (std::cos(a) * u + std::sin(a) * v),
                           d.y_px + d.scale * (-std::sin(a) * u + std::cos(a) * v)});
  }
  return d;
}

}  // namespace

core::Status Ledger::saw(frames::Frame frame, const Sight& sight, const picks::Plan& plan, double grab_ms,
                         const std::vector<matches::Model>& models, const std::string& recipe) {
  auto shown = std::make_shared<ShownFrame>();
  shown->frame = std::move(frame);
  shown->grab_ms = grab_ms;
  shown->match_ms = sight.match_ms;
  shown->recipe = recipe;
  std::vector<matches::Match> found;
  for (const Sight::Seen& seen : sight.seen) {
    Detection d = shown_detection(seen, models[static_cast<std::size_t>(seen.match.model_index)]);
    const Fate fate = fate_of(seen, plan);
    d.state = fate.state;
    d.code = fate.code;
    d.why = fate.why;
    if (fate.state == DetectionState::rejected && standing_.first_rejection(d.part, fate.code, {d.x_px, d.y_px}))
      ++counters_.rejected[fate.code];
    shown->detections.push_back(std::move(d));
    found.push_back(seen.match);
  }
  ++counters_.frames;
  counters_.found += static_cast<std::int64_t>(sight.seen.size());
  next_detection_id_ += sight.seen.size();
  keep(match_ms_, sight.match_ms);
  auto logged = log_.add_frame(*shown, found, sight.parts);
  desk_.publish(std::shared_ptr<const ShownFrame>(std::move(shown)));
  return logged;
}

void Ledger::begin(OpenPick pick) {
  tray_.take(pick.kind, pick.pick.place_slot);
  pick.t_submit_us = clock_.unix_us();
  mark(pick.pick.detection_id, DetectionState::picking, "");
  open_ = std::move(pick);
}

core::Status Ledger::handed_over(std::int32_t sequence) {
  open_->sequence = sequence;
  ++counters_.submitted;
  return log_.add_pick(
      {open_->pick.detection_id, sequence, open_->pick.place_slot, "submitted", 0, "", open_->t_submit_us, 0});
}

core::Status Ledger::end(const robot::Outcome& outcome) {
  using robot::OutcomeKind;
  const OpenPick pick = *std::exchange(open_, std::nullopt);
  const char* word = "unknown";
  switch (outcome.kind) {
    case OutcomeKind::done:
      word = "done";
      ++counters_.placed;
      placed_at_.push_back(clock_.now());
      while (clock_.now() - placed_at_.front() > kRateWindow) placed_at_.pop_front();
      mark(pick.pick.detection_id, DetectionState::placed, "");
      break;
    case OutcomeKind::refused:
      word = "refused";
      ++counters_.missed;
      tray_.free(pick.kind, pick.pick.place_slot);
      standing_.note_attempt(pick.pick.model, pick.part_m);
      mark(pick.pick.detection_id, DetectionState::missed, outcome.text);
      break;
    case OutcomeKind::not_started:
      word = "not_started";
      tray_.free(pick.kind, pick.pick.place_slot);
      mark(pick.pick.detection_id, DetectionState::found, outcome.text);
      break;
    case OutcomeKind::unknown:
      ++counters_.unknown;
      mark(pick.pick.detection_id, DetectionState::unknown, outcome.text);
      break;
  }
  if (outcome.kind != OutcomeKind::not_started) {
    keep(cycle_s_, core::seconds(clock_.now() - last_end_));
    last_end_ = clock_.now();
  }
  const PickRecord record{pick.pick.detection_id, outcome.sequence, pick.pick.place_slot, word,
                          outcome.reason,         outcome.text,     pick.t_submit_us,     clock_.unix_us()};
  if (pick.sequence == 0)
    if (auto added = log_.add_pick(record); !added) return added;
  return log_.end_pick(record);
}

void Ledger::give_back(const std::string& code, const std::string& why) {
  const OpenPick pick = *std::exchange(open_, std::nullopt);
  tray_.free(pick.kind, pick.pick.place_slot);
  if (!code.empty()) {
    ++counters_.rejected[code];
    standing_.note_attempt(pick.pick.model, pick.part_m);
  }
  mark(pick.pick.detection_id, code.empty() ? DetectionState::found : DetectionState::rejected, why);
}

Counters Ledger::counters() const {
  Counters out = counters_;
  const core::TimePoint now = clock_.now();
  const auto recent =
      std::count_if(placed_at_.begin(), placed_at_.end(), [&](auto t) { return now - t <= kRateWindow; });
  const core::Duration span = std::min<core::Duration>(kRateWindow, now.time_since_epoch());
  if (span.count() > 0) out.picks_per_min = static_cast<double>(recent) * 60.0 / core::seconds(span);
  const std::size_t newest = std::min(match_ms_.size(), kNewestMatchTimes);
  const std::vector<double> times(match_ms_.end() - static_cast<std::ptrdiff_t>(newest), match_ms_.end());
  out.match_ms_median = core::quantile(times, 0.5).value_or(0);
  out.match_ms_p95 = core::quantile(times, 0.95).value_or(0);
  return out;
}

void Ledger::mark(std::uint64_t detection_id, DetectionState state, const std::string& why) {
  const auto shown = desk_.frame();
  if (!shown) return;
  const auto same = [&](const Detection& d) { return d.id == detection_id; };
  if (std::none_of(shown->detections.begin(), shown->detections.end(), same)) return;
  auto newer = std::make_shared<ShownFrame>(*shown);
  const auto d = std::find_if(newer->detections.begin(), newer->detections.end(), same);
  d->state = state;
  d->why = why;
  desk_.publish(std::shared_ptr<const ShownFrame>(std::move(newer)));
}

}  // namespace pickcell::cell
