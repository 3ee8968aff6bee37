#pragma once
/// An arm and a camera over one table that do exactly what a test says, on a simulated clock.

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <mutex>

#include "pickcell/cell/cell.hpp"
#include "pickcell/core/units.hpp"

namespace pickcell::cell::scripted {

using core::duration_s;
using robot::Outcome;
using robot::OutcomeKind;
using robot::RobotState;

constexpr int kWidthPx = 640, kHeightPx = 480;

/// Parts on the table as the camera sees them: 1 mm per pixel, picture centre at base x = 400, y = 0.
struct Table {
  struct Lying {
    double x_px, y_px;
    double score = 0.95;
    std::vector<double> ambiguous_deg;
    double sigma_px = 0.05;
  };
  std::vector<Lying> parts;

  /// The part under a tool, or -1.
  [[nodiscard]] int under(const Eigen::Vector3d& tool_m) const {
    for (std::size_t i = 0; i < parts.size(); ++i) {
      const double x_m = 0.4 + (parts[i].x_px - (kWidthPx - 1) / 2.0) * 1e-3;
      const double y_m = -(parts[i].y_px - (kHeightPx - 1) / 2.0) * 1e-3;
      if (std::hypot(tool_m.x() - x_m, tool_m.y() - y_m) < 0.002) return static_cast<int>(i);
    }
    return -1;
  }
};

class TableCamera final : public frames::FrameSource {
 public:
  explicit TableCamera(core::Clock& clock) : clock_(clock) {}
  [[nodiscard]] frames::SourceInfo info() const override { return {"cam", kWidthPx, kHeightPx, true}; }
  [[nodiscard]] core::Result<frames::Frame> grab(core::Seat& seat, core::Duration) override {
    seat.sleep_for(duration_s(0.02));
    frames::Frame frame;
    frame.picture = std::make_shared<const image::Image>(kWidthPx, kHeightPx);
    frame.sequence = ++sequence_;
    frame.exposed = seat.now();
    frame.exposed_unix_us = clock_.unix_us();
    frame.camera_id = camera_id;
    return frame;
  }
  std::string camera_id = "cam";

 private:
  core::Clock& clock_;
  std::uint64_t sequence_ = 0;
};

class TableEngine final : public matches::Engine {
 public:
  explicit TableEngine(const Table& table) : table_(table) {}
  [[nodiscard]] core::Result<matches::FindResult> find(const image::Pyramid&,
                                                       std::span<const matches::Model* const> models,
                                                       const matches::SearchOptions&) override {
    matches::FindResult out;
    for (const Table::Lying& part : table_.parts) {
      matches::Match m;
      m.model = models[0]->name;
      m.pose = {part.x_px, part.y_px, 0, 1};
      m.score = part.score;
      m.ambiguous_deg = part.ambiguous_deg;
      m.covariance.diagonal() << part.sigma_px * part.sigma_px, part.sigma_px * part.sigma_px, 0.0025, 1e-8;
      out.matches.push_back(m);
    }
    return out;
  }
  [[nodiscard]] std::string name() const override { return "table"; }

 private:
  const Table& table_;
};

/// Takes two seconds for a pick. What happens to the n-th pick (from 1) is said in `script`.
class TableRobot final : public robot::Robot {
 public:
  struct Event {
    double after_s = 1.0;                              ///< after the hand-over
    std::function<void(RobotState&)> change;           ///< of the arm's state
    std::optional<Outcome> outcome;                    ///< instead of done
    bool lose_link = false, carries_on_alone = false;  ///< the pick ends although nobody watches
    std::optional<core::Error> refuse_submit;
    bool never_ends = false;
  };
  TableRobot(core::Clock& clock, Table& table) : clock_(clock), table_(table) {
    state_.play = state_.remote = state_.clear_of_camera = true;
  }

