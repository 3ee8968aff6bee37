#include "pickcell/core/clock.hpp"

#include <gtest/gtest.h>

#include <thread>

namespace pickcell::core {
namespace {

using namespace std::chrono_literals;

TEST(SimulatedClock, OnlyOnePartyRunsAtATimeInTheOrderOfTheEvents) {
  SimulatedClock clock;
  std::vector<std::pair<std::string, double>> events;  // unguarded on purpose: the clock itself serialises the parties
  const auto party = [&](std::unique_ptr<Seat> seat, std::string who, Duration step, int n) {
    for (int i = 0; i < n; ++i) {
      seat->sleep_for(step);
      events.emplace_back(who, seconds(seat->now()));
    }
  };
  {
    auto a = clock.join("a");
    auto b = clock.join("b");
    std::jthread ta(party, std::move(a), "a", 10ms, 6);
    std::jthread tb(party, std::move(b), "b", 15ms, 4);
  }
  const std::vector<std::pair<std::string, double>> expected = {{"a", .01}, {"b", .015}, {"a", .02},  {"a", .03},
                                                                {"b", .03}, {"a", .04},  {"b", .045}, {"a", .05},
                                                                {"a", .06}, {"b", .06}};
  EXPECT_EQ(events, expected);
}

TEST(SimulatedClock, TimeStandsStillWhileAPartyIsAwake) {
  SimulatedClock clock;
  auto awake = clock.join("awake");
  bool woke = false;
  std::jthread sleeper([&, seat = clock.join("sleeper")]() mutable {
    seat->sleep_for(1ms);
    woke = true;
  });
  EXPECT_EQ(seconds(clock.now()), 0);
  EXPECT_FALSE(woke);
  awake->sleep_for(2ms);
  EXPECT_TRUE(woke);
  EXPECT_EQ(clock.now().time_since_epoch(), Duration(2ms));
}

TEST(SimulatedClock, ASleeperIsStoppedWhileTimeStandsStill) {
  SimulatedClock clock;
  auto awake = clock.join("awake");  // never sleeps: nobody else's time comes
  auto seat = clock.join("sleeper");
  std::jthread sleeper([&seat] {
    seat->sleep_for(1h);
    seat->sleep_for(1h);
  });
  seat->interrupt();
  sleeper.join();
  seat.reset();
  EXPECT_EQ(seconds(clock.now()), 0);
  awake->sleep_for(1ms);
  EXPECT_EQ(clock.now().time_since_epoch(), Duration(1ms));
}

TEST(RealClock, ASleeperIsStopped) {
  RealClock clock;
  auto seat = clock.join("sleeper");
  std::jthread sleeper([&seat] { seat->sleep_for(1h); });
  seat->interrupt();
  sleeper.join();
  EXPECT_LT(seconds(clock.now()), 60);
}

TEST(RealClock, FollowsTheMachine) {
  RealClock clock;
  auto seat = clock.join("x");
  const TimePoint before = clock.now();
  seat->sleep_for(2ms);
  EXPECT_GE(clock.now() - before, Duration(2ms));
}

}  // namespace
}  // namespace pickcell::core
