#include "pickcell/cli/process.hpp"

#include <ostream>

#include "pickcell/core/log.hpp"

namespace pickcell::cli {

LogOnErr::LogOnErr(std::ostream& err)
    : handle_(core::add_log_sink([&err](const core::LogEntry& entry) {
        if (entry.level >= core::LogLevel::warning)
          err << "pickcell: " << entry.module << ": " << entry.text << std::endl;
      })) {}

LogOnErr::~LogOnErr() { core::remove_log_sink(handle_); }

StopSignals::StopSignals() {
  sigemptyset(&signals_);
  sigaddset(&signals_, SIGINT);
  sigaddset(&signals_, SIGTERM);
  (void)pthread_sigmask(SIG_BLOCK, &signals_, &before_);
}

StopSignals::~StopSignals() { (void)pthread_sigmask(SIG_SETMASK, &before_, nullptr); }

void StopSignals::wait() const {
  int received = 0;
  (void)sigwait(&signals_, &received);
}

}  // namespace pickcell::cli
