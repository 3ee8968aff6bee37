#include "pickcell/cli/cell/report.hpp"

#include <algorithm>
#include <cstdio>
#include <set>

#include "pickcell/core/statistics.hpp"

namespace pickcell::cli {

using core::Json;

namespace {

Json value(const std::optional<double>& number) { return number ? Json(*number) : Json(); }

Json spread(const std::vector<double>& values, bool with_worst) {
  Json out = Json::object();
  out.set("median", value(core::median(values))).set("p95", value(core::quantile(values, 0.95)));
  if (with_worst) out.set("worst", value(core::quantile(values, 1)));
  return out;
}

double worst(const std::vector<double>& values) { return core::quantile(values, 1).value_or(0); }

}  // namespace

PlaceErrors judge_places(sim::World& world, core::TimePoint end, const picks::PlannerSettings& planner) {
  std::vector<sim::WantedPlace> wanted;
  for (const picks::PartPlan& part : planner.parts)
    for (int slot = 0; slot < part.place.size(); ++slot) wanted.push_back({part.model, part.place.slot(slot)});
  PlaceErrors out;
  std::set<std::uint64_t> ids;
  for (const sim::PlacedPart& part : world.placed()) {
    if (!ids.insert(part.id).second) ++out.duplicates;
    if (const auto error = sim::place_error(part, wanted)) {
      out.mm.push_back(error->mm);
      out.deg.push_back(error->deg);
    } else {
      ++out.strange;
    }
  }
  const sim::WorldCounts counts = world.counts(end);
  out.dropped = counts.dropped + counts.returned;
  return out;
}

bool CellReport::good() const {
  if (counters.placed != asked || counters.missed > 0 || counters.unknown > 0) return false;
  if (!places) return true;
  return static_cast<std::int64_t>(places->mm.size()) == asked && places->strange == 0 && places->duplicates == 0 &&
         places->dropped == 0 && worst(places->mm) <= limit_mm && worst(places->deg) <= limit_deg;
}

Json CellReport::json() const {
  Json rejected = Json::object();
  for (const auto& [reason, count] : counters.rejected) rejected.set(reason, count);
  Json out = Json::object();
  out.set("asked", asked).set("placed", counters.placed).set("missed", counters.missed);
  out.set("dropped", places ? Json(places->dropped) : Json())
      .set("duplicates", places ? Json(places->duplicates) : Json());
  out.set("rejected", rejected);
  out.set("place_mm", places ? spread(places->mm, true) : Json());
  out.set("place_deg", places ? spread(places->deg, true) : Json());
  out.set("match_ms", spread(match_ms, false)).set("cycle_s", spread(cycle_s, false));
  out.set("sim_seconds", sim_seconds).set("wall_seconds", wall_seconds);
  out.set("unknown", counters.unknown).set("good", good()).set("end", end).set("run", run);
  return out;
}

std::string CellReport::words() const {
  const auto line = [](const char* format, auto... args) {
    char buffer[240];
    std::snprintf(buffer, sizeof buffer, format, args...);
    return std::string(buffer);
  };
  std::string out = line("%lld of %lld parts placed, %lld missed, %lld with unknown outcome: %s\n",
                         static_cast<long long>(counters.placed), static_cast<long long>(asked),
                         static_cast<long long>(counters.missed), static_cast<long long>(counters.unknown),
                         good() ? "as asked" : "NOT as asked");
  if (places)
    out += line(
        "place error: worst %.3f mm and %.3f deg (limits %.1f mm, %.1f deg), median %.3f mm and %.3f deg; "
        "%d dropped, %d placed twice\n",
        worst(places->mm), worst(places->deg), limit_mm, limit_deg, core::median(places->mm).value_or(0),
        core::median(places->deg).value_or(0), places->dropped, places->duplicates);
  for (const auto& [reason, count] : counters.rejected)
    out += line("not picked: %lld because of %s\n", static_cast<long long>(count), reason.c_str());
  out += line("matching: median %.0f ms; cycle: median %.2f s; %.1f s of the cell's time in %.1f s\n",
              core::median(match_ms).value_or(0), core::median(cycle_s).value_or(0), sim_seconds, wall_seconds);
  return out + "the cell stands: " + end + "\nits record: " + run + "\n";
}

}  // namespace pickcell::cli
