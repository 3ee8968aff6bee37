// Random messages through each codec: half of them valid ones with a few bytes changed, half of them noise. Nothing
// crashes (the sanitizers watch), and what was understood is written and understood the same way again.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "noise.hpp"
#include "pickcell/robot/hses_codec.hpp"
#include "pickcell/robot/motoros_codec.hpp"
#include "pickcell/robot/tcp80_codec.hpp"

namespace pickcell::robot {
namespace {

using testing_noise::kMessages;
using testing_noise::Noise;

TEST(RandomMessages, Tcp80) {
  Noise noise(80);
  const std::string valid[] = {"194,64",
                               "1.000,2.000,-3.500,180.0000,0.0000,0.0000,0,1",
                               "1,2,3,4,5,6,0,0,0,0,0,0",
                               "0,0,4107,3,0,0,0,0,0,0",
                               "VISPICK,12,3",
                               "255",
                               "-32768",
                               "12.5",
                               "ERROR: no(2060).",
                               "1,0,300.000,0.000,250.000,180.0000,0.0000,0.0000,0,1",
                               "0,1,2,3,4,5,6,1",
                               "1,255"};
  int understood = 0;
  for (int n = 0; n < kMessages; ++n) {
    const std::string line = noise.coin() ? noise.changed(valid[noise.below(std::size(valid))])
                                          : noise.bytes(60, noise.coin() ? "0123456789,.-+eE ()" : "");
    (void)tcp80_line_kind(line);
    (void)tcp80_fault_code(line);
    (void)tcp80_keeps_alive(line);
    (void)parse_rjseq(line);
    (void)parse_rjdir(line);
    if (const auto state = parse_rstats(line)) ++understood;
    if (const auto pulses = parse_rposj(line)) {
      EXPECT_GE(pulses->size(), 6u);
    }
    if (const auto alarms = parse_ralarm(line)) {
      EXPECT_LE(alarms->size(), 5u);
    }
    if (const auto v = parse_integer_variable(line, VariableType::byte)) {
      EXPECT_TRUE(*v >= 0 && *v <= 255) << line;
    }
    if (const auto v = parse_integer_variable(line, VariableType::integer)) {
      EXPECT_LE(std::abs(*v), 32768) << line;
    }
    if (const auto v = parse_real_variable(line)) {
      EXPECT_TRUE(std::isfinite(*v)) << line;
    }
    if (const auto groups = parse_ioread(line, 2)) {
      EXPECT_EQ(groups->size(), 2u);
    }
    if (const auto p = parse_rposc(line, 0)) {
      EXPECT_TRUE(std::isfinite(p->x_mm) && std::isfinite(p->rz_deg)) << line;
    }
    if (const auto p = parse_position_variable(line, 10)) {
      const std::string written = tcp80_position_fields(*p);
      const auto again = parse_position_variable(written, 10);
      ASSERT_TRUE(again) << line << " -> " << written;
      EXPECT_EQ(tcp80_position_fields(*again), written);
      ++understood;
    }
    Tcp80LineSplitter splitter;
    if (splitter.feed(line))
      while (splitter.next()) ++understood;
  }
  EXPECT_GT(understood, kMessages / 100);
}

HsesBytes octets(std::string_view text) { return {text.begin(), text.end()}; }
std::string text_of(const HsesBytes& bytes) { return {bytes.begin(), bytes.end()}; }

/// Parsed payloads are written the same way again.
template <class Parsed>
void same_again(const Parsed& parsed, Parsed (*parse)(HsesView)) {
  if (!parsed) return;
  const HsesBytes written = hses_payload(*parsed);
  const auto again = parse(written);
  ASSERT_TRUE(again);
  EXPECT_EQ(hses_payload(*again), written);
}

TEST(RandomMessages, Hses) {
  Noise noise(10040);
  int understood = 0;
  for (int n = 0; n < kMessages; ++n) {
    HsesRequest request{HsesDivision::robot,
                        false,
                        static_cast<std::uint8_t>(n),
                        0,
                        static_cast<std::uint16_t>(0x70 + noise.below(32)),
                        static_cast<std::uint16_t>(noise.below(200)),
                        static_cast<std::uint8_t>(noise.below(3)),
                        HsesService::get_one,
                        octets(noise.bytes(104))};
    HsesAnswer answer;
    answer.id = static_cast<std::uint8_t>(n);
    answer.added_status = noise.coin() ? 0 : 0x2060;
    answer.status = answer.added_status != 0 ? 0x1F : 0;
    answer.payload = octets(noise.bytes(kHsesMostPayload));
    const auto whole = parse_hses_answer(hses_bytes(answer));
    ASSERT_TRUE(whole);
    EXPECT_EQ(*whole, answer);
    const auto asked = parse_hses_request(hses_bytes(request));
    ASSERT_TRUE(asked);
    EXPECT_EQ(*asked, request);

    const HsesBytes spoilt =
        octets(noise.coin() ? noise.changed(text_of(noise.coin() ? hses_bytes(answer) : hses_bytes(request)))
                            : noise.bytes(600));
    if (const auto parsed = parse_hses_answer(spoilt)) {
      ++understood;
      const auto again = parse_hses_answer(hses_bytes(*parsed));
      ASSERT_TRUE(again);
      EXPECT_EQ(again->payload, parsed->payload);
    }
    if (const auto parsed = parse_hses_request(spoilt)) {
      ++understood;
      const auto again = parse_hses_request(hses_bytes(*parsed));
      ASSERT_TRUE(again);
      EXPECT_EQ(again->payload, parsed->payload);
    }
    const HsesBytes payload = octets(noise.bytes(120));
    (void)parse_hses_status(payload);
    same_again(parse_hses_alarm(payload), &parse_hses_alarm);
    same_again(parse_hses_job(payload), &parse_hses_job);
    same_again(parse_hses_position(payload), &parse_hses_position);
    same_again(parse_hses_system(payload), &parse_hses_system);
    same_again(parse_hses_time(payload), &parse_hses_time);
    same_again(parse_hses_axes_position(payload), &parse_hses_axes_position);
    (void)parse_hses_string(payload);
    (void)parse_hses_plural(payload, static_cast<std::uint16_t>(0x300 + noise.below(11)), noise.below(30));
    if (const auto p = parse_hses_position(payload)) (void)variable_position(*p);
    (void)parse_hses_move(payload);
    (void)parse_hses_pulse_move(payload);
    (void)parse_hses_axis_names(payload);
    (void)parse_hses_axes(payload);
    (void)parse_hses_file_list(noise.bytes(60, "ABJI.\r\n\t"));
  }
  EXPECT_GT(understood, kMessages / 100);
}

TEST(RandomMessages, MotoRos) {
  Noise noise(50240);
  int understood = 0;
  constexpr std::int32_t kTypes[] = {1, 13, 14, 15, 2001, 2002, 2003, 2004, 2005, 2006, 2011, 2016, 2017, 2018, 2020};
  constexpr std::uint32_t kWords[] = {0, 7, 34, 33, 13, 15, 1, 2, 2, 1, 2, 134, 133, 3, 128};
  for (int n = 0; n < kMessages; ++n) {
    const ByteOrder order = noise.coin() ? ByteOrder::big : ByteOrder::little;
    const std::uint32_t which = noise.below(std::size(kTypes));
    MotoFrame frame{kTypes[which], 2, 0, std::vector<std::uint32_t>(kWords[which])};
    for (std::uint32_t& w : frame.body) w = noise.word();
    const std::string valid = moto_bytes(frame, order);
    const std::string stream = noise.coin() ? noise.changed(valid) + valid : noise.bytes(600);
    MotoFrameSplitter splitter(order);
    splitter.feed(stream);
    for (;;) {
      const auto next = splitter.next();
      if (!next || !*next) break;
      ++understood;
      const MotoFrame& f = **next;
      (void)parse_moto_status(f), (void)parse_moto_feedback(f), (void)parse_moto_feedback_ex(f);
      (void)parse_moto_point(f), (void)parse_moto_point_ex(f), (void)parse_moto_command(f);
      (void)parse_moto_reply(f), (void)parse_moto_select_tool(f), (void)parse_moto_io_refusal(f);
      (void)parse_moto_dh_parameters(f);
      (void)parse_moto_address(f, f.type), (void)parse_moto_write(f, f.type), (void)parse_moto_value(f, f.type);
      MotoFrameSplitter again(order);
      again.feed(moto_bytes(f, order));
      EXPECT_EQ(**again.next(), f);
    }
  }
  EXPECT_GT(understood, kMessages / 10);
}

}  // namespace
}  // namespace pickcell::robot
