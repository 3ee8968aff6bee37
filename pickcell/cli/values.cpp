#include "pickcell/cli/values.hpp"

#include <charconv>
#include <cmath>

#include "pickcell/core/config.hpp"

namespace pickcell::cli {

namespace {

tl::unexpected<core::Error> refuse(const std::string& option, const std::string& text, const std::string& why,
                                   const std::string& remedy) {
  return core::failure(core::ErrorCode::usage, option, "'" + text + "' " + why, remedy);
}

}  // namespace

core::Result<std::vector<double>> parse_numbers(const std::string& option, const std::string& text) {
  std::vector<double> out;
  const char* at = text.data();
  const char* const end = at + text.size();
  while (true) {
    double value = 0;
    if (end - at > 1 && at[0] == '+' && at[1] != '-') ++at;
    const auto [next, error] = std::from_chars(at, end, value);
    if (error != std::errc{} || (next != end && *next != ','))
      return refuse(option, text, "is not a list of numbers", "write numbers with commas between them, like 1,2.5");
    if (!std::isfinite(value)) return refuse(option, text, "holds a number that is not finite", "write plain numbers");
    out.push_back(value);
    if (next == end) return out;
    at = next + 1;
  }
}

core::Result<std::vector<double>> parse_numbers(const std::string& option, const std::string& text, std::size_t least,
                                                std::size_t most) {
  auto out = parse_numbers(option, text);
  if (out && (out->size() < least || out->size() > most))
    return refuse(option, text, "has " + std::to_string(out->size()) + (out->size() == 1 ? " number" : " numbers"),
                  "give " + std::to_string(least) + (most > least ? " to " + std::to_string(most) : ""));
  return out;
}

core::Result<int> parse_threads(const std::string& text) {
  if (text == "all") return 0;
  const auto numbers = parse_numbers("--threads", text);
  const double n = numbers && numbers->size() == 1 ? numbers->front() : 0;
  if (n < 1 || n > 1024 || n != std::floor(n))
    return refuse("--threads", text, "is not a number of threads", "use 1, 2, ... or all");
  return static_cast<int>(n);
}

core::Result<matches::Range> parse_range(const std::string& option, const std::string& text) {
  const auto numbers = parse_numbers(option, text);
  if (!numbers) return tl::unexpected(numbers.error());
  if (numbers->size() != 2) return refuse(option, text, "is not a range", "write lo,hi");
  const matches::Range range{(*numbers)[0], (*numbers)[1]};
  if (range.lo > range.hi)
    return refuse(option, text, "is reversed", "write the smaller number first (angles may run past 180: 170,190)");
  return range;
}

core::Result<matches::SearchOptions::Roi> parse_roi(const std::string& option, const std::string& text) {
  const auto numbers = parse_numbers(option, text);
  if (!numbers) return tl::unexpected(numbers.error());
  bool fine = numbers->size() == 4;
  for (const double v : *numbers) fine = fine && v == std::floor(v) && std::abs(v) < 1e6;
  if (!fine || (*numbers)[2] < 1 || (*numbers)[3] < 1)
    return refuse(option, text, "is not a rectangle", "write x,y,w,h in whole pixels, w and h at least 1");
  const auto whole = [&](std::size_t i) { return static_cast<int>((*numbers)[i]); };
  return matches::SearchOptions::Roi{whole(0), whole(1), whole(2), whole(3)};
}

core::Result<matches::Settings> parse_settings(const std::vector<std::string>& key_values,
                                               const std::string& params_file) {
  matches::Settings settings;
  if (!params_file.empty()) {
    auto file = core::Config::load(params_file);
    if (!file) return core::forward(file);
    for (const std::string& key : file->keys()) settings[key] = file->text(key);
    if (auto fine = file->finish(); !fine) return core::forward(fine);
  }
  for (const std::string& pair : key_values) {
    const std::size_t equals = pair.find('=');
    if (equals == std::string::npos || equals == 0)
      return refuse("--set", pair, "is not a setting", "write --set KEY=VALUE");
    settings[pair.substr(0, equals)] = pair.substr(equals + 1);
  }
  return settings;
}

core::Status check_not_input(const std::filesystem::path& output, const std::vector<std::string>& inputs) {
  for (const std::string& input : inputs) {
    std::error_code missing;  // a file that is not there yet is none of the inputs
    if (!input.empty() && std::filesystem::equivalent(output, input, missing))
      return core::failure(core::ErrorCode::usage, output.string(), "is to be read and written",
                           "name another file for the result");
  }
  return {};
}

}  // namespace pickcell::cli
