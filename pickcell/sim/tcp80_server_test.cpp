#include "pickcell/sim/tcp80_server.hpp"

#include <gtest/gtest.h>

#include "pickcell/sim/controller.hpp"
#include "pickcell/sim/loopback_test.hpp"
#include "pickcell/sim/shipped_jobs.hpp"

namespace pickcell::sim {
namespace {

/// Dialogues byte for byte (docs/yaskawa-protocols 1.1, 1.2).
class Dialogue : public testing::Test {
 protected:
  void switch_on(ControllerSettings settings = {}) {
    settings.jobs = shipped_jobs();
    auto result = Controller::switch_on(settings, clock_, nullptr);
    ASSERT_TRUE(result.has_value()) << result.error().line();
    controller_ = std::move(*result);
  }
  std::unique_ptr<LoopbackHost> host(const std::string& greeting = "CONNECT Robot_access Keep-Alive:-1\r\n") {
    auto h = std::make_unique<LoopbackHost>(controller_->tcp80_port());
    EXPECT_TRUE(h->connected());
    h->send(greeting);
    return h;
  }
  core::SimulatedClock clock_;
  std::unique_ptr<Controller> controller_;
};

TEST_F(Dialogue, ReadsTheStatusOnAKeptConnection) {
  switch_on();
  auto h = host();
  EXPECT_EQ(h->until("\n"), "OK: YR Information Server( 1.00) Keep-Alive:-1.\r\n");
  h->send("HOSTCTRL_REQUEST RSTATS 0\r\n");
  EXPECT_EQ(h->receive(13), "OK: RSTATS\r\n1");
  EXPECT_EQ(h->receive(5), "94,0\r");
  EXPECT_TRUE(h->silent());
  h->send("HOSTCTRL_REQUEST SVON 2\r\n");
  EXPECT_EQ(h->until("\n"), "OK: SVON\r\n");
  EXPECT_TRUE(h->silent()) << "the result waits for the operands";
  h->send("1");
  EXPECT_TRUE(h->silent()) << "one of two bytes";
  h->send("\r");
  EXPECT_EQ(h->until("\n"), "0000\r\n");
  EXPECT_EQ(h->command("RSTATS"), "194,64\r");
}

TEST_F(Dialogue, TakesEveryLineEndAndSwallowsTheLfLeftOver) {
  switch_on();
  for (const std::string end : {"\r", "\n", "\r\n"}) {
    auto h = host("CONNECT Robot_access Keep-Alive:-1" + end);
    EXPECT_EQ(h->until("\n").substr(0, 3), "OK:");
    for (const std::string operand_end : {"\r", "\r\n"})
      for (int i = 0; i < 3; ++i) {
        h->send("HOSTCTRL_REQUEST RPOSC 4" + end);
        EXPECT_EQ(h->until("\n"), "OK: RPOSC\r\n");
        h->send("0,0" + operand_end);  // the size counts the CR only
        EXPECT_EQ(h->until("\r"), "480.000,0.000,255.000,180.0000,0.0000,0.0000,0,1\r");
      }
    h->send("HOSTCTRL_REQUEST RPOSC 6" + end + "0, 0 \r");  // blanks counted, all in one piece
    EXPECT_EQ(h->until("\n"), "OK: RPOSC\r\n");
    EXPECT_EQ(h->until("\r").size(), 49u);
  }
}

TEST_F(Dialogue, OneCommandModeClosesAfterTheResult) {
  ControllerSettings settings;
  settings.banner = "NX";
  switch_on(settings);
  auto h = host("CONNECT Robot_access\r\n");
  EXPECT_EQ(h->until("\n"), "OK: NX Information Server( 1.00).\r\n");
  EXPECT_EQ(h->command("RSTATS"), "194,0\r");
  EXPECT_TRUE(h->ended());
  EXPECT_FALSE(h->was_reset());
}

TEST_F(Dialogue, CountsTheCommandsOfKeepAliveInBothSpellings) {
  switch_on();
  for (const std::string key : {"Keep-Alive:", "KeepAlive:"}) {
    auto h = host("CONNECT Robot_access " + key + "2\r\n");
    EXPECT_EQ(h->until("\n"), "OK: YR Information Server( 1.00) Keep-Alive:2.\r\n");
    EXPECT_EQ(h->command("RSTATS"), "194,0\r");
    EXPECT_EQ(h->command("HOLD", "7"), "ERROR: HOLD is not successful(1012).\r");
    EXPECT_EQ(h->until("\n"), "\n");
    EXPECT_TRUE(h->ended());
  }
}

TEST_F(Dialogue, RefusesBadGreetingsAndHeaders) {
  switch_on();
  for (const std::string bad :
       {"HELLO\r\n", "CONNECT Robot_access Keep-Alive:0\r\n", "CONNECT Robot_access Keep-Alive:x\r\n",
        "CONNECT Robot_access Keep-Alive:40000\r\n", "GET / HTTP/1.1\r\n", "\r\n"}) {
    auto h = host(bad);
    EXPECT_EQ(h->until("\n"), "NG: HTTP Error Response\r\n") << bad;
    EXPECT_TRUE(h->ended());
  }
  for (const std::string bad :
       {"HOSTCTRL_REQUEST RSTATS\r\n", "HOSTCTRL_REQUEST RSTATS -1\r\n", "HOSTCTRL_REQUEST RSTATS 9999999999\r\n",
        "RSTATS 0\r\n", "HOSTCTRL_REQUEST rm 0\r\n"}) {
    auto h = host();
    (void)h->until("\n");
    h->send(bad);
    EXPECT_EQ(h->until("\n").substr(0, 3), "NG:") << bad;
    EXPECT_TRUE(h->ended());
  }
  auto h = host(std::string(100'000, 'A'));
  EXPECT_EQ(h->until("\n").substr(0, 3), "NG:");
}

TEST_F(Dialogue, ServesSeveralHostsAndHostsThatCloseTheirSideEarly) {
  switch_on();
  auto a = host(), b = host();
  (void)a->until("\n");
  (void)b->until("\n");
  a->send("HOSTCTRL_REQUEST LOADV 9\r\n");
  EXPECT_EQ(b->command("LOADV", "0,10,7"), "0000\r");
  (void)b->until("\n");
  EXPECT_EQ(b->command("SAVEV", "0,10"), "7\r");
  EXPECT_EQ(a->until("\n"), "OK: LOADV\r\n");
  a->send("0,10,255\r");
  EXPECT_EQ(a->until("\n"), "0000\r\n");
  EXPECT_EQ(b->command("SAVEV", "0,10"), "255\r");
}

TEST_F(Dialogue, KeepsOkAndDataApartByTheChosenPause) {
  ControllerSettings settings;
  settings.segment_pause_s = 0.02;
  switch_on(settings);
  auto h = host();
  (void)h->until("\n");
  const auto start = std::chrono::steady_clock::now();
  h->send("HOSTCTRL_REQUEST RSTATS 0\r\n");
  EXPECT_EQ(h->until("\n"), "OK: RSTATS\r\n");
  EXPECT_EQ(h->until("\r"), "194,0\r");
  EXPECT_GE(std::chrono::steady_clock::now() - start, std::chrono::milliseconds(20));
}

TEST_F(Dialogue, AnswersCanBeSpoilt) {
  switch_on();
  const auto spoil = [&](Fault fault) {
    FaultEvent event;
    event.fault = fault;
    event.delay_s = 0.08;
    controller_->inject(event);
  };
  auto h = host();
  (void)h->until("\n");
  spoil(Fault::late);
  h->send("HOSTCTRL_REQUEST RSTATS 0\r\n");
  EXPECT_EQ(h->until("\n"), "OK: RSTATS\r\n");
  EXPECT_TRUE(h->silent(30));
  EXPECT_EQ(h->until("\r"), "194,0\r");
  spoil(Fault::twice);
  EXPECT_EQ(h->command("RSTATS"), "194,0\r");
  EXPECT_EQ(h->until("\r"), "194,0\r");
  spoil(Fault::half_line);
  h->send("HOSTCTRL_REQUEST RSTATS 0\r\n");
  EXPECT_EQ(h->receive(15), "OK: RSTATS\r\n194");
  EXPECT_TRUE(h->silent());
  spoil(Fault::drop);
  h->send("HOSTCTRL_REQUEST RSTATS 0\r\n");
  EXPECT_EQ(h->until("\n"), "OK: RSTATS\r\n");
  EXPECT_TRUE(h->silent());
  spoil(Fault::truncate);
  h->send("HOSTCTRL_REQUEST RSTATS 0\r\n");
  EXPECT_EQ(h->until("\n"), "OK: RSTATS\r\n");
  EXPECT_EQ(h->until("\r"), "194");
  EXPECT_TRUE(h->ended());
  EXPECT_FALSE(h->was_reset());
  auto g = host();
  (void)g->until("\n");
  spoil(Fault::reset_after_ok);
  g->send("HOSTCTRL_REQUEST RSTATS 0\r\n");
  (void)g->until("\n");
  EXPECT_TRUE(g->ended());
  EXPECT_TRUE(g->was_reset());
}

TEST_F(Dialogue, AKilledControllerComesBackOnItsPortWithItsVariables) {
  switch_on();
  const int port = controller_->tcp80_port();
  auto h = host();
  (void)h->until("\n");
  (void)h->command("LOADV", "2,10,123456");
  controller_->kill();
  (void)h->until("\n");
  EXPECT_TRUE(h->ended());
  EXPECT_FALSE(LoopbackHost(port).connected());
  ASSERT_TRUE(controller_->revive().has_value());
  EXPECT_EQ(controller_->tcp80_port(), port);
  auto again = host();
  (void)again->until("\n");
  EXPECT_EQ(again->command("SAVEV", "2,10"), "123456\r");
  EXPECT_EQ(again->command("RSTATS"), "194,0\r");
}

TEST_F(Dialogue, ATakenPortIsAnErrorInWords) {
  switch_on();
  ControllerSettings second;
  second.tcp80_port = controller_->tcp80_port();
  auto result = Controller::switch_on(second, clock_, nullptr);
  ASSERT_FALSE(result.has_value());
  EXPECT_EQ(result.error().code, core::ErrorCode::link);
}

}  // namespace
}  // namespace pickcell::sim
