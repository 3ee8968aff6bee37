#pragma once
/// How the engine shares its work over threads and stops when its time is up.

#include <atomic>
#include <functional>
#include <optional>

namespace pickcell::matches {

/// Milliseconds of CPU time of the calling thread.
[[nodiscard]] double thread_cpu_ms();

/// A limit on the caller's CPU time. spent() may be asked from any thread; only the thread that made the budget looks
/// at the clock, the others see what it found.
class WorkBudget {
 public:
  using CpuClock = std::function<double()>;
  /// whole_ms: at most what may be used when the best there is shall still be followed to its end; unset: the limit.
  explicit WorkBudget(std::optional<double> limit_ms = {}, CpuClock clock = thread_cpu_ms,
                      std::optional<double> whole_ms = {});
  /// True once the limit has been reached; stays true.
  [[nodiscard]] bool spent();
  /// True once the whole has been used up: then nothing is finished either. Any thread, as spent().
  [[nodiscard]] bool used_up();
  /// The longest time between two looks at the clock so far: by so much a search may go on after its end.
  [[nodiscard]] double longest_step_ms() const { return longest_step_ms_; }

 private:
  std::optional<double> limit_ms_;
  CpuClock clock_;
  double start_ms_;
  double last_look_ms_;
  double longest_step_ms_ = 0;
  double whole_ms_;
  std::atomic<bool> spent_{false}, used_up_{false};
  std::size_t owner_;
};

/// Calls body(index, worker) for every index in [0, count), worker in [0, threads). The caller is worker 0. Which
/// worker gets which index is not fixed, so a body writes only to its index' own place. With one thread nothing is
/// allocated.
void parallel_for_threads(int count, int threads, const std::function<void(int index, int worker)>& body);

template <class Body>
void parallel_for(int count, int threads, const Body& body) {
  if (threads > 1 && count > 1) return parallel_for_threads(count, threads, std::cref(body));
  for (int i = 0; i < count; ++i) body(i, 0);
}

/// 0 stands for all.
[[nodiscard]] int thread_count(int asked);

}  // namespace pickcell::matches
