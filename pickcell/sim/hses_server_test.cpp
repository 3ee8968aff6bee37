// The High Speed Ethernet Server on its sockets, datagram by datagram. The bytes are written down from
// docs/yaskawa-protocols 2.1-2.7, not made by our codec.

#include "pickcell/sim/hses_server.hpp"

#include <gtest/gtest.h>

#include "pickcell/sim/controller.hpp"
#include "pickcell/sim/loopback_test.hpp"
#include "pickcell/sim/shipped_jobs.hpp"

namespace pickcell::sim {
namespace {

/// Datagrams as text of hex digits; blanks do not matter.
std::string bytes(std::string_view hex) {
  std::string out, digits;
  for (const char c : hex)
    if (c != ' ') digits += c;
  for (std::size_t i = 0; i + 1 < digits.size(); i += 2)
    out += static_cast<char>(std::stoi(digits.substr(i, 2), nullptr, 16));
  return out;
}

/// YERC, header size 0x20, data size, 3, division, ack, id, block, eight times '9', then the eight bytes at the end.
std::string frame(const std::string& size, const std::string& division_ack_id, const std::string& block,
                  const std::string& tail, const std::string& data = {}) {
  return bytes("59455243 2000" + size + "03" + division_ack_id + block + "39393939 39393939" + tail + data);
}
/// A request to robot control with id 0x2a.
std::string ask(const std::string& tail, const std::string& size = "0000", const std::string& data = {}) {
  return frame(size, "01 00 2a", "00000000", tail, data);
}
std::string answer(const std::string& tail, const std::string& size = "0000", const std::string& data = {}) {
  return frame(size, "01 01 2a", "00000080", tail, data);
}

class HsesDoor : public testing::Test {
 protected:
  static ControllerSettings settings() {
    ControllerSettings s;
    s.jobs = shipped_jobs();
    return s;
  }
  void order(Fault fault, int count = 1) {
    FaultEvent event;
    event.fault = fault;
    event.after_commands = 1;
    event.count = count;
    event.delay_s = 0.02;
    controller->follow({event});
  }
  core::SimulatedClock clock;
  std::unique_ptr<Controller> controller = std::move(*Controller::switch_on(settings(), clock, nullptr));
  UdpHost host{controller->hses_port()}, files{controller->hses_port() + 1};
  const std::string status = ask("7200 0100 00 01 0000");
  const std::string idle = answer("81 00 0000 0000 0000", "0800", "c2000000 00000000");
};

TEST_F(HsesDoor, AnswersStatusWithServicePlus80AndTheLastBlock) { EXPECT_EQ(host.exchange(status), idle); }

TEST_F(HsesDoor, BothFormsOfAVariable) {
  EXPECT_EQ(host.exchange(ask("7a00 0500 01 10 0000", "0100", "07")), answer("90 00 0000 0000 0000"));
  EXPECT_EQ(host.exchange(ask("7a00 0500 01 0e 0000")), answer("8e 00 0000 0000 0000", "0100", "07"));
  EXPECT_EQ(host.exchange(ask("7b00 0500 00 02 0000", "0200", "feff")), answer("82 00 0000 0000 0000"));
  EXPECT_EQ(host.exchange(ask("7b00 0500 00 01 0000")), answer("81 00 0000 0000 0000", "0200", "feff"));
  EXPECT_EQ(host.exchange(ask("0203 0400 00 33 0000", "0400", "02000000")),
            answer("b3 00 0000 0000 0000", "0600", "02000000 0007"));
}

TEST_F(HsesDoor, RefusalsHaveStatus1fAndOneWordOfAddedStatus) {
  EXPECT_EQ(host.exchange(ask("9900 0100 00 01 0000")), answer("81 1f 0100 00a0 0000")) << "command";
  EXPECT_EQ(host.exchange(ask("7a00 6400 01 0e 0000")), answer("8e 1f 0100 01a0 0000")) << "instance";
  EXPECT_EQ(host.exchange(ask("7a00 0100 02 0e 0000")), answer("8e 1f 0100 02a0 0000")) << "attribute";
  EXPECT_EQ(host.exchange(ask("8600 0100 01 10 0000", "0400", "01000000")), answer("90 1f 0100 1030 0000"))
      << "3010: servo off";
}

TEST_F(HsesDoor, DamagedFramesAreToldByTheirFault) {
  std::string wrong = status;
  wrong[4] = 0x21;
  EXPECT_EQ(host.exchange(wrong), answer("81 1f 0100 a5e4 0000")) << "header size";
  wrong = status + "x";
  EXPECT_EQ(host.exchange(wrong), answer("81 1f 0100 a7e4 0000")) << "more data than the size says";
  wrong = status;
  wrong[9] = 2;
  EXPECT_EQ(host.exchange(wrong), answer("81 1f 0100 a3e4 0000")) << "a request for files";
  wrong = status;
  wrong[0] = 'X';
  host.send(wrong);
  host.send(status.substr(0, 20));
  host.send(std::string());
  EXPECT_EQ(host.exchange(status), idle) << "what does not begin like a request gets no answer";
}

TEST_F(HsesDoor, ABusyControllerRefusesWithD8f1AndDoesNothing) {
  order(Fault::busy, 2);
  const std::string write = ask("7a00 0500 01 10 0000", "0100", "07");
  EXPECT_EQ(host.exchange(write), answer("90 1f 0100 f1d8 0000"));
  EXPECT_EQ(controller->copy_of_state().B[5], 0);
  EXPECT_EQ(files.exchange(frame("0500", "02 00 2a", "00000000", "0000 0000 00 32 0000", "2a2e4a4249")),
            frame("0000", "02 01 2a", "00000080", "b2 1f 0100 44e4 0000"))
      << "E444 of the file service";
  EXPECT_EQ(host.exchange(write), answer("90 00 0000 0000 0000"));
  EXPECT_EQ(controller->copy_of_state().B[5], 7);
}

TEST_F(HsesDoor, AnswersAreLostDoubledLateAndCutShort) {
  const std::string other = ask("7a00 0500 01 0e 0000"), other_answer = answer("8e 00 0000 0000 0000", "0100", "00");
  for (const Fault lost : {Fault::drop, Fault::reset_after_ok}) {
    order(lost);
    host.send(status);
    EXPECT_EQ(host.exchange(other), other_answer);
  }
  order(Fault::twice);
  EXPECT_EQ(host.exchange(status), idle);
  EXPECT_EQ(host.receive(), idle);
  order(Fault::late);
  host.send(status);
  EXPECT_EQ(host.exchange(other), other_answer) << "overtakes the late one";
  EXPECT_EQ(host.receive(), idle);
  for (const Fault half : {Fault::truncate, Fault::half_line}) {
    order(half);
    EXPECT_EQ(host.exchange(status), idle.substr(0, 20));
  }
  EXPECT_EQ(host.exchange(status), idle);
}

TEST_F(HsesDoor, AFileGoesBlockByBlockAndTheLastAckGetsNoAnswer) {
  // 0x16 TEST1.JBI
  const std::string got =
      files.exchange(frame("0900", "02 00 01", "00000000", "0000 0000 00 16 0000", "54455354312e4a4249"));
  ASSERT_GT(got.size(), 32u);
  EXPECT_EQ(got.substr(8, 8), bytes("03 02 01 01 01000080"));
  EXPECT_EQ(got.substr(24, 8), bytes("96 00 0000 0000 0000"));
  EXPECT_EQ(got.substr(32), controller->copy_of_state().jobs.at("TEST1")->text);
  files.send(frame("0000", "02 01 01", "01000080", "0000 0000 00 16 0000"));
  // 0x15 NEW.JBI, one block; each is answered by its own number
  EXPECT_EQ(files.exchange(frame("0700", "02 00 02", "00000000", "0000 0000 00 15 0000", "4e45572e4a4249")),
            frame("0000", "02 01 02", "00000000", "95 00 0000 0000 0000"));
  std::string job = got.substr(32);
  job.replace(job.find("TEST1"), 5, "NEW");
  std::string block = frame("0000", "02 01 03", "01000080", "0000 0000 00 15 0000");
  block[6] = static_cast<char>(job.size());
  EXPECT_EQ(files.exchange(block + job), frame("0000", "02 01 03", "01000080", "95 00 0000 0000 0000"));
  EXPECT_EQ(controller->copy_of_state().jobs.count("NEW"), 1u);
}

}  // namespace
}  // namespace pickcell::sim