  [[nodiscard]] core::Status connect(core::Seat&) override {
    ++connects;
    if (refuse_connect) return core::failure(core::ErrorCode::link, "robot", "connection refused");
    connected_ = true;
    settle_lost_pick();
    if (person_needed) return core::failure(core::ErrorCode::refused, "robot", "an outcome is unknown", "look");
    return {};
  }
  [[nodiscard]] bool connected() const override { return connected_; }
  [[nodiscard]] core::Result<RobotState> state() override {
    if (auto fault = play_script(); !fault) return core::forward(fault);
    return state_;
  }
  [[nodiscard]] core::Result<std::vector<robot::Alarm>> alarms() override {
    return std::vector<robot::Alarm>{{4315, 1, "COLLISION DETECT"}};
  }
  [[nodiscard]] core::Result<core::Transform<core::Base, core::Tool>> pose() override {
    if (other_tool) return core::failure(core::ErrorCode::refused, "robot", "tool 3 is selected");
    return core::Transform<core::Base, core::Tool>();
  }
  [[nodiscard]] core::Status start(core::Seat&) override {
    ++starts;
    if (person_needed) return core::failure(core::ErrorCode::refused, "robot", "an outcome is unknown", "look");
    state_.servo = state_.running = true;
    if (open_ && !open_->reported) finish_open();
    return {};
  }
  [[nodiscard]] core::Status confirm(core::Seat&) override {
    ++confirms;
    person_needed = false;
    return {};
  }
  [[nodiscard]] std::vector<Outcome> take_settled() override { return std::exchange(settled_, {}); }
  [[nodiscard]] core::Result<std::int32_t> submit(const picks::Pick& pick) override {
    const Event event = script.contains(sequence_ + 1) ? script[sequence_ + 1] : Event{};
    ++sequence_;
    if (event.refuse_submit) return tl::unexpected(*event.refuse_submit);
    submitted.push_back(pick);
    open_ = Open{pick, event, clock_.now(), false, false};
    return sequence_;
  }
  [[nodiscard]] core::Result<std::optional<Outcome>> outcome() override {
    if (open_->event.never_ends || clock_.now() - open_->begun < duration_s(2)) return std::optional<Outcome>();
    Outcome out = open_->event.outcome.value_or(Outcome{OutcomeKind::done, sequence_, 0, "done"});
    out.sequence = sequence_;
    if (out.kind == OutcomeKind::done) lift(open_->pick);
    if (out.kind == OutcomeKind::unknown) person_needed = true;
    open_.reset();
    return std::optional<Outcome>(out);
  }
  [[nodiscard]] core::Status hold(bool on) override {
    holds += on;
    state_.hold_command = on;
    return {};
  }
  [[nodiscard]] core::Status reset() override {
    state_.alarm = false;
    return {};
  }
  [[nodiscard]] core::Status write_contact(int contact, bool on) override {
    EXPECT_EQ(contact, 27010);
    const bool was_on = std::exchange(advance_on, on), edge = on && !was_on;
    if (edge && !belt_stuck) belt_until_ = clock_.now() + duration_s(1.5);
    if (edge && next_parts) table_.parts = next_parts();
    return {};
  }
  [[nodiscard]] core::Result<bool> read_contact(int contact) override {
    if (contact == 27010) return advance_on;
    EXPECT_EQ(contact, 11);
    return clock_.now() < belt_until_;
  }
  void disconnect() override { connected_ = false; }

  RobotState& arm() { return state_; }
  std::map<int, Event> script;
  bool other_tool = false, belt_stuck = false;
  bool advance_on = false;  ///< the network input that the feeder waits for an edge of
  std::function<std::vector<Table::Lying>()> next_parts;
  std::vector<picks::Pick> submitted;
  std::vector<Table::Lying> lifted;
  int starts = 0, connects = 0, confirms = 0, holds = 0;
  bool refuse_connect = false, person_needed = false;
  std::optional<core::TimePoint> changed_at;  ///< when the script last changed something

 private:
  struct Open {
    picks::Pick pick;
    Event event;
    core::TimePoint begun;
    bool played, reported;
  };
  core::Status play_script() {
    if (!connected_) return core::failure(core::ErrorCode::link, "robot", "not connected");
    if (!open_ || open_->played || clock_.now() - open_->begun < duration_s(open_->event.after_s)) return {};
    open_->played = true;
    if (open_->event.change) {
      open_->event.change(state_);
      changed_at = clock_.now();
    }
    if (open_->event.lose_link) {
      changed_at = clock_.now();
      connected_ = false;
      return core::failure(core::ErrorCode::link, "robot", "connection reset by peer");
    }
    return {};
  }
  void settle_lost_pick() {
    if (open_ && open_->event.carries_on_alone) finish_open();
  }
  void finish_open() {
    lift(open_->pick);
    settled_.push_back({OutcomeKind::done, sequence_, 0, "done"});
    open_.reset();
  }
  void lift(const picks::Pick& pick) {
    const int i = table_.under(pick.T_base_grasp.translation_m());
    ASSERT_GE(i, 0) << "nothing lies where the arm grips: a part was picked twice";
    lifted.push_back(table_.parts[static_cast<std::size_t>(i)]);
    table_.parts.erase(table_.parts.begin() + i);
  }

  core::Clock& clock_;
  Table& table_;
  RobotState state_;
  bool connected_ = false;
  std::int32_t sequence_ = 0;
  std::optional<Open> open_;
  std::vector<Outcome> settled_;
  core::TimePoint belt_until_{};
};

inline matches::Model square_model() {
  matches::Model model;
  model.name = "square";
  model.picture = image::Image(41, 41);
  model.ref_x_px = model.ref_y_px = 20;
  model.learnt.suggested_min_score = 0.7;
  model.grasps = {{20, 20, 0, true}};
  return model;
}

}  // namespace pickcell::cell::scripted
