// Settings of rst and erst: KEY=VALUE lines as --set brings them, and a TOML file as --params does.

#include <cstdlib>
#include <string>
#include <string_view>

#include "pickcell/core/config.hpp"
#include "pickcell/matches/rst/settings.hpp"

namespace {

using namespace pickcell;

/// A refusal is one line with a remedy; what is accepted gives a list of scales.
void check(const matches::Settings& settings) {
  const auto s = matches::parse_rst_settings(settings, "rst");
  if (!s) {
    const std::string line = s.error().line();
    if (line.find('\n') != std::string::npos || s.error().remedy.empty()) std::abort();
    return;
  }
  if (s->scales.value_or(matches::scales_for({0.8, 1.25}, s->scale_count)).empty()) std::abort();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  matches::Settings lines;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = std::min(text.find('\n', at), text.size());
    const std::string_view line = text.substr(at, end - at);
    const std::size_t equals = std::min(line.find('='), line.size());
    lines[std::string(line.substr(0, equals))] = line.substr(std::min(equals + 1, line.size()));
    at = end + 1;
  }
  check(lines);
  auto file = core::Config::parse(text, "fuzz");
  if (!file) return 0;
  matches::Settings table;
  for (const std::string& key : file->keys()) table[key] = file->text(key);
  if (file->finish()) check(table);
  return 0;
}
