// Both protocols at once on one simulated controller: whatever one client writes or orders, the other sees, and both
// say the same about the state.

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "pickcell/robot/hses_client.hpp"
#include "pickcell/robot/pose_angles.hpp"
#include "pickcell/robot/tcp80_client.hpp"
#include "pickcell/sim/controller.hpp"
#include "pickcell/sim/shipped_jobs.hpp"

namespace pickcell {
namespace {

using robot::CartesianPosition;
using robot::ControllerLink;
using robot::RobotState;
using robot::VariableType;

class LinksAgree : public ::testing::Test {
 protected:
  void SetUp() override {
    sim::ControllerSettings settings;
    settings.jobs = sim::shipped_jobs();
    auto on = sim::Controller::switch_on(settings, clock_, nullptr);
    ASSERT_TRUE(on) << on.error().line();
    controller_ = std::move(*on);
    robot::Tcp80Settings tcp;
    tcp.host = "127.0.0.1";
    tcp.port = controller_->tcp80_port();
    tcp.line_timeout = tcp.result_timeout = std::chrono::seconds(20);
    tcp_ = std::make_unique<robot::Tcp80Client>(tcp);
    robot::HsesSettings hses;
    hses.host = "127.0.0.1";
    hses.port = controller_->hses_port();
    hses.timeout = hses.file_timeout = std::chrono::seconds(20);
    hses_ = std::make_unique<robot::HsesClient>(hses);
    ASSERT_TRUE(tcp_->connect() && hses_->connect());
  }
  static std::string words(const RobotState& s) {
    std::string out;
    for (const bool bit : {s.running, s.teach, s.play, s.remote, s.hold_pendant, s.hold_external, s.hold_command,
                           s.alarm, s.error, s.servo, s.step, s.one_cycle, s.continuous, s.speed_limited})
      out += bit ? '1' : '0';
    return out;
  }
  void expect_same_state() {
    EXPECT_EQ(words(tcp_->read_status().value()), words(hses_->read_status().value()));
    const CartesianPosition a = tcp_->read_position(robot::kBaseFrame).value();
    const CartesianPosition b = hses_->read_position(robot::kBaseFrame).value();
    EXPECT_NEAR(a.x_mm, b.x_mm, 1e-9);
    EXPECT_NEAR(a.rz_deg, b.rz_deg, 1e-9);
    EXPECT_EQ(a.form, b.form);
    EXPECT_EQ(a.tool, b.tool);
    const auto pulses = tcp_->read_pulses().value(), same = hses_->read_pulses().value();
    EXPECT_TRUE(std::equal(pulses.begin(), pulses.begin() + 6, same.begin()));
    EXPECT_EQ(tcp_->list_jobs().value(), hses_->list_jobs().value());
    std::vector<int> codes, others;
    const std::vector<robot::Alarm> over_tcp = tcp_->read_alarms().value(), over_hses = hses_->read_alarms().value();
    for (const auto& alarm : over_tcp)
      if (!alarm.text.starts_with("error")) codes.push_back(alarm.code);
    for (const auto& alarm : over_hses) others.push_back(alarm.code);
    EXPECT_EQ(codes, others);
  }

