// Random requests through each server of the simulated controller, without sockets: valid ones with a few bytes
// changed, in a stream cut anywhere. Nothing crashes (the sanitizers watch), every answer can be sent, the arm stays
// within its limits.

#include <gtest/gtest.h>

#include <array>

#include "noise.hpp"
#include "pickcell/robot/hses_codec.hpp"
#include "pickcell/sim/hses_commands.hpp"
#include "pickcell/sim/hses_files.hpp"
#include "pickcell/sim/job_interpreter.hpp"
#include "pickcell/sim/motoros_io.hpp"
#include "pickcell/sim/motoros_motion.hpp"
#include "pickcell/sim/shipped_jobs.hpp"
#include "pickcell/sim/tcp80_commands.hpp"
#include "pickcell/sim/tcp80_session.hpp"

namespace pickcell::sim {
namespace {

using testing_noise::kMessages;
using testing_noise::Noise;

class RandomRequests : public testing::Test {
 protected:
  static ControllerSettings settings() {
    ControllerSettings s;
    s.jobs = shipped_jobs();
    return s;
  }
  /// Time passes, and now and then a person puts the controller right.
  void live(int n) {
    if (n % 7 == 0) run_tick(state, 0.01);
    if (n % 100 != 0) return;
    ASSERT_TRUE(inside_limits(*state.arm, state.q));
    state.reset_at_pendant();
    state.turn_key_to_remote();
    state.servo = true;
    state.hold_command = false;
  }
  ControllerState state{settings()};
};

TEST_F(RandomRequests, Tcp80) {
  Noise noise(1080);
  const std::array<std::string, 14> valid = {"RSTATS 0\r\n",
                                             "RPOSC 4\r\n0,0\r",
                                             "SAVEV 5\r\n4,10\r",
                                             "LOADV 7\r\n0,10,1\r",
                                             "LOADV 41\r\n4,10,1,0,400.000,0.000,100.000,180,0,0,0,1\r",
                                             "IOREAD 9\r\n27010,16\r",
                                             "IOWRITE 10\r\n27010,8,1\r",
                                             "SVON 2\r\n1\r",
                                             "START 8\r\nVISPICK\r",
                                             "JSEQ 8\r\nTEST1,0\r",
                                             "HOLD 2\r\n0\r",
                                             "MOVJ 44\r\n10.0,0,480,0,250,180.0,0.0,0.0,0,1,0,0,0,0,0,0\r\n",
                                             "IMOV 41\r\n0,50.0,0,0,0,5.0,0.0,0.0,0.0,0,1,0,0,0,0,0,0\r",
                                             "RESET 0\r\n"};
  int carried_out = 0;
  auto session = std::make_unique<Tcp80Session>("YR");
  session->feed("CONNECT Robot_access Keep-Alive:-1\r\n");
  for (int n = 0; n < kMessages; ++n) {
    std::string text = "HOSTCTRL_REQUEST " + valid[noise.below(14)];
    if (noise.below(3) == 0) text = noise.changed(text);
    const std::size_t cut = noise.below(static_cast<std::uint32_t>(text.size() + 1));
    for (const std::string& part : {text.substr(0, cut), text.substr(cut)}) {
      session->feed(part);
      bool closed = false;
      while (const auto step = session->next()) {
        closed = closed || step->close;
        if (!step->command) continue;
        const auto answer = execute_tcp80(state, step->command->name, step->command->operands);
        ASSERT_TRUE(answer.bytes().ends_with(answer.kind == Tcp80Answer::Kind::data ? "\r" : "\r\n"));
        carried_out += answer.kind != Tcp80Answer::Kind::error;
      }
      if (!closed) continue;
      session = std::make_unique<Tcp80Session>("YR");
      session->feed("CONNECT Robot_access Keep-Alive:-1\r\n");
    }
    live(n);
  }
  EXPECT_GT(carried_out, kMessages / 10);
}

TEST_F(RandomRequests, Hses) {
  Noise noise(1040);
  HsesFiles files;
  int done = 0;
  for (int n = 0; n < kMessages; ++n) {
    const std::array<robot::HsesRequest, 10> valid = {
        robot::hses_get(0x72, 1),
        robot::hses_get(0x75, 101),
        robot::hses_get(0x71, static_cast<std::uint16_t>(noise.below(5000))),
        robot::hses_set_one(0x7A, static_cast<std::uint16_t>(noise.below(110)), {1}),
        robot::hses_read_plural(0x302, 0, 2 * (1 + noise.below(200))),
        robot::hses_power(robot::kHsesServo, noise.coin()),
        robot::hses_select_job("VISPICK", 0),
        robot::hses_start(),
        robot::hses_file(robot::HsesService::file_list, "*.JBI"),
        robot::hses_file(robot::HsesService::file_load, "TEST1.JBI")};
    const robot::HsesBytes bytes = robot::hses_bytes(valid[noise.below(10)]);
    std::string text(bytes.begin(), bytes.end());
    if (noise.below(3) != 0) text = noise.changed(text);
    const auto request =
        robot::parse_hses_request(robot::HsesView(reinterpret_cast<const std::uint8_t*>(text.data()), text.size()));
    if (!request) continue;
    const auto answer = request->division == robot::HsesDivision::file ? files.handle(state, *request)
                                                                       : std::optional(execute_hses(state, *request));
    if (!answer) continue;
    ASSERT_LE(answer->payload.size(), robot::kHsesMostPayload);
    ASSERT_EQ(answer->id, request->id);
    ASSERT_EQ(answer->status == 0, answer->added_status == 0);
    done += answer->status == 0;
    live(n);
  }
  EXPECT_GT(done, kMessages / 20);
}

TEST_F(RandomRequests, MotoRos) {
  Noise noise(1240);
  MotoRosMotion motion;
  int answered = 0;
  for (const robot::ByteOrder order : {robot::ByteOrder::little, robot::ByteOrder::big}) {
    robot::MotoFrameSplitter splitter(order);
    for (int n = 0; n < kMessages / 2; ++n) {
      constexpr std::array<std::int32_t, 14> kTypes = {1,    14,   2001, 2001, 2003, 2005, 2007,
                                                       2009, 2012, 2013, 2016, 2018, 2020, 999};
      robot::MotoFrame frame{kTypes[noise.below(14)], 2, 0, {}};
      constexpr std::array<std::size_t, 14> kWords = {0, 34, 13, 13, 1, 2, 1, 2, 1, 2, 134, 3, 0, 5};
      for (std::size_t i = 0; i < kTypes.size(); ++i)
        if (kTypes[i] == frame.type) frame.body.resize(kWords[i]);
      for (std::uint32_t& word : frame.body) word = noise.below(4) == 0 ? noise.word() : noise.below(3);
      if (frame.type == 2001) frame.body[2] = 200101 + noise.below(30);
      if (frame.type == 14) frame.body[2] = 7;
      std::string bytes = robot::moto_bytes(frame, order);
      if (noise.below(4) == 0) bytes = noise.changed(bytes);
      splitter.feed(bytes);
      for (;;) {
        const auto message = splitter.next();
        if (!message) splitter = robot::MotoFrameSplitter(order);  // the connection would be closed
        if (!message || !*message) break;
        const MotoRosAnswer answer = is_motoros_io(**message)
                                         ? MotoRosAnswer{execute_motoros_io(state, **message), false, false}
                                         : motion.handle(state, **message);
        answered += answer.frame.has_value();
        ASSERT_LE(answer.frame ? answer.frame->body.size() * 4 : 0, robot::kMotoLongestBody);
        (void)motion.waited(state);
        (void)motion.status(state);
      }
      live(n);
      motion.tick(state, 0.01);
    }
  }
  EXPECT_GT(answered, kMessages / 3);
}

}  // namespace
}  // namespace pickcell::sim
