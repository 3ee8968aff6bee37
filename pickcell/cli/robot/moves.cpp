#include "pickcell/cli/robot/moves.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <csignal>
#include <thread>

#include "pickcell/core/units.hpp"
#include "pickcell/robot/pose_angles.hpp"
#include "pickcell/robot/readiness.hpp"

namespace pickcell::cli {

using core::ErrorCode;
using core::failure;
using robot::CartesianPosition;
using robot::ControllerLink;
using robot::DirectMove;

namespace {

using WallClock = std::chrono::steady_clock;
constexpr auto kPoll = std::chrono::milliseconds(50);
constexpr auto kServoTime = std::chrono::seconds(5);
constexpr auto kSettles = std::chrono::seconds(1);  ///< an ordered move shows as running by then, an ended one stands

std::atomic<bool> interrupted = false;
extern "C" void interrupt_move(int) { interrupted = true; }

/// Ctrl-C and SIGTERM hold the arm instead of ending the program while this lives.
class HoldOnSignals {
 public:
  HoldOnSignals() : int_(std::signal(SIGINT, interrupt_move)), term_(std::signal(SIGTERM, interrupt_move)) {
    interrupted = false;
  }
  ~HoldOnSignals() {
    (void)std::signal(SIGINT, int_);
    (void)std::signal(SIGTERM, term_);
  }
  HoldOnSignals(const HoldOnSignals&) = delete;
  HoldOnSignals& operator=(const HoldOnSignals&) = delete;

