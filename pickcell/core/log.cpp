#include "pickcell/core/log.hpp"

#include <chrono>
#include <map>
#include <mutex>
#include <utility>

namespace pickcell::core {

namespace {

struct Sinks {
  std::mutex mutex;
  std::map<int, std::function<void(const LogEntry&)>> by_handle;
  int next = 1;
};

Sinks& sinks() {
  static Sinks instance;
  return instance;
}

}  // namespace

std::string_view name(LogLevel level) {
  switch (level) {
    case LogLevel::debug:
      return "debug";
    case LogLevel::info:
      return "info";
    case LogLevel::warning:
      return "warning";
    case LogLevel::error:
      return "error";
  }
  return "error";
}

int add_log_sink(std::function<void(const LogEntry&)> sink) {
  const std::lock_guard lock(sinks().mutex);
  const int handle = sinks().next++;
  sinks().by_handle.emplace(handle, std::move(sink));
  return handle;
}

void remove_log_sink(int handle) {
  const std::lock_guard lock(sinks().mutex);
  sinks().by_handle.erase(handle);
}

void log(LogLevel level, std::string_view module, std::string text) {
  using namespace std::chrono;
  const LogEntry entry{duration_cast<microseconds>(system_clock::now().time_since_epoch()).count(), level,
                       std::string(module), std::move(text)};
  const std::lock_guard lock(sinks().mutex);
  for (const auto& [handle, sink] : sinks().by_handle) sink(entry);
}

}  // namespace pickcell::core
