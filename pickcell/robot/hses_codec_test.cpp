// The bytes are written out from docs/yaskawa-protocols section 2, not taken from the encoder.

#include "pickcell/robot/hses_codec.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <sstream>
#include <stdexcept>

namespace pickcell::robot {
namespace {

using ::testing::ElementsAre;

/// "59 45 52 43 ..." as bytes.
HsesBytes hex(const std::string& text) {
  std::istringstream in(text);
  HsesBytes bytes;
  for (std::string word; in >> word;) bytes.push_back(static_cast<std::uint8_t>(std::stoi(word, nullptr, 16)));
  return bytes;
}

/// A request's header: YERC, size 0x20, data size, 3, division, ack, id, block, eight '9'.
std::string head(const std::string& size, const std::string& division, const std::string& ack, const std::string& id,
                 const std::string& block = "00 00 00 00") {
  return "59 45 52 43 20 00 " + size + " 03 " + division + ' ' + ack + ' ' + id + ' ' + block +
         " 39 39 39 39 39 39 39 39 ";
}

HsesBytes with_id(HsesRequest request, std::uint8_t id) {
  request.id = id;
  return hses_bytes(request);
}

TEST(HsesHeader, RequestsOfTheReference) {
  EXPECT_EQ(with_id(hses_get(0x72, 1), 0), hex(head("00 00", "01", "00", "00") + "72 00 01 00 00 01 00 00"));
  EXPECT_EQ(with_id(hses_get(0x75, 101), 7), hex(head("00 00", "01", "00", "07") + "75 00 65 00 00 01 00 00"));
  EXPECT_EQ(with_id(hses_get(0x7C, 10, 1), 255), hex(head("00 00", "01", "00", "FF") + "7C 00 0A 00 01 0E 00 00"));
  EXPECT_EQ(with_id(hses_set_one(0x7A, 10, {1}), 2),
            hex(head("01 00", "01", "00", "02") + "7A 00 0A 00 01 10 00 00 01"));
  EXPECT_EQ(with_id(hses_power(kHsesServo, true), 3),
            hex(head("04 00", "01", "00", "03") + "83 00 02 00 01 10 00 00 01 00 00 00"));
  EXPECT_EQ(with_id(hses_power(kHsesHold, false), 3),
            hex(head("04 00", "01", "00", "03") + "83 00 01 00 01 10 00 00 02 00 00 00"));
  EXPECT_EQ(with_id(hses_cycle(2), 0), hex(head("04 00", "01", "00", "00") + "84 00 02 00 01 10 00 00 02 00 00 00"));
  EXPECT_EQ(with_id(hses_start(), 0), hex(head("04 00", "01", "00", "00") + "86 00 01 00 01 10 00 00 01 00 00 00"));
  EXPECT_EQ(with_id(hses_message("Hi"), 0), hex(head("02 00", "01", "00", "00") + "85 00 01 00 01 10 00 00 48 69"));
  EXPECT_EQ(with_id(hses_set_one(kHsesReset, kHsesResetAlarm, {1, 0, 0, 0}), 0),
            hex(head("04 00", "01", "00", "00") + "82 00 01 00 01 10 00 00 01 00 00 00"));
}

TEST(HsesHeader, SelectionHasAPaddedNameAndALine) {
  EXPECT_EQ(with_id(hses_select_job("VISPICK", 3), 0),
            hex(head("24 00", "01", "00", "00") +
                "87 00 01 00 00 02 00 00 56 49 53 50 49 43 4B 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 "
                "00 00 00 00 00 00 00 00 03 00 00 00"));
  EXPECT_THROW((void)hses_select_job(std::string(33, 'A'), 0), std::invalid_argument);
  EXPECT_THROW((void)hses_select_job("", 0), std::invalid_argument);
  EXPECT_THROW((void)hses_message(std::string(31, 'A')), std::invalid_argument);
}

TEST(HsesHeader, FilesUsePlainNamesAndMarkedBlocks) {
  EXPECT_EQ(with_id(hses_file(HsesService::file_list, "*.JBI"), 1),
            hex(head("05 00", "02", "00", "01") + "00 00 00 00 00 32 00 00 2A 2E 4A 42 49"));
  EXPECT_EQ(with_id(hses_file(HsesService::file_delete, "A.JBI"), 1),
            hex(head("05 00", "02", "00", "01") + "00 00 00 00 00 09 00 00 41 2E 4A 42 49"));
  EXPECT_EQ(with_id(hses_file_block(HsesService::file_load, 2 | kHsesLastBlock, {0x4E}), 1),
            hex(head("01 00", "02", "01", "01", "02 00 00 80") + "00 00 00 00 00 15 00 00 4E"));
  EXPECT_EQ(with_id(hses_file_block(HsesService::file_save, 1), 1),
            hex(head("00 00", "02", "01", "01", "01 00 00 00") + "00 00 00 00 00 16 00 00"));
}

TEST(HsesHeader, PluralReadsAndWrites) {
  EXPECT_EQ(with_id(hses_read_plural(0x303, 5, 2), 0),
            hex(head("04 00", "01", "00", "00") + "03 03 05 00 00 33 00 00 02 00 00 00"));
  EXPECT_EQ(with_id(hses_write_plural(0x302, 0, 2, {7, 8}), 0),
            hex(head("06 00", "01", "00", "00") + "02 03 00 00 00 34 00 00 02 00 00 00 07 08"));
  struct Limit {
    std::uint16_t command;
    std::uint32_t most;
  };
  for (const auto& [command, most] : std::initializer_list<Limit>{{0x300, 474},
                                                                  {0x301, 237},
                                                                  {0x302, 474},
                                                                  {0x303, 237},
                                                                  {0x304, 118},
                                                                  {0x305, 118},
                                                                  {0x306, 29},
                                                                  {0x307, 9}}) {
    EXPECT_NO_THROW((void)hses_read_plural(command, 0, most)) << command;
    EXPECT_THROW((void)hses_read_plural(command, 0, most + 2), std::invalid_argument) << command;
    EXPECT_LE(4 + most * hses_element_bytes(command), kHsesMostPayload) << command;
  }
  EXPECT_THROW((void)hses_read_plural(0x302, 0, 3), std::invalid_argument) << "an odd count of B";
  EXPECT_THROW((void)hses_read_plural(0x30A, 0, 1), std::invalid_argument);
}

TEST(HsesHeader, AnswersOfTheReference) {
  const auto done = parse_hses_answer(
      hex(head("08 00", "01", "01", "07", "00 00 00 80") + "81 00 00 00 00 00 00 00 C2 00 00 00 40 00 00 00"));
  ASSERT_TRUE(done) << done.error().line();
  EXPECT_EQ(done->id, 7);
  EXPECT_EQ(done->block, 0x80000000u);
  EXPECT_EQ(done->service, HsesService::get_all);
  EXPECT_EQ(done->status, 0);
  const auto state = parse_hses_status(done->payload);
  ASSERT_TRUE(state);
  EXPECT_TRUE(state->remote && state->play && state->one_cycle && state->servo);
  EXPECT_FALSE(state->running || state->teach || state->alarm || state->held());

  const auto refused =
      parse_hses_answer(hex(head("00 00", "01", "01", "07", "00 00 00 80") + "90 1F 01 00 10 20 00 00"));
  ASSERT_TRUE(refused);
  EXPECT_EQ(refused->service, HsesService::set_one);
  EXPECT_EQ(refused->status, 0x1F);
  EXPECT_EQ(refused->added_status, 0x2010);

  HsesAnswer ours;
  ours.id = 7;
  ours.service = HsesService::set_one;
  ours.status = 0x1F;
  ours.added_status = 0x2010;
  EXPECT_EQ(hses_bytes(ours), hex(head("00 00", "01", "01", "07", "00 00 00 80") + "90 1F 01 00 10 20 00 00"));
}

TEST(HsesHeader, WhatIsNotExactlyRightIsNoAnswer) {
  const HsesBytes good = hex(head("01 00", "01", "01", "07", "00 00 00 80") + "8E 00 00 00 00 00 00 00 05");
  ASSERT_TRUE(parse_hses_answer(good));
  for (std::size_t size = 0; size < good.size(); ++size)
    EXPECT_FALSE(parse_hses_answer(HsesView(good).first(size))) << size;
  HsesBytes longer = good;
  longer.push_back(0);
  EXPECT_FALSE(parse_hses_answer(longer));
  for (const std::size_t place : {0u, 3u, 4u, 6u, 9u, 10u, 24u}) {
    HsesBytes bad = good;
    bad[place] ^= 0x40;
    EXPECT_FALSE(parse_hses_answer(bad)) << place;
  }
  for (const std::size_t place : {8u, 16u, 23u}) {  // reserved
    HsesBytes other = good;
    other[place] ^= 0x33;
    EXPECT_TRUE(parse_hses_answer(other)) << place;
  }
}

TEST(HsesHeader, BadRequestsAreToldApart) {
  const HsesBytes good = with_id(hses_set_one(0x7A, 10, {1}), 9);
  ASSERT_TRUE(parse_hses_request(good));
  const auto fault = [](const HsesBytes& bytes) { return parse_hses_request(bytes).error().added_status; };
  HsesBytes b = good;
  b[0] = 'X';
  EXPECT_EQ(fault(b), std::nullopt) << "no answer to strangers";
  EXPECT_EQ(fault({1, 2, 3}), std::nullopt);
  b = good;
  b[4] = 0x21;
  EXPECT_EQ(fault(b), 0xE4A5);
  b = good;
  b[6] = 9;
  EXPECT_EQ(fault(b), 0xE4A7);
  b = good;
  b[9] = 3;
  EXPECT_EQ(fault(b), 0xE4A3);
  EXPECT_EQ(parse_hses_request(b).error().id, 9);
  b = good;
  b[8] = 0x33;  // one client sends that to a real controller
  EXPECT_TRUE(parse_hses_request(b));
}

TEST(HsesPayloads, PositionHasThirteenWords) {
  HsesPosition p;
  p.type = 18;
  p.form = 4;
  p.tool = 2;
  p.user = 3;
  p.axes = {300000, -500, 12346, 1800000, -1, 900000, 0, 0};
  const HsesBytes bytes =
      hex("12 00 00 00 04 00 00 00 02 00 00 00 03 00 00 00 00 00 00 00 E0 93 04 00 0C FE FF FF 3A 30 00 00 "
          "40 77 1B 00 FF FF FF FF A0 BB 0D 00 00 00 00 00 00 00 00 00");
  EXPECT_EQ(hses_payload(p), bytes);
  EXPECT_EQ(parse_hses_position(bytes).value(), p);
  EXPECT_EQ(parse_hses_position(HsesView(bytes).first(44)).value(), p) << "six axes only";
  EXPECT_FALSE(parse_hses_position(HsesView(bytes).first(40)));
  EXPECT_FALSE(parse_hses_position(HsesView(bytes).first(50)));
  const auto v = variable_position(p);
  ASSERT_TRUE(v);
  const auto& c = std::get<CartesianPosition>(*v);
  EXPECT_EQ(c.frame, 4) << "user 3 is frame 4 of RPOSC";
  EXPECT_DOUBLE_EQ(c.x_mm, 300);
  EXPECT_DOUBLE_EQ(c.ry_deg, -0.0001);
  EXPECT_TRUE(c.form.no_flip) << "bit 2 over HSES";
  EXPECT_FALSE(c.form.back);
  p.type = 19;
  EXPECT_FALSE(variable_position(p)) << "tool frame";
}

TEST(HsesPayloads, FormBitsAreNotThoseOfTcp) {
  Form f;
  f.back = true;
  EXPECT_EQ(hses_form(f), 1u);
  f = {};
  f.no_flip = true;
  EXPECT_EQ(hses_form(f), 4u);
  for (std::uint32_t bits = 0; bits < 64; ++bits) EXPECT_EQ(hses_form(hses_form(bits)), bits);
}

TEST(HsesPayloads, MovesOfTheReference) {
  HsesMoveData m;
  m.speed = {1, 500};
  m.target.type = 16;
  m.target.axes = {1, 2, 3, 4, 5, 6, 7, 0};
  m.target.form = 8;
  m.target.tool = 9;
  m.target.user = 10;
  const HsesRequest r = hses_move(HsesMoveKind::line, m);
  EXPECT_EQ(r.command, 0x8A);
  EXPECT_EQ(r.instance, 2);
  EXPECT_EQ(r.attribute, 1);
  EXPECT_EQ(r.service, HsesService::set_all);
  ASSERT_EQ(r.payload.size(), 104u);
  const auto word = [](const HsesBytes& b, std::size_t n) { return HsesReader(HsesView(b).subspan(4 * n)).u32(); };
  constexpr std::array<std::uint32_t, 26> kWords = {1, 0, 1, 500, 16, 1, 2, 3, 4, 5, 6, 7, 0,
                                                    8, 0, 9, 10,  0,  0, 0, 0, 0, 0, 0, 0, 0};
  for (std::size_t n = 0; n < kWords.size(); ++n) EXPECT_EQ(word(r.payload, n), kWords[n]) << n;

  HsesPulseMoveData p;
  p.speed = {0, 250};
  p.pulses = {11, -12, 13, 14, 15, 16, 17, 18};
  p.tool = 5;
  const HsesRequest q = hses_pulse_move(HsesMoveKind::joint, p);
  EXPECT_EQ(q.command, 0x8B);
  ASSERT_EQ(q.payload.size(), 88u);
  constexpr std::array<std::uint32_t, 22> kPulseWords = {1,  0, 0, 250, 11, 0xFFFFFFF4, 13, 14, 15, 16, 17,
                                                         18, 5, 0, 0,   0,  0,          0,  0,  0,  0,  0};
  for (std::size_t n = 0; n < kPulseWords.size(); ++n) EXPECT_EQ(word(q.payload, n), kPulseWords[n]) << n;
}

TEST(HsesPayloads, AlarmJobAndTexts) {
  HsesBytes alarm = hex("0B 10 00 00 03 00 00 00 01 00 00 00");
  const std::string time = "2026/11/22 08:00", name = "OUT OF RANGE";
  alarm.insert(alarm.end(), time.begin(), time.end());
  alarm.insert(alarm.end(), name.begin(), name.end());
  alarm.resize(60);
  const auto a = parse_hses_alarm(alarm);
  ASSERT_TRUE(a);
  EXPECT_EQ(a->code, 4107u);
  EXPECT_EQ(a->time, time);
  EXPECT_EQ(a->name, name);
  EXPECT_EQ(hses_payload(*a), alarm);
  alarm.pop_back();
  EXPECT_FALSE(parse_hses_alarm(alarm));
  alarm.push_back(0);
  for (const auto& [sub_code, size] : {std::pair<std::string, std::size_t>{"INFO", 16}, {"[SLURBT]", 96}, {"", 96}}) {
    alarm.insert(alarm.end(), sub_code.begin(), sub_code.end());
    alarm.resize(alarm.size() + size - sub_code.size());
  }
  ASSERT_EQ(alarm.size(), 268u) << "with sub codes";
  const auto whole = parse_hses_alarm(alarm);
  ASSERT_TRUE(whole);
  EXPECT_EQ(whole->sub_code_info + whole->sub_code_data + whole->sub_code_reverse, "INFO[SLURBT]");
  EXPECT_EQ(hses_payload(*whole), alarm);

  HsesBytes job(44);
  job[0] = 'A', job[32] = 7, job[36] = 2, job[40] = 0x10, job[41] = 0x27;
  const auto j = parse_hses_job(job);
  ASSERT_TRUE(j);
  EXPECT_EQ(j->name, "A");
  EXPECT_EQ(j->line, 7u);
  EXPECT_EQ(j->step, 2u);
  EXPECT_EQ(j->speed_override, 10000u);
  EXPECT_EQ(hses_payload(HsesSystemInfo{"S", "M", "P"}).size(), 48u);
  EXPECT_EQ(hses_payload(HsesManagementTime{"S", "E"}).size(), 28u);
  EXPECT_THAT(parse_hses_file_list("A.JBI\r\nB.JBI\r\n"), ElementsAre("A.JBI", "B.JBI"));
  EXPECT_THAT(parse_hses_file_list("A.JBI"), ElementsAre("A.JBI"));
  EXPECT_TRUE(parse_hses_file_list("").empty());
  const auto many = parse_hses_plural(hex("02 00 00 00 05 00 FB FF"), 0x303, 2);
  ASSERT_TRUE(many);
  EXPECT_THAT(*many, ElementsAre(5, 0, 0xFB, 0xFF));
  EXPECT_FALSE(parse_hses_plural(hex("03 00 00 00 05 00 FB FF"), 0x303, 2)) << "another count";
}

TEST(HsesProperties, EveryMessageComesBackAsItWas) {
  std::mt19937 random(5);
  const auto byte = [&] { return static_cast<std::uint8_t>(random()); };
  constexpr std::array kServices = {HsesService::get_all, HsesService::set_all,   HsesService::get_one,
                                    HsesService::set_one, HsesService::file_load, HsesService::write_plural};
  for (int i = 0; i < 20000; ++i) {
    HsesBytes payload(random() % 480);
    for (std::uint8_t& b : payload) b = byte();
    HsesRequest r{random() % 2 ? HsesDivision::robot : HsesDivision::file,
                  random() % 2 == 0,
                  byte(),
                  static_cast<std::uint32_t>(random()),
                  static_cast<std::uint16_t>(random()),
                  static_cast<std::uint16_t>(random()),
                  byte(),
                  kServices[random() % kServices.size()],
                  payload};
    const auto request = parse_hses_request(hses_bytes(r));
    ASSERT_TRUE(request && *request == r);
    const HsesAnswer a{r.division, r.id, r.block, r.service, byte(), static_cast<std::uint16_t>(random()), payload};
    const auto answer = parse_hses_answer(hses_bytes(a));
    ASSERT_TRUE(answer && *answer == a);
  }
}

TEST(HsesProperties, RandomPositionsSurviveTheWire) {
  std::mt19937 random(11);
  std::uniform_real_distribution<double> mm(-2000, 2000), deg(-180, 180);
  for (int i = 0; i < 2000; ++i) {
    CartesianPosition p;
    p.frame = static_cast<int>(random() % 66);
    p.x_mm = mm(random), p.y_mm = mm(random), p.z_mm = mm(random);
    p.rx_deg = deg(random), p.ry_deg = deg(random), p.rz_deg = deg(random);
    p.form = hses_form(random() % 64);
    p.tool = static_cast<int>(random() % 64);
    const auto words = parse_hses_position(hses_payload(hses_position(p)));
    ASSERT_TRUE(words);
    const auto back = variable_position(*words);
    ASSERT_TRUE(back) << back.error().line();
    const auto& q = std::get<CartesianPosition>(*back);
    EXPECT_NEAR(q.x_mm, p.x_mm, 5.1e-4);
    EXPECT_NEAR(q.rz_deg, p.rz_deg, 5.1e-5);
    EXPECT_TRUE(q.form == p.form && q.tool == p.tool && q.frame == p.frame);
  }
  CartesianPosition broken;
  broken.z_mm = std::nan("");
  EXPECT_THROW((void)hses_position(broken), std::invalid_argument);
  for (const auto& [tool, frame] : {std::pair{-1, 0}, {64, 0}, {1, -1}, {1, 66}}) {
    CartesianPosition p;
    p.tool = tool, p.frame = frame;
    EXPECT_THROW((void)hses_position(p), std::invalid_argument) << tool << ' ' << frame;
  }
}

}  // namespace
}  // namespace pickcell::robot
