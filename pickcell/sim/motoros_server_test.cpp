// The MotoROS door over real sockets: bytes written by hand from the reference, in both orders.

#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <vector>

#include "pickcell/sim/controller.hpp"
#include "pickcell/sim/loopback_test.hpp"

namespace pickcell::sim {
namespace {

namespace moto = robot::moto;
using robot::ByteOrder;
using robot::MotoFrame;

class MotoRosDoorTest : public ::testing::Test {
 protected:
  void switch_on(ByteOrder order = ByteOrder::little) {
    order_ = order;
    ControllerSettings settings;
    settings.motoros_port = 0;
    settings.motoros_order = order;
    auto on = Controller::switch_on(settings, clock_, nullptr);
    ASSERT_TRUE(on) << on.error().line();
    controller_ = std::move(*on);
    ASSERT_GT(controller_->motoros_port(), 0);
  }
  [[nodiscard]] int port(int nth) const { return controller_->motoros_port() + nth; }
  /// Sends bytes, expects exactly these bytes.
  static void exchange(LoopbackHost& host, const std::string& request, const std::string& answer) {
    host.send(request);
    EXPECT_EQ(host.receive(answer.size()), answer);
  }
  [[nodiscard]] std::string bytes(const MotoFrame& frame) const { return moto_bytes(frame, order_); }
  static robot::MotoFrame command(std::int32_t number) {
    robot::MotoCommand c;
    c.command = number;
    return moto_frame(c);
  }
  static robot::MotoFrame reply(std::int32_t command, std::int32_t result, std::int32_t subcode = 0) {
    robot::MotoReply r;
    r.command = command;
    r.result = result;
    r.subcode = subcode;
    return moto_frame(r);
  }

