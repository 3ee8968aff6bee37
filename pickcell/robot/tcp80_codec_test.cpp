#include "pickcell/robot/tcp80_codec.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>
#include <stdexcept>

#include "pickcell/robot/controller_fault.hpp"

namespace pickcell::robot {
namespace {

using ::testing::ElementsAre;
using namespace std::string_view_literals;

std::vector<std::string> lines_of(std::string_view bytes, std::size_t piece = std::string::npos) {
  Tcp80LineSplitter splitter;
  std::vector<std::string> lines;
  while (!bytes.empty()) {
    EXPECT_TRUE(splitter.feed(bytes.substr(0, piece)));
    bytes.remove_prefix(std::min(piece, bytes.size()));
    while (auto line = splitter.next()) lines.push_back(*line);
  }
  return lines;
}

TEST(Tcp80Lines, TheFramingTableOfTheReference) {
  EXPECT_THAT(lines_of("OK: DX Information Server( 1.07) Keep-Alive:-1.\r\nOK: RSTATS\r\n194,0\r"),
              ElementsAre("OK: DX Information Server( 1.07) Keep-Alive:-1.", "OK: RSTATS", "194,0"));
}

TEST(Tcp80Lines, ServersWithBareCrBareLfAndCrNul) {
  EXPECT_THAT(lines_of("OK: RSTATS\r128,0\r"), ElementsAre("OK: RSTATS", "128,0"));
  EXPECT_THAT(lines_of("OK: RSTATS\n128,0\n"), ElementsAre("OK: RSTATS", "128,0"));
  EXPECT_THAT(lines_of("OK: RSTATS\r\n128,0\r\0OK: HOLD\r\n0000\r\n"sv),
              ElementsAre("OK: RSTATS", "128,0", "OK: HOLD", "0000"));
  EXPECT_THAT(lines_of("1\r\0\n2\r\n"sv), ElementsAre("1", "2"));
}

TEST(Tcp80Lines, TheLateLineFeedBelongsToTheLineBefore) {
  Tcp80LineSplitter splitter;
  ASSERT_TRUE(splitter.feed("0000\r"));
  EXPECT_EQ(splitter.next(), "0000");
  ASSERT_TRUE(splitter.feed("\n"));
  EXPECT_EQ(splitter.next(), std::nullopt);
  ASSERT_TRUE(splitter.feed("OK: RSTATS\r\n"));
  EXPECT_EQ(splitter.next(), "OK: RSTATS");
}

TEST(Tcp80Lines, AnySplitOfTheStreamGivesTheSameLines) {
  std::mt19937 random(7);
  const std::string alphabet("\r\n\0ab,0", 7);
  for (int round = 0; round < 3000; ++round) {
    std::string bytes;
    for (std::size_t i = random() % 40; i > 0; --i) bytes += alphabet[random() % alphabet.size()];
    const auto whole = lines_of(bytes);
    EXPECT_EQ(lines_of(bytes, 1), whole);
    EXPECT_EQ(lines_of(bytes, 1 + random() % 7), whole);
  }
}

TEST(Tcp80Lines, AnEndlessLineIsRefused) {
  Tcp80LineSplitter splitter;
  EXPECT_TRUE(splitter.feed(std::string(Tcp80LineSplitter::kMaxLineBytes, 'x')));
  const auto more = splitter.feed("x");
  ASSERT_FALSE(more);
  EXPECT_EQ(more.error().code, core::ErrorCode::link);
}

TEST(Tcp80Lines, AreToldApartByTheirBeginning) {
  EXPECT_EQ(tcp80_line_kind("OK: RSTATS"), Tcp80LineKind::ok);
  EXPECT_EQ(tcp80_line_kind("OK:YR Information Server"), Tcp80LineKind::ok);
  EXPECT_EQ(tcp80_line_kind("NG: HTTP Error Response"), Tcp80LineKind::refused);
  EXPECT_EQ(tcp80_line_kind("0000"), Tcp80LineKind::accepted);
  EXPECT_EQ(tcp80_line_kind("ERROR: START is not successful(2010)."), Tcp80LineKind::error);
  EXPECT_EQ(tcp80_line_kind("0000,1"), Tcp80LineKind::data);
  EXPECT_EQ(tcp80_line_kind(""), Tcp80LineKind::data);
}

TEST(Tcp80Lines, OnlyTheNumberOfAnErrorCounts) {
  EXPECT_EQ(tcp80_fault_code("ERROR: START is not successful(2010)."), 0x2010);
  EXPECT_EQ(tcp80_fault_code("ERROR: START is not successful(1111)"), 0x1111);
  EXPECT_EQ(tcp80_fault_code("ERROR: (x) something else( 2060)."), 0x2060);
  for (const char* none :
       {"ERROR: no number", "ERROR: (20x0).", "ERROR: (206).", "ERROR: (20600).", "ERROR: (2060", "(-206)"})
    EXPECT_EQ(tcp80_fault_code(none), std::nullopt) << none;
  EXPECT_EQ(controller_fault(0x2060).meaning, "an error or alarm is present");
  EXPECT_EQ(controller_fault(0x4040).meaning, "no such job");
  EXPECT_EQ(controller_fault(0xD8F1).meaning, "busy with another command");
  EXPECT_EQ(controller_fault(0x1234).meaning, "unknown refusal");
}

TEST(Tcp80Requests, SizeCountsTheCr) {  // the examples of section 1.1
  EXPECT_EQ(tcp80_connect(), "CONNECT Robot_access Keep-Alive:-1\r\n");
  EXPECT_EQ(tcp80_request("SVON", "1").header, "HOSTCTRL_REQUEST SVON 2\r\n");
  EXPECT_EQ(tcp80_request("SVON", "1").operands, "1\r");
  EXPECT_EQ(tcp80_request("RPOSC", "0,0").header, "HOSTCTRL_REQUEST RPOSC 4\r\n");
  EXPECT_EQ(tcp80_request("RSTATS").header, "HOSTCTRL_REQUEST RSTATS 0\r\n");
  EXPECT_EQ(tcp80_request("RSTATS").operands, "");
}

TEST(Tcp80Requests, KeepAliveIsReadFromTheBanner) {
  EXPECT_TRUE(tcp80_keeps_alive("OK: DX Information Server( 1.07) Keep-Alive:-1."));
  EXPECT_FALSE(tcp80_keeps_alive("OK: DX Information Server( 1.16)."));
}

TEST(Tcp80Variables, OperandsOfTheReference) {
  EXPECT_EQ(tcp80_read_variable(VariableType::position, 10), "4,10");
  EXPECT_EQ(tcp80_write_integer(VariableType::byte, 10, 1), "0,10,1");
  EXPECT_EQ(tcp80_write_integer(VariableType::double_integer, 13, -2147483647 - 1), "2,13,-2147483648");
  EXPECT_EQ(tcp80_write_real(3, 0.5), "3,3,0.500000");
  CartesianPosition p{.x_mm = 300,
                      .y_mm = -0.5,
                      .z_mm = 12.3456,
                      .rx_deg = 180,
                      .ry_deg = -0.00004,
                      .rz_deg = 90,
                      .re_deg = {},
                      .form = {},
                      .tool = 1};
  p.form.no_flip = p.form.s_over_180 = true;
  EXPECT_EQ(tcp80_write_position(10, p), "4,10,1,0,300.000,-0.500,12.346,180.0000,-0.0000,90.0000,33,1");
  EXPECT_EQ(tcp80_write_position(7, PulsePosition{{1, -2, 3, 4, 5, 6}, 2}), "4,7,0,1,-2,3,4,5,6,2");
}

TEST(Tcp80Variables, APositionThatIsNoNumberIsNeverWritten) {
  CartesianPosition p;
  p.x_mm = std::nan("");
  EXPECT_THROW((void)tcp80_position_fields(p), std::invalid_argument);
  p.x_mm = std::numeric_limits<double>::infinity();
  EXPECT_THROW((void)tcp80_position_fields(p), std::invalid_argument);
}

TEST(Tcp80Variables, ToolFrameAndSpeedThatCannotBeAreNeverSent) {
  CartesianPosition p;
  for (const auto& [tool, frame] : {std::pair{-1, 0}, {64, 0}, {1, -1}, {1, 66}}) {
    p.tool = tool, p.frame = frame;
    EXPECT_THROW((void)tcp80_write_position(10, p), std::invalid_argument) << tool << ' ' << frame;
    EXPECT_THROW((void)tcp80_move(DirectMove{DirectMove::Kind::joint, 1, false, p}), std::invalid_argument);
  }
  for (const double speed : {0.0, -1.0, std::nan("")})
    EXPECT_THROW((void)tcp80_move(DirectMove{DirectMove::Kind::line, speed, false, {}}), std::invalid_argument);
  EXPECT_THROW((void)tcp80_move(PulseMove{false, 1, {{}, 64}}), std::invalid_argument);
}

TEST(Tcp80Variables, PositionsComeBackAsWritten) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> mm(-2000, 2000), deg(-180, 180);
  for (int i = 0; i < 500; ++i) {
    CartesianPosition p;
    p.frame = static_cast<int>(random() % 66);
    p.x_mm = mm(random), p.y_mm = mm(random), p.z_mm = mm(random);
    p.rx_deg = deg(random), p.ry_deg = deg(random), p.rz_deg = deg(random);
    p.form = tcp80_form(static_cast<int>(random() % 64));
    p.tool = static_cast<int>(random() % 64);
    if (random() % 2) p.re_deg = deg(random);
    const std::string prefix = random() % 2 ? "4,12," : "";
    const auto back = parse_position_variable(prefix + tcp80_position_fields(p), 12);
    ASSERT_TRUE(back) << back.error().line();
    const auto& q = std::get<CartesianPosition>(*back);
    EXPECT_NEAR(q.x_mm, p.x_mm, 5.1e-4);
    EXPECT_NEAR(q.z_mm, p.z_mm, 5.1e-4);
    EXPECT_NEAR(q.rz_deg, p.rz_deg, 5.1e-5);
    EXPECT_EQ(q.form, p.form);
    EXPECT_EQ(q.tool, p.tool);
    EXPECT_EQ(q.frame, p.frame);
    EXPECT_EQ(q.re_deg.has_value(), p.re_deg.has_value());
  }
  const auto pulse = parse_position_variable("0, 1,-2,3,4,5,6, 2", 1);
  ASSERT_TRUE(pulse);
  EXPECT_EQ(std::get<PulsePosition>(*pulse), (PulsePosition{{1, -2, 3, 4, 5, 6}, 2}));
}

TEST(Tcp80Variables, RangesAreKept) {
  EXPECT_EQ(parse_integer_variable(" 255", VariableType::byte).value(), 255);
  EXPECT_FALSE(parse_integer_variable("256", VariableType::byte));
  EXPECT_FALSE(parse_integer_variable("-1", VariableType::byte));
  EXPECT_EQ(parse_integer_variable("-32768", VariableType::integer).value(), -32768);
  EXPECT_FALSE(parse_integer_variable("32768", VariableType::integer));
  EXPECT_EQ(parse_integer_variable("2147483647", VariableType::double_integer).value(), 2147483647);
  EXPECT_FALSE(parse_integer_variable("2147483648", VariableType::double_integer));
  for (const char* bad : {"", " ", "1,2", "1.0", "+1", "0x10", "1e3", "1 2"}) {
    EXPECT_FALSE(parse_integer_variable(bad, VariableType::double_integer)) << bad;
  }
  EXPECT_DOUBLE_EQ(parse_real_variable("-1.5E-3").value(), -1.5e-3);
  for (const char* bad : {"", "nan", "inf", "1,5", "1e999"}) EXPECT_FALSE(parse_real_variable(bad)) << bad;
}

TEST(Tcp80Answers, StatusBitsOfTheReference) {
  const auto idle = parse_rstats("194,0");  // seen on an NX100: idle, remote play, one cycle
  ASSERT_TRUE(idle);
  EXPECT_TRUE(idle->remote && idle->play && idle->one_cycle);
  EXPECT_FALSE(idle->running || idle->servo || idle->alarm || idle->teach || idle->held());
  EXPECT_TRUE(parse_rstats("202,64")->running);
  EXPECT_TRUE(parse_rstats("202, 64")->servo);
  const auto held = parse_rstats("32,58");
  EXPECT_TRUE(held->teach && held->hold_pendant && held->hold_command && held->alarm && held->error);
  EXPECT_FALSE(held->hold_external);
  for (const char* bad : {"194", "194,0,0", "194,", "256,0", "-1,0", "a,b", ""}) EXPECT_FALSE(parse_rstats(bad)) << bad;
}

TEST(Tcp80Answers, PositionWithAndWithoutExternalAxes) {
  const auto p = parse_rposc("560.000,-1.250,485.000,180.0000,-90.0000,45.1234,4,1", 0);
  ASSERT_TRUE(p);
  EXPECT_DOUBLE_EQ(p->y_mm, -1.25);
  EXPECT_DOUBLE_EQ(p->rz_deg, 45.1234);
  EXPECT_TRUE(p->form.back);
  EXPECT_FALSE(p->form.no_flip);
  EXPECT_EQ(p->tool, 1);
  EXPECT_FALSE(p->re_deg);
  const auto seven = parse_rposc("1,2,3,4,5,6,7.5,0,0, 0,0,0,0,0,0", 2);
  ASSERT_TRUE(seven);
  EXPECT_DOUBLE_EQ(seven->re_deg.value(), 7.5);
  EXPECT_EQ(seven->frame, 2);
  EXPECT_TRUE(parse_rposc("1,2,3,4,5,6,0,0,0,0,0,0,0,0", 0));
  for (const char* bad : {"1,2,3,4,5,6,0", "1,2,3,4,5,nan,0,0", "1,2,3,4,5,6,0,64", "1,2,3,4,5,6,0,0,0,0"})
    EXPECT_FALSE(parse_rposc(bad, 0)) << bad;
}

TEST(Tcp80Answers, AlarmsJobsPulsesAndContacts) {
  EXPECT_TRUE(parse_ralarm("0,0,0,0,0,0,0,0,0,0")->empty());
  const auto alarms = parse_ralarm("0,0,4107,3,1325,1,0,0,0,0");
  ASSERT_TRUE(alarms);
  ASSERT_EQ(alarms->size(), 2u);
  EXPECT_EQ(alarms->front().code, 4107);
  EXPECT_EQ(alarms->front().data, 3);
  EXPECT_FALSE(parse_ralarm("0,0,0"));
  EXPECT_FALSE(parse_ralarm("0,0,0,0,0,0,0,0,0,x"));
  const auto job = parse_rjseq("VISPICK,12,3");
  ASSERT_TRUE(job);
  EXPECT_EQ(job->name, "VISPICK");
  EXPECT_EQ(job->line, 12);
  EXPECT_FALSE(parse_rjseq("VISPICK,12"));
  EXPECT_EQ(parse_rposj("1,2,3,4,5,6,0,0,0,0,0,0")->at(5), 6);
  EXPECT_FALSE(parse_rposj("1,2,3"));
  EXPECT_THAT(parse_ioread("1, 255", 2).value(), ElementsAre(1, 255));
  EXPECT_FALSE(parse_ioread("1,255", 1));
  EXPECT_FALSE(parse_ioread("256", 1));
}

TEST(Tcp80Answers, RandomTextNeverCrashesAParser) {
  std::mt19937 random(11);
  const std::string alphabet = "0123456789,,,,,..-+eE ():OKNGERROR\t\xff\x01naif";
  for (int round = 0; round < 20000; ++round) {
    std::string line;
    for (std::size_t i = random() % 60; i > 0; --i) line += alphabet[random() % alphabet.size()];
    (void)tcp80_line_kind(line);
    (void)tcp80_fault_code(line);
    (void)parse_rstats(line);
    (void)parse_rposc(line, 0);
    (void)parse_rposj(line);
    (void)parse_ralarm(line);
    (void)parse_rjseq(line);
    (void)parse_real_variable(line);
    (void)parse_ioread(line, 1);
    if (const auto p = parse_position_variable(line, 1)) (void)tcp80_position_fields(*p);
  }
}

TEST(Tcp80Codec, WhatTheOtherSideSaysIsShownWithoutItsControlCharacters) {
  EXPECT_EQ(tcp80_shown("OK: \x1b[31m\xff\r"), "OK: ?[31m??");
  EXPECT_EQ(tcp80_shown(std::string(5000, 'x')), std::string(120, 'x') + "...");
}

}  // namespace
}  // namespace pickcell::robot
