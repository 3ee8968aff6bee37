#pragma once
/// What a command that runs for long needs of its process: its log where a user sees it, and an end by signal.

#include <csignal>

#include <iosfwd>

namespace pickcell::cli {

/// Warnings and errors of the modules on a stream, as long as it lives.
class LogOnErr {
 public:
  explicit LogOnErr(std::ostream& err);
  ~LogOnErr();
  LogOnErr(const LogOnErr&) = delete;
  LogOnErr& operator=(const LogOnErr&) = delete;

 private:
  int handle_;
};

/// SIGINT (Ctrl-C) and SIGTERM wait here instead of ending the process. To be made before any other thread: those
/// started while it lives leave the signals to wait().
class StopSignals {
 public:
  StopSignals();
  ~StopSignals();
  StopSignals(const StopSignals&) = delete;
  StopSignals& operator=(const StopSignals&) = delete;
  void wait() const;

 private:
  sigset_t signals_{}, before_{};
};

}  // namespace pickcell::cli
