#include "pickcell/cli/replay/compare.hpp"

#include <algorithm>
#include <cmath>

#include "pickcell/cell/fate.hpp"

namespace pickcell::cli {

using cell::RecordedFind;

namespace {

/// Two finds in one place differ in their angle: a degree counts as much as this on the way to a partner.
constexpr double kPxOfDegree = 0.1;

PartTraits traits_of(const std::map<std::string, PartTraits>& parts, const std::string& part) {
  const auto known = parts.find(part);
  return known == parts.end() ? PartTraits{} : known->second;
}

double turned_deg(double from_deg, double to_deg, int symmetry_order) {
  return std::remainder(to_deg - from_deg, 360.0 / std::max(1, symmetry_order));
}

double distance_px(const RecordedFind& a, const RecordedFind& b) {
  return std::hypot(a.pose.x_px - b.pose.x_px, a.pose.y_px - b.pose.y_px);
}

struct Pair {
  std::size_t recorded, now;
  double way;
};

std::vector<Pair> possible_pairs(const std::vector<RecordedFind>& recorded, const std::vector<RecordedFind>& now,
                                 const std::map<std::string, PartTraits>& parts) {
  std::vector<Pair> out;
  for (std::size_t r = 0; r < recorded.size(); ++r) {
    const PartTraits traits = traits_of(parts, recorded[r].part);
    for (std::size_t n = 0; n < now.size(); ++n) {
      const double px = distance_px(recorded[r], now[n]);
      if (now[n].part != recorded[r].part || !(px <= traits.reach_px)) continue;
      const double deg = turned_deg(recorded[r].pose.angle_deg, now[n].pose.angle_deg, traits.symmetry_order);
      out.push_back({r, n, px + kPxOfDegree * std::abs(deg)});
    }
  }
  std::stable_sort(out.begin(), out.end(), [](const Pair& a, const Pair& b) { return a.way < b.way; });
  return out;
}

/// Whether the part is judged otherwise. What hangs on the cell's past, a picture cannot tell.
bool judged_otherwise(const RecordedFind& recorded, const RecordedFind& now) {
  for (const RecordedFind* find : {&recorded, &now})
    if (find->code && cell::hangs_on_the_past(*find->code, find->why)) return false;
  if (recorded.code && now.code) return *recorded.code != *now.code;
  return recorded.rejected != now.rejected;
}

FindChange compare_pair(const RecordedFind& recorded, const RecordedFind& now, int symmetry_order, const Tolerance& t) {
  FindChange out;
  out.recorded = recorded;
  out.now = now;
  out.off_px = distance_px(recorded, now);
  out.off_deg = turned_deg(recorded.pose.angle_deg, now.pose.angle_deg, symmetry_order);
  out.off_scale = now.pose.scale / recorded.pose.scale - 1;
  out.off_score = now.score - recorded.score;
  out.moved = out.off_px > t.px || std::abs(out.off_deg) > t.deg || std::abs(out.off_scale) * 100 > t.scale_pct;
  if (recorded.place && now.place) {
    const double xy_mm = std::hypot(now.place->x_mm - recorded.place->x_mm, now.place->y_mm - recorded.place->y_mm);
    out.off_mm = std::hypot(xy_mm, now.place->z_mm - recorded.place->z_mm);
    out.off_base_deg = turned_deg(recorded.place->angle_deg, now.place->angle_deg, symmetry_order);
    out.moved = out.moved || *out.off_mm > t.mm || std::abs(*out.off_base_deg) > t.deg;
  }
  out.scored = std::abs(out.off_score) > t.score;
  out.judged = judged_otherwise(recorded, now);
  out.change = out.moved || out.scored || out.judged ? Change::changed : Change::same;
  return out;
}

}  // namespace

const char* name(Change change) {
  switch (change) {
    case Change::same:
      return "same";
    case Change::changed:
      return "changed";
    case Change::lost:
      return "lost";
    case Change::added:
      return "new";
  }
  return "same";
}

double FindChange::weight(const Tolerance& t) const {
  constexpr double kDecides = 1e9;  // above any distance
  if (change == Change::lost) return (recorded->rejected ? 1 : 4) * kDecides + recorded->score;
  if (change == Change::added) return (now->rejected ? 1 : 3) * kDecides + now->score;
  const auto in = [](double off, double tolerance) { return std::abs(off) / std::max(tolerance, 1e-9); };
  const double off =
      std::max({in(off_px, t.px), in(off_deg, t.deg), in(off_scale * 100, t.scale_pct), in(off_score, t.score),
                in(off_mm.value_or(0), t.mm), in(off_base_deg.value_or(0), t.deg)});
  return (judged ? 2 * kDecides : 0) + std::min(off, kDecides / 2);
}

std::vector<FindChange> compare(const std::vector<RecordedFind>& recorded, const std::vector<RecordedFind>& now,
                                const std::map<std::string, PartTraits>& parts, const Tolerance& tolerance) {
  std::vector<std::optional<std::size_t>> partner(recorded.size());
  std::vector<bool> taken(now.size());
  for (const Pair& pair : possible_pairs(recorded, now, parts)) {
    if (partner[pair.recorded] || taken[pair.now]) continue;
    partner[pair.recorded] = pair.now;
    taken[pair.now] = true;
  }
  std::vector<FindChange> out;
  for (std::size_t r = 0; r < recorded.size(); ++r) {
    if (partner[r]) {
      const int symmetry_order = traits_of(parts, recorded[r].part).symmetry_order;
      out.push_back(compare_pair(recorded[r], now[*partner[r]], symmetry_order, tolerance));
    } else {
      out.emplace_back();
      out.back().change = Change::lost;
      out.back().recorded = recorded[r];
    }
  }
  for (std::size_t n = 0; n < now.size(); ++n) {
    if (taken[n]) continue;
    out.emplace_back();
    out.back().change = Change::added;
    out.back().now = now[n];
  }
  return out;
}

}  // namespace pickcell::cli
