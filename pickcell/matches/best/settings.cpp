#include "pickcell/matches/best/settings.hpp"

#include <charconv>
#include <cmath>
#include <optional>
#include <vector>

#include "pickcell/core/config.hpp"

namespace pickcell::matches {
namespace {

struct Number {
  std::string key;
  double lo, hi;
  double* value = nullptr;
  int* whole = nullptr;
};

void add_detail(const std::string& prefix, PassSettings& p, std::vector<Number>& table) {
  table.push_back({prefix + ".side_cells", 4, 100, &p.detail.side_cells});
  table.push_back({prefix + ".short_cells", 2, 100, &p.detail.short_cells});
  table.push_back({prefix + ".mask_cells", 2, 100, &p.detail.mask_cells});
  table.push_back({prefix + ".angle_step", 0.2, 4, &p.detail.angle_step});
  table.push_back({prefix + ".scale_step", 0.2, 8, &p.detail.scale_step});
  table.push_back({prefix + ".most_work", 1, 1e6, &p.detail.most_work});
}

void add_pass(const std::string& prefix, PassSettings& p, std::vector<Number>& table) {
  table.push_back({prefix + ".candidates", 1, 10000, nullptr, &p.candidates});
  table.push_back({prefix + ".keep_top", 1, 10000, nullptr, &p.keep_top});
  table.push_back({prefix + ".keep_mid", 1, 10000, nullptr, &p.keep_mid});
  table.push_back({prefix + ".window", 0.01, 2, &p.window});
}

std::vector<Number> numbers(BestSettings& s) {
  std::vector<Number> table{
      {"accept_ncc", -1, 2, &s.accept_ncc},     {"accept_edge", -1, 2, &s.accept_edge},
      {"accept_score", -1, 2, &s.accept_score}, {"accept_margin", 0, 2, &s.accept_margin},
      {"min_visible", 0.3, 1, &s.min_visible},  {"ambiguous_margin", 0, 1, &s.ambiguous_margin},
  };
  add_detail("quick", s.quick, table);
  add_detail("wide", s.wide, table);
  add_detail("thorough", s.thorough, table);
  add_pass("quick", s.quick, table);
  add_pass("wide", s.wide, table);
  add_pass("thorough", s.thorough, table);
  add_pass("last", s.last, table);
  return table;
}

std::optional<double> to_number(const std::string& text) {
  double v = 0;
  const auto r = std::from_chars(text.data(), text.data() + text.size(), v);
  if (r.ec != std::errc() || r.ptr != text.data() + text.size() || !std::isfinite(v)) return {};
  return v;
}

std::string short_number(double v) {
  std::string s = std::to_string(v);
  s.erase(s.find_last_not_of('0') + 1);
  if (s.back() == '.') s.pop_back();
  return s;
}

core::Status set_effort(const std::string& text, Effort& effort) {
  if (text == "quick")
    effort = Effort::quick;
  else if (text == "auto")
    effort = Effort::automatic;
  else if (text == "thorough")
    effort = Effort::thorough;
  else
    return core::failure(core::ErrorCode::usage, "setting effort", "\"" + text + "\" is not a known effort",
                         "use quick, auto or thorough");
  return {};
}

core::Status set_number(const Number& n, const std::string& text) {
  const auto v = to_number(text);
  if (!v || *v < n.lo || *v > n.hi || (n.whole && *v != std::floor(*v)))
    return core::failure(core::ErrorCode::usage, "setting " + n.key, "\"" + text + "\" is not allowed",
                         std::string(n.whole ? "use a whole number" : "use a number") + " from " + short_number(n.lo) +
                             " to " + short_number(n.hi));
  if (n.whole)
    *n.whole = static_cast<int>(*v);
  else
    *n.value = *v;
  return {};
}

core::Status unknown(const std::string& key, const std::vector<Number>& table) {
  std::vector<std::string> keys{"effort"};
  for (const Number& n : table) keys.push_back(n.key);
  const std::string near = core::nearest(key, keys);
  std::string list;
  for (const std::string& k : keys) list += (list.empty() ? "" : ", ") + k;
  return core::failure(core::ErrorCode::usage, "setting " + key, "engine best does not know it",
                       (near.empty() ? "" : "did you mean " + near + "? ") + std::string("known: ") + list);
}

}  // namespace

BestSettings::BestSettings() {
  wide.candidates = 300;
  wide.keep_top = 64;
  wide.keep_mid = 16;
  wide.window = 0.45;
  wide.detail.side_cells = 15;
  wide.detail.short_cells = 10;
  wide.detail.mask_cells = 8;
  thorough.detail.side_cells = 20;
  thorough.detail.short_cells = 10;
  thorough.detail.mask_cells = 11;
  thorough.detail.most_work = 500;
  thorough.candidates = 128;
  thorough.keep_top = 48;
  thorough.keep_mid = 16;
  thorough.window = 0.45;
  last.candidates = 400;
  last.keep_top = 48;
  last.keep_mid = 6;
  last.window = 0.45;
}

core::Result<BestSettings> parse_best_settings(const Settings& settings) {
  BestSettings s;
  const std::vector<Number> table = numbers(s);
  for (const auto& [key, text] : settings) {
    core::Status done;
    if (key == "effort") {
      done = set_effort(text, s.effort);
    } else {
      const auto n = std::find_if(table.begin(), table.end(), [&](const Number& t) { return t.key == key; });
      done = n == table.end() ? unknown(key, table) : set_number(*n, text);
    }
    if (!done) return core::forward(done);
  }
  s.quick.detail.min_visible = s.wide.detail.min_visible = s.thorough.detail.min_visible = s.min_visible;
  return s;
}

}  // namespace pickcell::matches
