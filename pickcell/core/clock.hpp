#pragma once
/// One notion of time for every process deadline. A real clock follows the machine; a simulated one jumps to the next
/// event when every party waits for it, one party at a time, so that a run is the same every time and as fast as the
/// machine.

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

namespace pickcell::core {

using Duration = std::chrono::nanoseconds;

/// Tag of the cell's time: monotonic, zero at the start of the clock.
struct CellEpoch {
  using rep = std::int64_t;
  using period = std::nano;
  using duration = Duration;
};
using TimePoint = std::chrono::time_point<CellEpoch, Duration>;

constexpr double seconds(Duration d) { return std::chrono::duration<double>(d).count(); }
inline double seconds(TimePoint t) { return seconds(t.time_since_epoch()); }
inline Duration duration_s(double s) { return std::chrono::duration_cast<Duration>(std::chrono::duration<double>(s)); }

/// A party's right to wait on a clock; one per thread that lives in the clock's time. Not thread-safe itself: one
/// thread uses one seat; only interrupt() may come from any thread. While a seat exists and its owner does not sleep on
/// it, simulated time stands still.
class Seat {
 public:
  virtual ~Seat() = default;
  [[nodiscard]] virtual TimePoint now() const = 0;
  /// Returns when the time has come; at once when it has passed, or after interrupt().
  virtual void sleep_until(TimePoint t) = 0;
  /// For stopping a party from outside, whether time moves or stands: the sleep in progress and every later one on this
  /// seat return at once. Final. The party sees why by a stop flag of its own, and gives up its seat. Thread-safe.
  virtual void interrupt() = 0;
  void sleep_for(Duration d) { sleep_until(now() + d); }
};

class Clock {
 public:
  virtual ~Clock() = default;
  [[nodiscard]] virtual TimePoint now() const = 0;
  /// Wall time that belongs to now(), microseconds since the UNIX epoch.
  [[nodiscard]] virtual std::int64_t unix_us() const = 0;
  /// Takes a seat. Parties that wake at the same time do so one after the other, in the order of their names.
  [[nodiscard]] virtual std::unique_ptr<Seat> join(std::string party) = 0;
  [[nodiscard]] virtual bool simulated() const = 0;
};

/// Follows std::chrono::steady_clock. Thread-safe.
class RealClock final : public Clock {
 public:
  RealClock();
  [[nodiscard]] TimePoint now() const override;
  [[nodiscard]] std::int64_t unix_us() const override;
  [[nodiscard]] std::unique_ptr<Seat> join(std::string party) override;
  [[nodiscard]] bool simulated() const override { return false; }

 private:
  std::chrono::steady_clock::time_point start_;
  std::int64_t start_unix_us_;
};

/// Discrete-event clock. Time moves only when every seat sleeps; then exactly one seat, the earliest (ties: by name),
/// runs until it sleeps again. Threads without a seat (socket servers) may run at any moment and must only react. All
/// parties should have joined before the first one sleeps, or hold a seat open for them. Thread-safe.
class SimulatedClock final : public Clock {
 public:
  /// unix_start_us: the wall time that simulated time zero stands for.
  explicit SimulatedClock(std::int64_t unix_start_us = 1'767'225'600'000'000);
  [[nodiscard]] TimePoint now() const override;
  [[nodiscard]] std::int64_t unix_us() const override;
  [[nodiscard]] std::unique_ptr<Seat> join(std::string party) override;
  [[nodiscard]] bool simulated() const override { return true; }

 private:
  class SimulatedSeat;
  struct Party {
    std::string name;
    bool sleeping = false;
    TimePoint wake{};
    bool interrupted = false;
  };
  void sleep_until(Party& party, TimePoint t);
  void interrupt(Party& party);
  void leave(Party& party);
  void advance_locked();

  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::vector<std::unique_ptr<Party>> parties_;
  TimePoint now_{};
  std::int64_t unix_start_us_;
};

}  // namespace pickcell::core
