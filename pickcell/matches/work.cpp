#include "pickcell/matches/work.hpp"

#include <time.h>

#include <algorithm>
#include <exception>
#include <mutex>
#include <thread>
#include <utility>
#include <vector>

namespace pickcell::matches {
namespace {
std::size_t this_thread() { return std::hash<std::thread::id>()(std::this_thread::get_id()); }
}  // namespace

double thread_cpu_ms() {
  timespec t{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) * 1e3 + static_cast<double>(t.tv_nsec) * 1e-6;
}

WorkBudget::WorkBudget(std::optional<double> limit_ms, CpuClock clock, std::optional<double> whole_ms)
    : limit_ms_(limit_ms),
      clock_(std::move(clock)),
      start_ms_(limit_ms ? clock_() : 0),
      last_look_ms_(start_ms_),
      whole_ms_(whole_ms.value_or(limit_ms.value_or(0))),
      owner_(this_thread()) {}

bool WorkBudget::spent() {
  if (!limit_ms_) return false;
  if (spent_ || this_thread() != owner_) return spent_;
  const double now_ms = clock_();
  longest_step_ms_ = std::max(longest_step_ms_, now_ms - last_look_ms_);
  last_look_ms_ = now_ms;
  if (now_ms - start_ms_ >= *limit_ms_) spent_ = true;
  return spent_;
}

bool WorkBudget::used_up() {
  if (!spent()) return false;
  if (!used_up_ && this_thread() == owner_ && clock_() - start_ms_ >= whole_ms_) used_up_ = true;
  return used_up_;
}

void parallel_for_threads(int count, int threads, const std::function<void(int, int)>& body) {
  threads = std::min(threads, count);
  std::atomic<int> next{0};
  std::exception_ptr thrown;
  std::mutex guard;
  const auto run = [&](int worker) {
    try {
      for (int i = next++; i < count; i = next++) body(i, worker);
    } catch (...) {
      const std::lock_guard lock(guard);
      thrown = std::current_exception();
    }
  };
  {
    std::vector<std::jthread> others;
    for (int w = 1; w < threads; ++w) others.emplace_back(run, w);
    run(0);
  }
  if (thrown) std::rethrow_exception(thrown);
}

int thread_count(int asked) {
  return asked > 0 ? asked : std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
}

}  // namespace pickcell::matches