  core::SimulatedClock clock_;
  std::unique_ptr<core::Seat> seat_ = clock_.join("pc");
  std::unique_ptr<sim::Controller> controller_;
  std::unique_ptr<robot::Tcp80Client> tcp_;
  std::unique_ptr<robot::HsesClient> hses_;
};

TEST_F(LinksAgree, OnEveryVariableThatEitherWrites) {
  std::mt19937 random(3);
  ControllerLink* links[] = {tcp_.get(), hses_.get()};
  std::uniform_real_distribution<double> mm(-1500, 1500), deg(-180, 180);
  for (int i = 0; i < 300; ++i) {
    ControllerLink &writer = *links[i % 2], &reader = *links[1 - i % 2];
    const int n = static_cast<int>(random() % 100);
    const auto byte = static_cast<std::int32_t>(random() % 256);
    const auto word = static_cast<std::int16_t>(random());
    const auto number = static_cast<std::int32_t>(random());
    ASSERT_TRUE(writer.write_integer(VariableType::byte, n, byte));
    ASSERT_TRUE(writer.write_integer(VariableType::integer, n, word));
    ASSERT_TRUE(writer.write_integer(VariableType::double_integer, n, number));
    EXPECT_EQ(reader.read_integer(VariableType::byte, n).value(), byte);
    EXPECT_EQ(reader.read_integer(VariableType::integer, n).value(), word);
    EXPECT_EQ(reader.read_integer(VariableType::double_integer, n).value(), number);
    const double real = static_cast<float>(mm(random));
    ASSERT_TRUE(writer.write_real(n, real));
    EXPECT_NEAR(reader.read_real(n).value(), real, 1e-4);
    const std::string text = "S " + std::to_string(number);
    ASSERT_TRUE(writer.write_string(n, text));
    EXPECT_EQ(reader.read_string(n).value(), text);
    CartesianPosition p;
    p.frame = static_cast<int>(random() % 66);
    p.x_mm = mm(random), p.y_mm = mm(random), p.z_mm = mm(random);
    p.rx_deg = deg(random), p.ry_deg = deg(random), p.rz_deg = deg(random);
    p.form = robot::hses_form(random() % 64);
    p.tool = static_cast<int>(random() % 64);
    ASSERT_TRUE(writer.write_position_variable(n, p));
    const auto q = std::get<CartesianPosition>(reader.read_position_variable(n).value());
    EXPECT_NEAR(q.x_mm, p.x_mm, 5.1e-4);
    EXPECT_NEAR(q.ry_deg, p.ry_deg, 5.1e-5);
    EXPECT_TRUE(q.frame == p.frame && q.form == p.form && q.tool == p.tool);
    ASSERT_TRUE(writer.write_contacts(27010, {static_cast<std::uint8_t>(byte), 1}));
    EXPECT_EQ(reader.read_contacts(27010, 2).value(), (std::vector<std::uint8_t>{static_cast<std::uint8_t>(byte), 1}));
  }
}

TEST_F(LinksAgree, SinglesAndPluralsOfEveryKind) {
  using Axes = robot::HsesVariables::Axes;
  robot::HsesVariables& v = hses_->variables();
  ASSERT_TRUE(v.write_integers(VariableType::byte, 40, {1, 2, 3, 255}));
  EXPECT_EQ(tcp_->read_integer(VariableType::byte, 43).value(), 255);
  EXPECT_EQ(v.read_integers(VariableType::byte, 40, 4).value(), (std::vector<std::int32_t>{1, 2, 3, 255}));
  ASSERT_TRUE(tcp_->write_integer(VariableType::integer, 41, -7));
  EXPECT_EQ(v.read_integers(VariableType::integer, 40, 2)->at(1), -7);
  ASSERT_TRUE(v.write_integers(VariableType::double_integer, 40, {100000, -100000}));
  EXPECT_EQ(tcp_->read_integer(VariableType::double_integer, 41).value(), -100000);
  ASSERT_TRUE(v.write_reals(40, {1.5, -0.25}));
  EXPECT_EQ(tcp_->read_real(41).value(), -0.25);
  ASSERT_TRUE(v.write_strings(40, {"A", "B"}));
  EXPECT_EQ(tcp_->read_string(41).value(), "B");
  CartesianPosition p;
  p.x_mm = 300, p.tool = 1;
  ASSERT_TRUE(tcp_->write_position_variable(40, p));
  EXPECT_EQ(v.read_positions(40, 1)->at(0), robot::hses_position(p));
  ASSERT_TRUE(v.write_positions(41, {robot::hses_position(p)}));
  EXPECT_EQ(std::get<CartesianPosition>(tcp_->read_position_variable(41).value()), p);
  ASSERT_TRUE(v.write_registers(40, {7, 65535}));
  EXPECT_EQ(hses_->read_register(41).value(), 65535);
  ASSERT_TRUE(v.write_groups(2701, {1, 128}));
  EXPECT_EQ(tcp_->read_contacts(27010, 2).value(), (std::vector<std::uint8_t>{1, 128}));
  for (const Axes which : {Axes::base, Axes::station}) {
    ASSERT_TRUE(v.write_axes(which, 3, {0, {1, 2, 3}}));
    EXPECT_EQ(v.read_many_axes(which, 3, 1)->at(0), (robot::HsesAxesPosition{0, {1, 2, 3}}));
  }
  EXPECT_FALSE(v.read_integers(VariableType::byte, 98, 4)) << "beyond the last";
}

TEST_F(LinksAgree, OnTheStateThroughRunHoldAlarmAndKey) {
  expect_same_state();
  ASSERT_TRUE(hses_->servo(true));
  expect_same_state();
  ASSERT_TRUE(tcp_->start_job("VISPICK"));
  seat_->sleep_for(std::chrono::milliseconds(300));
  expect_same_state();
  EXPECT_EQ(tcp_->read_job()->name, hses_->read_job()->name);
  EXPECT_EQ(tcp_->read_job()->line, hses_->read_job()->line);
  EXPECT_EQ(tcp_->start_job("VISPICK").error().why, hses_->start_job("VISPICK").error().why);
  ASSERT_TRUE(hses_->hold(true));
  seat_->sleep_for(std::chrono::seconds(1));
  expect_same_state();
  ASSERT_TRUE(tcp_->hold(false));
  controller_->with_state([](sim::ControllerState& s) { s.raise_alarm({4107, 3, "OUT OF RANGE"}), s.error = true; });
  expect_same_state();
  ASSERT_TRUE(hses_->reset_alarm() && hses_->cancel_error());
  expect_same_state();
  for (const auto turn : {&sim::ControllerState::turn_key_to_teach, &sim::ControllerState::turn_key_to_remote}) {
    controller_->with_state([turn](sim::ControllerState& s) { (s.*turn)(); });
    expect_same_state();
  }
}

TEST_F(LinksAgree, OnAMoveThatEitherOrders) {
  ASSERT_TRUE(hses_->servo(true));
  using Kind = robot::DirectMove::Kind;
  ControllerLink* links[] = {tcp_.get(), hses_.get()};
  for (int i = 0; i < 4; ++i) {
    CartesianPosition by;
    by.z_mm = i < 2 ? -4 : 4;
    by.tool = 1;
    ASSERT_TRUE(links[i % 2]->move({Kind::line_by, 20, false, by}));
    EXPECT_EQ(tcp_->move({Kind::line_by, 20, false, by}).error().why,
              hses_->move({Kind::line_by, 20, false, by}).error().why);
    seat_->sleep_for(std::chrono::seconds(2));
    expect_same_state();
  }
  EXPECT_NEAR(hses_->read_position(0)->z_mm, 255, 0.002);
  // and in pulses
  for (ControllerLink* link : links) {
    robot::PulseMove back{false, 5, {}};
    const std::vector<std::int32_t> now = link->read_pulses().value();
    std::copy_n(now.begin(), 6, back.target.pulses.begin());
    back.target.pulses[0] += link == links[0] ? 2000 : -2000;
    back.target.tool = 1;
    ASSERT_TRUE(link->move_pulses(back));
    seat_->sleep_for(std::chrono::seconds(5));
    expect_same_state();
    EXPECT_NEAR(link->read_pulses()->at(0), back.target.pulses[0], 1);
  }
}

TEST_F(LinksAgree, OnAJobThatWasLoaded) {
  const std::string vispick = hses_->read_job_text("VISPICK").value();
  std::string copy = vispick;
  copy.replace(copy.find("//NAME VISPICK"), 14, "//NAME COPY");
  ASSERT_TRUE(hses_->write_job_text("COPY", copy));
  EXPECT_EQ(hses_->read_job_text("COPY").value(), copy);
  expect_same_state();
  ASSERT_TRUE(tcp_->delete_job("COPY"));
  expect_same_state();
  EXPECT_FALSE(hses_->write_job_text("BAD", "/JOB\n//NAME BAD\n//INST\nNOP\nEND\n"));
}

TEST_F(LinksAgree, SpoiltAnswersOfEitherDoorDoNotConfuseTheNext) {
  for (const sim::Fault fault : {sim::Fault::twice, sim::Fault::drop, sim::Fault::truncate}) {
    ASSERT_TRUE(hses_->write_integer(VariableType::byte, 40, 1));
    sim::FaultEvent event;
    event.fault = fault;
    controller_->inject(event);
    robot::HsesSettings quick;
    quick.host = "127.0.0.1";
    quick.port = controller_->hses_port();
    quick.timeout = std::chrono::milliseconds(fault == sim::Fault::twice ? 20000 : 50);
    robot::HsesClient client(quick);
    ASSERT_TRUE(client.connect());
    EXPECT_EQ(client.read_integer(VariableType::byte, 40).value(), 1);
    ASSERT_TRUE(client.write_integer(VariableType::byte, 40, 2));
    EXPECT_EQ(client.read_integer(VariableType::byte, 40).value(), 2);
  }
}

}  // namespace
}  // namespace pickcell