 private:
  using Handler = void (*)(int);
  Handler int_, term_;
};

core::Status unsafe(std::string what, std::string why, std::string remedy) {
  return failure(ErrorCode::safety, std::move(what), std::move(why), std::move(remedy));
}

std::string mm(double v) {
  const std::string text = std::to_string(std::round(v * 10) / 10);
  return text.substr(0, text.find('.') + 2) + " mm";
}

/// After something went wrong: hold, look, tell.
tl::unexpected<core::Error> hold_and_tell(ControllerLink& link, core::Error error) {
  if (!link.connected()) (void)link.connect();
  const auto held = link.hold(true);
  const auto state = link.read_status();
  error.why += held ? "; the arm is held" : "; HOLD COULD NOT BE SENT";
  if (state) error.why += state->running ? ", it still moves" : ", it stands";
  error.remedy = held ? "look at the arm; 'pickcell robot LINK reset' releases the hold" : "press the emergency stop";
  return tl::unexpected(std::move(error));
}

core::Error problem(ControllerLink& link, std::string why) {
  return {ErrorCode::refused, link.peer() + " move", std::move(why), {}, {}};
}

core::Status servo_on(ControllerLink& link) {
  auto state = link.read_status();
  if (!state) return core::forward(state);
  if (state->servo) return {};
  if (auto on = link.servo(true); !on) return on;
  for (const auto end = WallClock::now() + kServoTime; WallClock::now() < end; std::this_thread::sleep_for(kPoll)) {
    state = link.read_status();
    if (!state) return core::forward(state);
    if (state->servo) return {};
  }
  return failure(ErrorCode::timeout, link.peer(), "the servo does not come on",
                 "check emergency stops, doors and the bridge of the external-servo-on input");
}

double expected_s(const DirectMove& move, double way, double turn) {
  constexpr double kSlowestAxis_deg_s = 100;  // at 100 %
  if (move.kind == DirectMove::Kind::joint) return 180 / (kSlowestAxis_deg_s * move.speed / 100);
  return move.turning ? turn / move.speed : way / move.speed;
}

/// Whether the arm went as far and turned as much as it was ordered to.
bool arrived(const CartesianPosition& from, const CartesianPosition& at, double way, double turn) {
  constexpr double kNear_mm = 0.5, kNear_deg = 0.2;
  return std::abs(way_mm(from, at) - way) < kNear_mm &&
         std::abs(turn_deg(from, at) - std::min(turn, std::abs(360 - turn))) < kNear_deg;
}

}  // namespace

double way_mm(const CartesianPosition& a, const CartesianPosition& b) {
  return std::hypot(a.x_mm - b.x_mm, a.y_mm - b.y_mm, a.z_mm - b.z_mm);
}

double turn_deg(const CartesianPosition& a, const CartesianPosition& b) {
  const Eigen::Matrix3d between =
      robot::rotation({a.rx_deg, a.ry_deg, a.rz_deg}).transpose() * robot::rotation({b.rx_deg, b.ry_deg, b.rz_deg});
  return core::deg_from_rad(std::acos(std::clamp((between.trace() - 1) / 2, -1.0, 1.0)));
}

core::Status check_limits(const MoveLimits& l) {
  const auto bad = [](const std::string& option, const std::string& why) {
    return failure(ErrorCode::usage, option, why, "see 'pickcell robot --help'");
  };
  if (!(l.most_pct > 0) || l.most_pct > kTopSpeed_pct) return bad("--max-speed-pct", "must be above 0, at most 25 %");
  if (!(l.most_mm_s > 0) || l.most_mm_s > kTopSpeed_mm_s)
    return bad("--max-speed-mm-s", "must be above 0, at most 250 mm/s");
  if (!(l.speed_pct >= 0.01) || l.speed_pct > l.most_pct)
    return failure(ErrorCode::safety, "--speed-pct", "more than the greatest allowed here, or less than 0.01",
                   "at most 5 % unless --max-speed-pct says otherwise");
  if (!(l.speed_mm_s >= 0.1) || l.speed_mm_s > l.most_mm_s)
    return failure(ErrorCode::safety, "--speed-mm-s", "more than the greatest allowed here, or less than 0.1",
                   "at most 50 mm/s unless --max-speed-mm-s says otherwise");
  if (!(l.most_way_mm > 0) || !(l.most_turn_deg > 0)) return bad("--max-way-mm, --max-turn-deg", "must be above 0");
  if (l.box_mm)
    for (std::size_t i = 0; i < 3; ++i)
      if (!((*l.box_mm)[i] < (*l.box_mm)[i + 3])) return bad("--box", "its lowest corner is not below its highest");
  return {};
}

core::Status may_move(ControllerLink& link, const MoveLimits& limits) {
  if (!limits.allow_motion)
    return unsafe(link.peer(), "this moves the arm", "look that nobody is near it, then add --allow-motion");
  auto state = link.read_status();
  if (!state) return core::forward(state);
  const auto found = robot::hindrances(*state);
  if (!found.empty()) return failure(ErrorCode::refused, link.peer(), found.front().what, found.front().remedy);
  if (state->running)
    return failure(ErrorCode::refused, link.peer(), "a job or move is running", "wait for its end, or hold it");
  return {};
}

core::Status check_target(const CartesianPosition& from, const CartesianPosition& to, const MoveLimits& limits) {
  for (const double v : {to.x_mm, to.y_mm, to.z_mm, to.rx_deg, to.ry_deg, to.rz_deg})
    if (!std::isfinite(v)) return unsafe("target", "is no number", "give numbers");
  const double way = way_mm(from, to), turn = turn_deg(from, to);
  if (way > limits.most_way_mm)
    return unsafe("target", mm(way) + " away, more than " + mm(limits.most_way_mm), "go in steps, or --max-way-mm");
  if (turn > limits.most_turn_deg)
    return unsafe("target", "turns by " + std::to_string(std::lround(turn)) + " degrees",
                  "go in steps, or --max-turn-deg");
  if (!limits.box_mm) return {};
  const std::array<double, 3> p{to.x_mm, to.y_mm, to.z_mm};
  for (std::size_t i = 0; i < 3; ++i)
    if (p[i] < (*limits.box_mm)[i] || p[i] > (*limits.box_mm)[i + 3])
      return unsafe("target", std::string(1, "xyz"[i]) + " = " + mm(p[i]) + " is outside the box", "choose another");
  return {};
}

void set_line_speed(DirectMove& move, double way, double turn, const MoveLimits& limits) {
  move.turning = turn / kTurnSpeed_deg_s > way / limits.speed_mm_s;
  move.speed = move.turning ? kTurnSpeed_deg_s : limits.speed_mm_s;
}

core::Result<Moved> move_and_watch(ControllerLink& link, const DirectMove& move, double way, double turn) {
  const HoldOnSignals signals;
  if (auto on = servo_on(link); !on) return core::forward(on);
  if (interrupted) return tl::unexpected(problem(link, "interrupted before anything was ordered"));
  const auto from = link.read_position(robot::kBaseFrame);
  if (!from) return tl::unexpected(from.error());
  const auto start = WallClock::now();
  if (auto ordered = link.move(move); !ordered) {
    if (ordered.error().code != ErrorCode::link && ordered.error().code != ErrorCode::timeout)
      return core::forward(ordered);  // refused by the controller, or by us before anything was sent
    return hold_and_tell(link, std::move(ordered.error()));  // nobody knows whether it moves
  }
  const auto limit = start + std::chrono::milliseconds(std::lround(1000 * (5 + 2 * expected_s(move, way, turn))));
  for (auto ran = start;;) {
    if (interrupted) return hold_and_tell(link, problem(link, "interrupted"));
    auto state = link.read_status();
    if (!state) return hold_and_tell(link, std::move(state.error()));
    if (const auto found = robot::hindrances(*state); !found.empty())
      return hold_and_tell(link, problem(link, "stopped: " + found.front().what));
    if (!state->servo) return hold_and_tell(link, problem(link, "stopped: servo power went off"));
    if (!state->running) {
      auto at = link.read_position(robot::kBaseFrame);
      if (!at) return hold_and_tell(link, std::move(at.error()));
      if (arrived(*from, *at, way, turn))
        return Moved{*at, std::chrono::duration<double>(WallClock::now() - start).count()};
      if (WallClock::now() > ran + kSettles)
        return hold_and_tell(link, problem(link, "stopped after " + mm(way_mm(*from, *at)) + " of " + mm(way)));
    } else {
      ran = WallClock::now();
    }
    if (WallClock::now() > limit) return hold_and_tell(link, problem(link, "takes longer than it can"));
    std::this_thread::sleep_for(kPoll);
  }
}

}  // namespace pickcell::cli
