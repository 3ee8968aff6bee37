#pragma once
/// Where modules say what happened. Modules never print: sinks (stderr, a file, the HMI's log) are attached by the
/// program.

#include <cstdint>
#include <functional>
#include <string>
#include <string_view>

namespace pickcell::core {

enum class LogLevel { debug, info, warning, error };

struct LogEntry {
  std::int64_t unix_us;
  LogLevel level;
  std::string module;
  std::string text;
};

[[nodiscard]] std::string_view name(LogLevel level);

/// Adds a receiver for every later entry; called under a lock, in the writer's thread, and must not log itself.
/// Returns a handle for remove_log_sink. Thread-safe.
int add_log_sink(std::function<void(const LogEntry&)> sink);
void remove_log_sink(int handle);

/// Thread-safe.
void log(LogLevel level, std::string_view module, std::string text);

}  // namespace pickcell::core
