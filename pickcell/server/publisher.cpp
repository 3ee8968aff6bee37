#include "pickcell/server/publisher.hpp"

#include <utility>

#include "pickcell/server/messages.hpp"

namespace pickcell::server {

namespace {

using core::Json;

/// Keys of now whose value differs from before.
Json changed(const Json& before, const Json& now) {
  Json out = Json::object();
  for (const auto& [key, value] : now.members())
    if (!before.has(key) || before[key].dump() != value.dump()) out.set(key, value);
  return out;
}

Json alarm_message(std::uint64_t rev, Json row) {
  Json out;
  out.set("type", "alarm").set("rev", std::size_t{rev}).set("row", std::move(row));
  return out;
}

}  // namespace

Publisher::Change Publisher::update(const cell::Snapshot& snapshot) {
  Change change;
  auto state = std::make_shared<const Json>(state_json(snapshot));
  if (!changed(*state_, *state).members().empty()) {
    state_ = std::move(state);
    ++state_rev_;
    change.state = true;
  }
  alarm_rows_ = alarm_rows(snapshot.alarms);
  std::map<std::string, Json> rows;
  for (const Json& row : alarm_rows_) {
    const std::string& id = row["id"].string();
    rows.emplace(id, row);
    const auto old = alarms_.find(id);
    if (old == alarms_.end() || old->second.dump() != row.dump())
      change.alarm_texts.push_back(alarm_message(++alarm_rev_, row).dump());
  }
  for (const auto& [id, row] : alarms_) {
    if (rows.contains(id)) continue;
    Json gone;
    gone.set("id", id).set("gone", true);
    change.alarm_texts.push_back(alarm_message(++alarm_rev_, std::move(gone)).dump());
  }
  alarms_ = std::move(rows);
  return change;
}

std::string Publisher::hello(std::int64_t unix_us) const {
  Json out;
  out.set("type", "hello").set("proto", kProtocol).set("build", build_).set("serverTime", unix_us);
  out.set("user", Json()).set("role", "operator").set("lease", Json());
  return out.dump();
}

Json Publisher::snap_json() const {
  Json state = Json::object();
  for (const auto& [key, value] : state_->members())
    if (key != "recipe" && key != "counters") state.set(key, value);
  Json out;
  out.set("state", std::move(state)).set("recipe", (*state_)["recipe"]).set("counters", (*state_)["counters"]);
  out.set("alarms", alarm_rows_);
  return out;
}

std::string Publisher::snap(Told& told, const LogTail& log) const {
  told.state = state_;
  told.state_rev = state_rev_;
  Json rows = Json::array();
  for (const NumberedEntry& e : log.after(0)) {
    rows.push(log_row(e));
    told.log_number = e.number;
  }
  Json rev;
  rev.set("state", std::size_t{state_rev_}).set("alarm", std::size_t{alarm_rev_});
  Json out;
  out.set("type", "snap").set("rev", std::move(rev));
  const Json content = snap_json();
  for (const auto& [key, value] : content.members()) out.set(key, value);
  return out.set("log", std::move(rows)).dump();
}

std::string Publisher::state(Told& told) const {
  if (!told.state || told.state_rev == state_rev_) return {};
  Json out;
  out.set("type", "state").set("rev", std::size_t{state_rev_}).set("base", std::size_t{told.state_rev});
  const Json difference = changed(*told.state, *state_);
  for (const auto& [key, value] : difference.members()) out.set(key, value);
  told.state = state_;
  told.state_rev = state_rev_;
  return out.dump();
}

std::string Publisher::log(Told& told, const LogTail& log) const {
  const auto entries = log.after(told.log_number);
  if (entries.empty()) return {};
  Json rows = Json::array();
  for (const NumberedEntry& e : entries) rows.push(log_row(e));
  told.log_number = entries.back().number;
  Json out;
  out.set("type", "log").set("rows", std::move(rows));
  return out.dump();
}

std::string Publisher::heartbeat(std::int64_t unix_us) {
  Json out;
  out.set("type", "hb").set("t", unix_us);
  return out.dump();
}

std::string Publisher::no_video(const std::string& why) {
  Json out;
  out.set("type", "video").set("on", false).set("why", why);
  return out.dump();
}

}  // namespace pickcell::server
