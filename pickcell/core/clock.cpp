#include "pickcell/core/clock.hpp"

#include <algorithm>
#include <tuple>
#include <utility>

namespace pickcell::core {

namespace {

std::int64_t system_unix_us() {
  return std::chrono::duration_cast<std::chrono::microseconds>(std::chrono::system_clock::now().time_since_epoch())
      .count();
}

class RealSeat final : public Seat {
 public:
  RealSeat(const RealClock& clock, std::chrono::steady_clock::time_point start) : clock_(clock), start_(start) {}
  [[nodiscard]] TimePoint now() const override { return clock_.now(); }
  void sleep_until(TimePoint t) override {
    std::unique_lock lock(mutex_);
    stirred_.wait_until(lock, start_ + t.time_since_epoch(), [this] { return interrupted_; });
  }
  void interrupt() override {
    const std::lock_guard lock(mutex_);
    interrupted_ = true;
    stirred_.notify_all();
  }

 private:
  const RealClock& clock_;
  std::chrono::steady_clock::time_point start_;
  std::mutex mutex_;
  std::condition_variable stirred_;
  bool interrupted_ = false;
};

}  // namespace

RealClock::RealClock() : start_(std::chrono::steady_clock::now()), start_unix_us_(system_unix_us()) {}

TimePoint RealClock::now() const { return TimePoint(std::chrono::steady_clock::now() - start_); }

std::int64_t RealClock::unix_us() const {
  return start_unix_us_ + std::chrono::duration_cast<std::chrono::microseconds>(now().time_since_epoch()).count();
}

std::unique_ptr<Seat> RealClock::join(std::string) { return std::make_unique<RealSeat>(*this, start_); }

class SimulatedClock::SimulatedSeat final : public Seat {
 public:
  SimulatedSeat(SimulatedClock& clock, Party& party) : clock_(clock), party_(party) {}
  ~SimulatedSeat() override { clock_.leave(party_); }
  [[nodiscard]] TimePoint now() const override { return clock_.now(); }
  void sleep_until(TimePoint t) override { clock_.sleep_until(party_, t); }
  void interrupt() override { clock_.interrupt(party_); }

 private:
  SimulatedClock& clock_;
  Party& party_;
};

SimulatedClock::SimulatedClock(std::int64_t unix_start_us) : unix_start_us_(unix_start_us) {}

TimePoint SimulatedClock::now() const {
  const std::lock_guard lock(mutex_);
  return now_;
}

std::int64_t SimulatedClock::unix_us() const {
  return unix_start_us_ + std::chrono::duration_cast<std::chrono::microseconds>(now().time_since_epoch()).count();
}

std::unique_ptr<Seat> SimulatedClock::join(std::string party) {
  const std::lock_guard lock(mutex_);
  parties_.push_back(std::make_unique<Party>(Party{std::move(party), false, {}, false}));
  return std::make_unique<SimulatedSeat>(*this, *parties_.back());
}

void SimulatedClock::sleep_until(Party& party, TimePoint t) {
  std::unique_lock lock(mutex_);
  if (party.interrupted) return;
  party.sleeping = true;
  party.wake = std::max(t, now_);
  advance_locked();
  changed_.wait(lock, [&] { return !party.sleeping; });
}

void SimulatedClock::interrupt(Party& party) {
  const std::lock_guard lock(mutex_);
  party.interrupted = true;
  party.sleeping = false;
  changed_.notify_all();
}

void SimulatedClock::leave(Party& party) {
  const std::lock_guard lock(mutex_);
  std::erase_if(parties_, [&](const auto& p) { return p.get() == &party; });
  advance_locked();
}

void SimulatedClock::advance_locked() {
  if (parties_.empty()) return;
  if (!std::all_of(parties_.begin(), parties_.end(), [](const auto& p) { return p->sleeping; })) return;
  const auto next = std::min_element(parties_.begin(), parties_.end(), [](const auto& a, const auto& b) {
    return std::tie(a->wake, a->name) < std::tie(b->wake, b->name);
  });
  now_ = (*next)->wake;
  (*next)->sleeping = false;
  changed_.notify_all();
}

}  // namespace pickcell::core
