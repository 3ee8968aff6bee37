#include "pickcell/robot/motoros_codec.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <bit>
#include <limits>
#include <random>
#include <string>

#include "pickcell/robot/motoros_fault.hpp"

namespace pickcell::robot {
namespace {

using ::testing::HasSubstr;

/// "00 00 00 28" ... written by hand from the reference.
std::string bytes(std::string_view hex) {
  std::string out;
  int high = -1;
  for (const char c : hex) {
    if (c == ' ' || c == '\n') continue;
    const int digit = c <= '9' ? c - '0' : c - 'a' + 10;
    if (high < 0) {
      high = digit;
    } else {
      out += static_cast<char>(high * 16 + digit);
      high = -1;
    }
  }
  return out;
}
std::string zeros(std::size_t words) { return std::string(words * 4, '\0'); }

MotoFrame frame_of(std::string_view stream, ByteOrder order) {
  MotoFrameSplitter splitter(order);
  splitter.feed(stream);
  auto frame = splitter.next();
  EXPECT_TRUE(frame && *frame) << (frame ? "unfinished" : frame.error().line());
  EXPECT_EQ(splitter.pending(), 0u);
  return frame && *frame ? **frame : MotoFrame{};
}

TEST(MotoRosGolden, StatusOfTheRecordedUnit) {  // length 40, type 13, topic: drives on, auto
  const std::string wire = bytes(
      "00000028 0000000d 00000001 00000000"
      "00000001 00000000 00000000 00000000 00000000 00000002 00000000");
  ASSERT_EQ(wire.size(), 44u);
  const MotoStatus status{1, 0, 0, 0, 0, 2, 0};
  EXPECT_EQ(moto_bytes(moto_frame(status), ByteOrder::big), wire);
  const auto read = parse_moto_status(frame_of(wire, ByteOrder::big));
  ASSERT_TRUE(read);
  EXPECT_EQ(*read, status);
}

TEST(MotoRosGolden, StartTrajectoryModeInBothOrders) {  // 200121 = 0x00030db9
  MotoCommand start;
  start.command = moto::kStartTrajectoryMode;
  const std::string big = bytes("00000040 000007d1 00000002 00000000  00000000 00000000 00030db9") + zeros(10);
  const std::string little = bytes("40000000 d1070000 02000000 00000000  00000000 00000000 b90d0300") + zeros(10);
  ASSERT_EQ(big.size(), 68u);
  EXPECT_EQ(moto_bytes(moto_frame(start), ByteOrder::big), big);
  EXPECT_EQ(moto_bytes(moto_frame(start), ByteOrder::little), little);
  EXPECT_EQ(parse_moto_command(frame_of(little, ByteOrder::little)).value(), start);
}

TEST(MotoRosGolden, CommandNumbersOfTheReference) {
  EXPECT_EQ(moto::kCheckReady, 200101);
  EXPECT_EQ(moto::kQueueCount, 200102);
  EXPECT_EQ(moto::kStop, 200111);
  EXPECT_EQ(moto::kServoOn, 200112);
  EXPECT_EQ(moto::kServoOff, 200113);
  EXPECT_EQ(moto::kResetAlarm, 200114);
  EXPECT_EQ(moto::kStopTrajectoryMode, 200122);
  EXPECT_EQ(moto::kDisconnect, 200130);
}

TEST(MotoRosGolden, BusyReplyToAPoint) {  // group 0, sequence 5, command 14, result 1
  const std::string wire =
      bytes("00000048 000007d2 00000003 00000001  00000000 00000005 0000000e 00000001 00000000") + zeros(10);
  ASSERT_EQ(wire.size(), 76u);
  MotoReply busy;
  busy.sequence = 5;
  busy.command = 14;
  busy.result = moto::busy;
  EXPECT_EQ(moto_bytes(moto_frame(busy), ByteOrder::big), wire);
  EXPECT_EQ(parse_moto_reply(frame_of(wire, ByteOrder::big)).value(), busy);
}

TEST(MotoRosGolden, TrajectoryPointWithFloats) {  // 1.5 = 3fc00000, -0.25 = be800000, 2 = 40000000
  MotoTrajectoryPoint point;
  point.sequence = 1;
  point.valid = moto::kTimeValid | moto::kPositionValid | moto::kVelocityValid;
  point.time_s = 1.5f;
  point.position[0] = -0.25f;
  point.velocity[1] = 2.0f;
  const std::string wire = bytes(
                               "94000000 0e000000 02000000 00000000"
                               "00000000 01000000 07000000 0000c03f  000080be") +
                           zeros(9) + zeros(1) + bytes("00000040") + zeros(8) + zeros(10);
  ASSERT_EQ(wire.size(), 152u);
  EXPECT_EQ(moto_bytes(moto_frame(point), ByteOrder::little), wire);
  EXPECT_EQ(parse_moto_point(frame_of(wire, ByteOrder::little)).value(), point);
}

TEST(MotoRosGolden, InputAndOutput) {  // contact 27010 = 0x6982, group 2701 = 0x0a8d
  EXPECT_EQ(moto_bytes(moto_frame(moto::kReadBit, MotoAddress{27010}), ByteOrder::little),
            bytes("10000000 d3070000 02000000 00000000 82690000"));
  EXPECT_EQ(moto_bytes(moto_frame(moto::kReadBitReply, MotoValue{1, 0}), ByteOrder::little),
            bytes("14000000 d4070000 03000000 01000000 01000000 00000000"));
  EXPECT_EQ(moto_bytes(moto_frame(moto::kWriteGroup, MotoWrite{2701, 0xff}), ByteOrder::big),
            bytes("00000014 000007d9 00000002 00000000 00000a8d 000000ff"));
  // 1002: this address cannot be written; the reply type says failure too.
  EXPECT_EQ(moto_bytes(moto_frame(moto::kWriteGroupReply, MotoWritten{1002}), ByteOrder::big),
            bytes("00000010 000007da 00000003 00000002 000003ea"));
  EXPECT_EQ(moto_bytes(moto_frame(moto::kWriteRegister, MotoWrite{5, 7}), ByteOrder::big),
            bytes("00000014 000007dd 00000002 00000000 00000005 00000007"));  // 2013
  EXPECT_EQ(moto_bytes(moto_frame(moto::kReadRegister, MotoAddress{5}), ByteOrder::big),
            bytes("00000010 000007dc 00000002 00000000 00000005"));  // 2012
  EXPECT_EQ(moto_bytes(moto_frame(MotoIoRefusal{3, 3003}), ByteOrder::big),
            bytes("00000014 000007db 00000003 00000002 00000003 00000bbb"));
}

TEST(MotoRosGolden,
     DhParametersPerGroup) {  // theta, d, a, alpha of 8 links of 4 groups; 90 = 42b40000, 0.04 = 3d23d70a
  const MotoFrame request{moto::kDhParameters, moto::kRequest, moto::kNoReply, {}};
  EXPECT_EQ(moto_bytes(request, ByteOrder::big), bytes("0000000c 000007e4 00000002 00000000"));
  const std::string little =
      bytes("0c020000 e4070000 03000000 01000000  00000000 00000000 0ad7233d 0000b442") + zeros(124);
  const auto read = parse_moto_dh_parameters(frame_of(little, ByteOrder::little));
  ASSERT_TRUE(read);
  EXPECT_FLOAT_EQ(read->groups[0][0].a, 0.04f);
  EXPECT_EQ(read->groups[0][0].alpha, 90);
  EXPECT_EQ(read->groups[3][7], MotoDhLink{});
  EXPECT_EQ(moto_bytes(moto_frame(*read), ByteOrder::little), little);
  EXPECT_FALSE(parse_moto_dh_parameters(request)) << "a request has no body";
}

TEST(MotoRosGolden, SizesOfTheReference) {
  const auto size = [](const MotoFrame& f) { return moto_bytes(f, ByteOrder::big).size(); };
  EXPECT_EQ(size({moto::kPing, moto::kRequest, 0, {}}), 16u);
  EXPECT_EQ(size(moto_frame(MotoStatus{})), 44u);
  EXPECT_EQ(size(moto_frame(MotoTrajectoryPoint{})), 152u);
  EXPECT_EQ(size(moto_frame(MotoFeedback{})), 148u);
  EXPECT_EQ(size(moto_frame(MotoCommand{})), 68u);
  EXPECT_EQ(size(moto_frame(MotoReply{})), 76u);
  EXPECT_EQ(size(moto_frame(MotoTrajectoryPointEx{})), 552u);
  EXPECT_EQ(size(moto_frame(MotoFeedbackEx{})), 548u);
  EXPECT_EQ(size(moto_frame(MotoSelectTool{})), 28u);
  EXPECT_EQ(size(moto_frame(moto::io_reply(moto::kReadRegister), MotoValue{})), 24u);
  EXPECT_EQ(size(moto_frame(moto::io_reply(moto::kWriteRegister), MotoWritten{})), 20u);
}

TEST(MotoRosFrames, TheByteOrderShowsInTheFirstLength) {
  EXPECT_EQ(moto_byte_order(std::span<const char, 4>(bytes("00000090"))), ByteOrder::big);
  EXPECT_EQ(moto_byte_order(std::span<const char, 4>(bytes("90000000"))), ByteOrder::little);
  EXPECT_EQ(moto_byte_order(std::span<const char, 4>(bytes("48545450"))), std::nullopt) << "HTTP";
  EXPECT_EQ(moto_byte_order(std::span<const char, 4>(bytes("00000000"))), std::nullopt);
  for (std::uint32_t length = 12; length <= 548; length += 4) {  // no length is one in both orders
    const char big[] = {0, 0, static_cast<char>(length >> 8), static_cast<char>(length)};
    EXPECT_EQ(moto_byte_order(big), ByteOrder::big);
  }
}

TEST(MotoRosFrames, ALengthThatNoFrameHasIsAnError) {
  for (const char* first : {"00000000", "0000000b", "0000000d", "0000000e", "00000228", "ffffffff", "7fffffff"}) {
    MotoFrameSplitter splitter(ByteOrder::big);
    splitter.feed(bytes(first) + zeros(4));
    const auto frame = splitter.next();
    ASSERT_FALSE(frame) << first;
    EXPECT_EQ(frame.error().code, core::ErrorCode::link);
    EXPECT_THAT(frame.error().line(), HasSubstr("byte order"));
  }
}

TEST(MotoRosFrames, AnotherTypeOrLengthIsRefused) {
  MotoFrame frame = moto_frame(MotoStatus{});
  EXPECT_FALSE(parse_moto_feedback(frame));
  frame.body.pop_back();
  EXPECT_THAT(parse_moto_status(frame).error().line(), HasSubstr("a body of 24 bytes instead of 28"));
  frame.body.resize(8);
  EXPECT_FALSE(parse_moto_status(frame));
}

TEST(MotoRosFrames, HostsMayLeaveOutTheGroupsTheyDoNotHave) {
  MotoTrajectoryPointEx point;
  point.groups = 1;
  point.sequence = 3;
  point.parts[0].valid = 7;
  point.parts[0].position[5] = 0.5f;
  MotoFrame frame = moto_frame(point);
  frame.body.resize(2 + 33);
  EXPECT_EQ(parse_moto_point_ex(frame).value(), point);
  frame.body.pop_back();
  EXPECT_FALSE(parse_moto_point_ex(frame));
  frame = moto_frame(point);
  frame.body[0] = 5;
  EXPECT_FALSE(parse_moto_point_ex(frame));
  frame.body[0] = 0xffffffff;
  EXPECT_FALSE(parse_moto_point_ex(frame));
}

TEST(MotoRosFrames, AnySplitOfTheStreamGivesTheSameFrames) {
  std::mt19937 random(11);
  for (int round = 0; round < 300; ++round) {
    const ByteOrder order = random() % 2 ? ByteOrder::big : ByteOrder::little;
    std::string stream;
    std::vector<MotoFrame> sent;
    for (std::size_t n = 1 + random() % 4; n > 0; --n) {
      MotoFrame f{static_cast<std::int32_t>(random()), static_cast<std::int32_t>(random()), 1, {}};
      f.body.resize(random() % 135);
      for (auto& w : f.body) w = static_cast<std::uint32_t>(random());
      stream += moto_bytes(f, order);
      sent.push_back(f);
    }
    MotoFrameSplitter splitter(order);
    std::vector<MotoFrame> got;
    for (std::string_view rest = stream; !rest.empty();) {
      const std::size_t n = std::min<std::size_t>(1 + random() % 40, rest.size());
      splitter.feed(rest.substr(0, n));
      rest.remove_prefix(n);
      while (auto frame = splitter.next().value()) got.push_back(*frame);
    }
    EXPECT_EQ(got, sent);
    EXPECT_EQ(splitter.pending(), 0u);
  }
}

/// Everything a message can hold, infinities and NaN patterns too, survives the wire bit by bit.
TEST(MotoRosMessages, RandomMessagesSurviveTheWire) {
  std::mt19937 random(12);
  constexpr int kRounds = 1'000'000;
  for (int round = 0; round < kRounds; ++round) {
    const ByteOrder order = random() % 2 ? ByteOrder::big : ByteOrder::little;
    MotoFrame f;
    constexpr std::int32_t kTypes[] = {13, 14, 15, 2001, 2002, 2003, 2004, 2005, 2006, 2011, 2016, 2017, 2018, 2020};
    constexpr std::size_t kWords[] = {7, 34, 33, 13, 15, 1, 2, 2, 1, 2, 134, 133, 3, 128};
    const std::size_t which = random() % std::size(kTypes);
    f.type = kTypes[which];
    f.comm = static_cast<std::int32_t>(random());
    f.reply = static_cast<std::int32_t>(random());
    f.body.resize(kWords[which]);
    for (auto& w : f.body) w = static_cast<std::uint32_t>(random());
    if (f.type == 2016 || f.type == 2017) f.body[0] %= 5;
    const MotoFrame on_the_wire = frame_of(moto_bytes(f, order), order);
    ASSERT_EQ(on_the_wire, f);
    const auto same = [&](const auto& parsed, auto... type) {
      ASSERT_TRUE(parsed);
      EXPECT_EQ(moto_frame(type..., *parsed).body, f.body);
    };
    switch (f.type) {
      case 13:
        same(parse_moto_status(f));
        break;
      case 14:
        same(parse_moto_point(f));
        break;
      case 15:
        same(parse_moto_feedback(f));
        break;
      case 2001:
        same(parse_moto_command(f));
        break;
      case 2002:
        same(parse_moto_reply(f));
        break;
      case 2003:
        same(parse_moto_address(f, 2003), 2003);
        break;
      case 2004:
        same(parse_moto_value(f, 2004), 2004);
        break;
      case 2005:
        same(parse_moto_write(f, 2005), 2005);
        break;
      case 2006:
        same(parse_moto_written(f, 2006), 2006);
        break;
      case 2011:
        same(parse_moto_io_refusal(f));
        break;
      case 2016:
        same(parse_moto_point_ex(f));
        break;
      case 2017:
        same(parse_moto_feedback_ex(f));
        break;
      case 2018:
        same(parse_moto_select_tool(f));
        break;
      case 2020:
        same(parse_moto_dh_parameters(f));
        break;
      default:
        break;
    }
  }
}

TEST(MotoRosFaults, AreSaidInWordsWithARemedy) {
  EXPECT_EQ(moto_fault(5, 5006).meaning, "not ready (5006): servo power is off");
  EXPECT_EQ(moto_fault(5, 5006).remedy, "switch the servo on");
  EXPECT_THAT(moto_fault(3, 3011).meaning, HasSubstr("does not start where the arm is"));
  EXPECT_THAT(moto_io_fault(1002).meaning, HasSubstr("cannot be written"));
  for (std::int32_t result = -1; result < 9; ++result)
    for (const std::int32_t subcode : {-1, 0, 3000, 3017, 4000, 5012})
      EXPECT_FALSE(moto_fault(result, subcode).meaning.empty() || moto_fault(result, subcode).remedy.empty());
}

}  // namespace
}  // namespace pickcell::robot
