#include "pickcell/cli/machine.hpp"

#include <fstream>
#include <thread>

#include "pickcell/matches/engine.hpp"

namespace pickcell::cli {

namespace {

/// A board names itself in the device tree, a PC its processor in cpuinfo.
std::string processor() {
  std::string line;
  if (std::ifstream board("/proc/device-tree/model"); std::getline(board, line, '\0') && !line.empty()) return line;
  std::ifstream info("/proc/cpuinfo");
  while (std::getline(info, line)) {
    if (!line.starts_with("model name")) continue;
    const std::size_t value = line.find_first_not_of(" \t", line.find(':') + 1);
    if (value != std::string::npos) return line.substr(value);
  }
  return "unknown processor";
}

}  // namespace

std::string machine() {
  const auto engine = matches::make_engine("rst", {});
  return processor() + ", " + std::to_string(std::thread::hardware_concurrency()) + " threads" +
         (engine ? ", " + (*engine)->isa() : "");
}

}  // namespace pickcell::cli