  ByteOrder order_ = ByteOrder::little;
  core::RealClock clock_;
  std::unique_ptr<Controller> controller_;
};

std::string words(ByteOrder order, std::initializer_list<std::uint32_t> values) {
  std::string out;
  for (const std::uint32_t v : values)
    for (int i = 0; i < 4; ++i) out += static_cast<char>(v >> 8 * (order == ByteOrder::little ? i : 3 - i) & 0xFF);
  return out;
}

TEST_F(MotoRosDoorTest, PingAndReadyInBothOrders) {
  for (const ByteOrder order : {ByteOrder::little, ByteOrder::big}) {
    switch_on(order);
    LoopbackHost host(port(0));
    ASSERT_TRUE(host.connected());
    exchange(host, words(order, {12, 1, 2, 0}), words(order, {12, 1, 3, 1}));
    // CHECK_MOTION_READY: false, servo off; ten data words follow
    exchange(host, words(order, {64, 2001, 2, 0, 0, 7, 200101, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0}),
             words(order, {72, 2002, 3, 1, 0, 7, 200101, 2, 5006, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0}));
  }
}

TEST_F(MotoRosDoorTest, StateComesInPairsByItself) {
  switch_on(ByteOrder::big);
  LoopbackHost first(port(1)), second(port(1));
  for (LoopbackHost* host : {&first, &second}) {
    for (int pair = 0; pair < 3; ++pair) {
      const std::string feedback = host->receive(148), status = host->receive(44);
      EXPECT_EQ(feedback.substr(0, 24), words(ByteOrder::big, {144, 15, 1, 0, 0, 2}));
      // B stands at -90 degrees, whole pulses of 1000 per degree: -pi/2 = 0xbfc90fdb
      EXPECT_EQ(feedback.substr(28 + 4 * 4, 4), words(ByteOrder::big, {0xbfc90fdb}));
      EXPECT_EQ(status, words(ByteOrder::big, {40, 13, 1, 0, 0, 0, 0, 0, 0, 2, 0}));
    }
  }
}

TEST_F(MotoRosDoorTest, FourStateHostsAtMost) {
  switch_on();
  std::vector<std::unique_ptr<LoopbackHost>> hosts;
  for (int i = 0; i < 4; ++i) {
    hosts.push_back(std::make_unique<LoopbackHost>(port(1)));
    EXPECT_EQ(hosts.back()->receive(148).size(), 148u);
  }
  LoopbackHost fifth(port(1));
  EXPECT_TRUE(fifth.ended());
}

TEST_F(MotoRosDoorTest, ABVariableWrittenOverTcp80AndAnInputWrittenHereAreTheSameController) {
  switch_on();
  LoopbackHost io(port(2)), tcp80(controller_->tcp80_port());
  exchange(io, words(order_, {20, 2005, 2, 0, 27011, 1}), words(order_, {16, 2006, 3, 1, 0}));
  tcp80.send("CONNECT Robot_access Keep-Alive:-1\r\n");
  (void)tcp80.until("\r\n");
  EXPECT_EQ(tcp80.command("IOREAD", "27010,8"), "2\r");
  EXPECT_EQ(tcp80.command("SVON", "1").substr(0, 4), "0000");
  LoopbackHost state(port(1));
  (void)state.receive(148);
  EXPECT_EQ(state.receive(44).substr(16, 4), words(order_, {1})) << "drives powered";
}

TEST_F(MotoRosDoorTest, FramesMayComeInPiecesAndSeveralAtOnce) {
  switch_on();
  LoopbackHost host(port(0));
  const std::string ping = words(order_, {12, 1, 2, 0}), pong = words(order_, {12, 1, 3, 1});
  for (const char byte : ping) host.send(std::string(1, byte));
  EXPECT_EQ(host.receive(16), pong);
  host.send(ping + ping + ping.substr(0, 5));
  EXPECT_EQ(host.receive(32), pong + pong);
  host.send(ping.substr(5));
  EXPECT_EQ(host.receive(16), pong);
}

TEST_F(MotoRosDoorTest, UnknownTypesAreToldSoAndPutOut) {
  switch_on();
  LoopbackHost host(port(0));
  exchange(host, words(order_, {12, 999, 2, 0}),
           words(order_, {72, 2002, 3, 1, 0xffffffff, 0xffffffff, 999, 3, 3003, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0}));
  EXPECT_TRUE(host.ended());
  LoopbackHost io(port(2));
  exchange(io, words(order_, {12, 999, 2, 0}), words(order_, {20, 2011, 3, 2, 3, 3003}));
  exchange(io, words(order_, {16, 2003, 2, 0, 10}), words(order_, {20, 2004, 3, 1, 0, 0}));
  LoopbackHost nonsense(port(0));
  nonsense.send("GET / HTTP/1.1\r\n\r\n");
  EXPECT_TRUE(nonsense.ended());
}

TEST_F(MotoRosDoorTest, ANewcomerPutsOutAnIdleMotionHost) {
  switch_on();
  LoopbackHost first(port(0));
  exchange(first, words(order_, {12, 1, 2, 0}), words(order_, {12, 1, 3, 1}));
  LoopbackHost second(port(0));
  EXPECT_TRUE(first.ended());
  exchange(second, words(order_, {12, 1, 2, 0}), words(order_, {12, 1, 3, 1}));
}

TEST_F(MotoRosDoorTest, TheStartIsAnsweredWhenTheJobIsAtItsWait) {
  switch_on();
  LoopbackHost host(port(0));
  exchange(host, bytes(command(moto::kStartTrajectoryMode)), bytes(reply(moto::kStartTrajectoryMode, moto::ok)));
  EXPECT_TRUE(controller_->copy_of_state().outputs[889]);
  // While it waits for its answer nothing else is looked at, and nothing is lost.
  exchange(host, bytes(command(moto::kDisconnect)), bytes(reply(moto::kDisconnect, moto::ok)));
  EXPECT_TRUE(host.ended());
}

TEST_F(MotoRosDoorTest, APowerCutResetsEverybodyAndThePortsComeBack) {
  switch_on();
  const int before = controller_->motoros_port();
  LoopbackHost host(port(1));
  (void)host.receive(148);
  controller_->kill();
  (void)host.receive(1 << 20);
  EXPECT_TRUE(host.ended());
  EXPECT_TRUE(host.was_reset());
  LoopbackHost nobody(before);
  EXPECT_FALSE(nobody.connected());
  ASSERT_TRUE(controller_->revive());
  EXPECT_EQ(controller_->motoros_port(), before);
  LoopbackHost again(port(1));
  EXPECT_EQ(again.receive(148).size(), 148u);
}

TEST_F(MotoRosDoorTest, AnswersCanBeSpoiledByAScenario) {
  switch_on();
  const std::string ping = words(order_, {12, 1, 2, 0}), pong = words(order_, {12, 1, 3, 1});
  const auto spoil = [this](Fault fault) {
    FaultEvent event;
    event.fault = fault;
    event.after_commands = 1;
    event.delay_s = 0.01;
    controller_->follow({event});
  };
  LoopbackHost host(port(0));
  spoil(Fault::twice);
  exchange(host, ping, pong + pong);
  spoil(Fault::late);
  exchange(host, ping, pong);
  spoil(Fault::drop);
  host.send(ping);
  EXPECT_TRUE(host.silent());
  spoil(Fault::half_line);
  exchange(host, ping, pong.substr(0, 8));
  spoil(Fault::truncate);
  exchange(host, ping, pong.substr(0, 8));
  EXPECT_TRUE(host.ended());
  LoopbackHost next(port(0));
  spoil(Fault::reset_after_ok);
  next.send(ping);
  EXPECT_TRUE(next.ended());
  EXPECT_TRUE(next.was_reset());
}

}  // namespace
}  // namespace pickcell::sim
