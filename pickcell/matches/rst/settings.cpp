#include "pickcell/matches/rst/settings.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <functional>
#include <string>

#include "pickcell/core/config.hpp"
#include "pickcell/matches/limits.hpp"

namespace pickcell::matches {
namespace {

constexpr int kMostScales = 32;

/// What was written, fit for one line of a terminal.
std::string shown(std::string_view text) {
  constexpr std::size_t kMost = 40;
  std::string out(text.substr(0, kMost));
  for (char& c : out)
    if (static_cast<unsigned char>(c) < ' ' || c == 127) c = '?';
  return text.size() > kMost ? out + "..." : out;
}

core::Status refuse(const std::string& key, const std::string& text, const std::string& remedy) {
  return core::failure(core::ErrorCode::usage, "setting " + key, "\"" + shown(text) + "\" is not allowed", remedy);
}

std::optional<double> to_number(std::string_view text) {
  double v = 0;
  const auto r = std::from_chars(text.data(), text.data() + text.size(), v);
  if (r.ec != std::errc() || r.ptr != text.data() + text.size() || !std::isfinite(v)) return {};
  return v;
}

/// One key: reads the text into the settings, or says what it must be.
struct Key {
  std::string name;
  std::string expected;
  std::function<bool(RstSettings&, const std::string&)> read;
};

template <class Member>
Key number(const std::string& name, double lo, double hi, Member member) {
  char range[80];
  std::snprintf(range, sizeof range, "use a number from %g to %g", lo, hi);
  return {name, range, [=](RstSettings& s, const std::string& text) {
            const auto v = to_number(text);
            if (!v || *v < lo || *v > hi) return false;
            s.*member = *v;
            return true;
          }};
}

template <class Member>
Key whole(const std::string& name, int lo, int hi, Member member) {
  return {name, "use a whole number from " + std::to_string(lo) + " to " + std::to_string(hi),
          [=](RstSettings& s, const std::string& text) {
            const auto v = to_number(text);
            if (!v || *v < lo || *v > hi || *v != std::floor(*v)) return false;
            s.*member = static_cast<int>(*v);
            return true;
          }};
}

template <class T>
Key word(const std::string& name, const std::vector<std::pair<std::string, T>>& words, T RstSettings::* member) {
  std::string expected = "use ";
  for (std::size_t i = 0; i < words.size(); ++i)
    expected += (i == 0 ? "" : i + 1 == words.size() ? " or " : ", ") + words[i].first;
  return {name, expected, [=](RstSettings& s, const std::string& text) {
            for (const auto& [spelling, value] : words)
              if (spelling == text) {
                s.*member = value;
                return true;
              }
            return false;
          }};
}

bool read_scales(RstSettings& s, const std::string& text) {
  std::vector<double> out;
  for (std::size_t at = 0; at <= text.size();) {
    const std::size_t comma = std::min(text.find(',', at), text.size());
    const auto v = to_number(std::string_view(text).substr(at, comma - at));
    if (!v || *v < kMinScale || *v > kMaxScale) return false;
    out.push_back(*v);
    at = comma + 1;
  }
  std::sort(out.begin(), out.end());
  if (out.size() > kMostScales || std::adjacent_find(out.begin(), out.end()) != out.end()) return false;
  s.scales = std::move(out);
  return true;
}

bool read_alpha(RstSettings& s, const std::string& text) {
  const auto v = to_number(text);
  if (!v || *v < 1 || *v > 90 || *v != std::floor(*v) || 360 % static_cast<int>(*v) != 0) return false;
  s.angle_step_deg = static_cast<int>(*v);
  return true;
}

const std::vector<Key>& keys() {
  static const std::vector<std::pair<std::string, bool>> kSwitch{
      {"0", false}, {"1", true}, {"false", false}, {"true", true}};
  static const std::vector<Key> all{
      whole("NP", 0, 5, &RstSettings::pyramid_level),
      whole("NS", 1, kMostScales, &RstSettings::scale_count),
      {"scales", "use up to 32 different numbers from 0.1 to 10, like 0.9,1,1.1", read_scales},
      word<PyramidFilter>("pyramid", {{"box", PyramidFilter::box}, {"binomial", PyramidFilter::binomial}},
                          &RstSettings::pyramid),
      whole("smooth", 0, 8, &RstSettings::smooth),
      whole("NC", 3, 64, &RstSettings::circles),
      {"alpha", "use a whole number of degrees that divides 360, from 1 to 90", read_alpha},
      number("t1", -1, 1, &RstSettings::t1),
      number("t2", -1, 1, &RstSettings::t2),
      number("t3", -1, 1, &RstSettings::t3),
      number("t4", -1, 1, &RstSettings::t4),
      word<RadialLength>("radial_length", {{"largest", RadialLength::largest}, {"matched", RadialLength::matched}},
                         &RstSettings::radial_length),
      whole("step3_tolerance", 0, 1, &RstSettings::step3_tolerance),
      number("suppress", 0, 100, &RstSettings::suppress_px),
      number("t_contrast", 0, 1, &RstSettings::t_contrast),
      number("t_brightness", 0, 1, &RstSettings::t_brightness),
      word<bool>("match_negative", kSwitch, &RstSettings::match_negative),
      word<WindowMask>("mask", {{"rect", WindowMask::rect}, {"disc", WindowMask::disc}}, &RstSettings::mask),
      word<LocationSearch>("location",
                           {{"halving", LocationSearch::halving},
                            {"quadrant", LocationSearch::quadrant},
                            {"symmetric", LocationSearch::symmetric}},
                           &RstSettings::location),
      number("min_inside", 0.3, 1, &RstSettings::min_inside),
      word<bool>("refine", {{"none", false}, {"subpixel", true}}, &RstSettings::refine_subpixel),
  };
  return all;
}

core::Status unknown(const std::string& key, std::string_view engine) {
  std::vector<std::string> names;
  std::string list;
  for (const Key& k : keys()) {
    names.push_back(k.name);
    list += (list.empty() ? "" : ", ") + k.name;
  }
  const std::string near = core::nearest(key, names);
  return core::failure(core::ErrorCode::usage, "setting " + shown(key),
                       "engine " + std::string(engine) + " does not know it",
                       (near.empty() ? "" : "did you mean " + near + "? ") + std::string("known: ") + list);
}

}  // namespace

core::Result<RstSettings> parse_rst_settings(const Settings& settings, std::string_view engine) {
  RstSettings s;
  for (const auto& [key, text] : settings) {
    const auto known = std::find_if(keys().begin(), keys().end(), [&](const Key& k) { return k.name == key; });
    core::Status done;
    if (known == keys().end())
      done = unknown(key, engine);
    else if (!known->read(s, text))
      done = refuse(key, text, known->expected);
    if (!done) return core::forward(done);
  }
  if (s.scales && s.scale_count && *s.scale_count != static_cast<int>(s.scales->size()))
    return core::failure(core::ErrorCode::usage, "setting NS", "it contradicts the list of scales", "leave NS out");
  return s;
}

int pyramid_level_for(int width, int height) {
  return std::clamp(static_cast<int>(std::floor(std::log2(std::sqrt(static_cast<double>(width) * height) / 25.0))), 1,
                    3);
}

std::vector<double> scales_for(Range range, std::optional<int> count) {
  if (!count && range.lo == 0.9 && range.hi == 1.1) return {0.9, 1.0, 1.1};
  const double span = std::log(range.hi / range.lo);
  const int n = count.value_or(1 + static_cast<int>(std::ceil(span / std::log(1.12) - 1e-9)));
  if (n == 1 || span <= 0) return {std::sqrt(range.lo * range.hi)};
  std::vector<double> out;
  for (int i = 0; i < n; ++i) out.push_back(range.lo * std::exp(span * i / (n - 1)));
  return out;
}

}  // namespace pickcell::matches
