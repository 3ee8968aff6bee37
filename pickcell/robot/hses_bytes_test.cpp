// Every command of docs/yaskawa-protocols 2.2 through the client: the bytes on the wire are written out from the
// reference, and so are the answers. docs/robots.md holds the table.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <iomanip>
#include <sstream>

#include "pickcell/robot/hses_client.hpp"
#include "pickcell/robot/hses_scripted_test.hpp"

namespace pickcell::robot {
namespace {

HsesBytes hex(const std::string& text) {
  std::istringstream in(text);
  HsesBytes bytes;
  for (std::string word; in >> word;) bytes.push_back(static_cast<std::uint8_t>(std::stoi(word, nullptr, 16)));
  return bytes;
}

std::string words(const HsesBytes& bytes) {
  std::ostringstream out;
  out << std::hex << std::uppercase << std::setfill('0');
  for (std::size_t i = 0; i < bytes.size(); ++i) out << (i == 0 ? "" : " ") << std::setw(2) << int{bytes[i]};
  return out.str();
}

std::string said(const core::Status& s) { return s ? "done" : s.error().line(); }
template <class Value>
std::string said(const core::Result<Value>& v) {
  if (!v) return v.error().line();
  std::ostringstream out;
  const auto one = [&](const auto& x) {
    if constexpr (std::is_same_v<std::decay_t<decltype(x)>, std::uint8_t>)
      out << int{x} << ' ';
    else
      out << x << ' ';
  };
  if constexpr (requires { v->begin(); } && !std::is_same_v<Value, std::string>)
    for (const auto& x : *v) one(x);
  else
    one(*v);
  return out.str().substr(0, out.str().size() - 1);
}

/// n times "00".
std::string zeros(int n) {
  std::string out;
  for (int i = 0; i < n; ++i) out += " 00";
  return out;
}
/// Text filled up with NULs.
std::string text(const std::string& t, int size) {
  return words(HsesBytes(t.begin(), t.end())) + zeros(size - static_cast<int>(t.size())) + ' ';
}

struct Row {
  const char* name;
  /// Command, instance, attribute, service, padding: bytes 24-31; then the payload.
  std::string request, answer;
  std::function<std::string(HsesClient&)> call;
  std::string says;
};

const std::string kPulse7 = "00 00 00 00" + zeros(16) +  // type pulse, form, tool, user, extended form
                            " 01 00 00 00 FE FF FF FF 03 00 00 00 04 00 00 00 05 00 00 00 06 00 00 00" + zeros(8);

std::vector<Row> reading_rows() {
  using C = HsesClient&;
  const std::string alarm = "0B 10 00 00 03 00 00 00 01 00 00 00 " + text("2026/11/25 13:00", 16) + text("SERVO", 32);
  return {
      {"0x70 active alarm", "70 00 01 00 00 01 00 00", zeros(60),
       [](C c) { return std::to_string(c.read_alarms()->size()); }, "0"},
      {"0x71 alarm history", "71 00 E9 03 00 01 00 00", alarm,
       [](C c) {
         const auto past = c.read_past_alarms(AlarmHistory::monitor, 1);  // 1001 = 0x03E9
         return past->at(0).time + " " + past->at(0).text;
       },
       "2026/11/25 13:00 alarm 4107 [3] SERVO"},
      {"0x72 status", "72 00 01 00 00 01 00 00", "CA 00 00 00 40 00 00 00",  // 202, 64: running in remote play
       [](C c) { return std::string(c.read_status()->running && c.read_status()->servo ? "1" : "0"); }, "1"},
      {"0x73 running job of a subtask", "73 00 02 00 00 01 00 00",
       text("JOB-1", 32) + "07 00 00 00 02 00 00 00 10 27 00 00",
       [](C c) {
         const auto job = c.read_task(2);
         return job->name + ' ' + std::to_string(job->line) + ' ' + std::to_string(job->speed_override);
       },
       "JOB-1 7 10000"},
      {"0x74 axis names", "74 00 01 00 00 01 00 00", "53 00 00 00 4C 00 00 00 55 00 00 00 52 00 00 00" + zeros(16),
       [](C c) { return said(c.read_axis_names()).substr(0, 7); }, "S L U R"},
      {"0x75 pulses", "75 00 01 00 00 01 00 00", kPulse7, [](C c) { return said(c.read_pulses()); },
       "1 -2 3 4 5 6 0 0"},
      {"0x75 base axes", "75 00 0B 00 00 01 00 00", kPulse7,
       [](C c) { return std::to_string(c.read_axes(11)->axes[0]); }, "1"},
      {"0x76 position error", "76 00 01 00 00 01 00 00", "FF FF FF FF" + zeros(28),
       [](C c) { return said(c.read_position_error()); }, "-1 0 0 0 0 0 0 0"},
      {"0x77 torque", "77 00 01 00 00 01 00 00", "64 00 00 00" + zeros(28), [](C c) { return said(c.read_torque()); },
       "100 0 0 0 0 0 0 0"},
      {"0x78 contacts", "78 00 8D 0A 01 0E 00 00", "81", [](C c) { return said(c.read_contacts(27010, 1)); }, "129"},
      {"0x79 register", "79 00 E7 03 01 0E 00 00", "34 12", [](C c) { return said(c.read_register(999)); }, "4660"},
      {"0x7A B", "7A 00 63 00 01 0E 00 00", "FF", [](C c) { return said(c.read_integer(VariableType::byte, 99)); },
       "255"},
      {"0x7B I", "7B 00 0A 00 01 0E 00 00", "FE FF",
       [](C c) { return said(c.read_integer(VariableType::integer, 10)); }, "-2"},
      {"0x7C D", "7C 00 0A 00 01 0E 00 00", "40 42 0F 00",
       [](C c) { return said(c.read_integer(VariableType::double_integer, 10)); }, "1000000"},
      {"0x7D R", "7D 00 03 00 01 0E 00 00", "00 00 C0 3F", [](C c) { return said(c.read_real(3)); }, "1.5"},
      {"0x8C S of 32 bytes", "8C 00 05 00 01 0E 00 00", text("a longer text than 16", 32),
       [](C c) { return said(c.read_string(5)); }, "a longer text than 16"},
      {"0x7F P", "7F 00 0A 00 00 01 00 00",
       "10 00 00 00 04 00 00 00 01 00 00 00" + zeros(8) + " E0 93 04 00" + zeros(28),  // base, no-flip, tool 1, 300 mm
       [](C c) {
         const auto p = std::get<CartesianPosition>(c.read_position_variable(10).value());
         return std::to_string(p.x_mm) + (p.form.no_flip ? " no-flip tool " : " ? ") + std::to_string(p.tool);
       },
       "300.000000 no-flip tool 1"},
      {"0x80 BP", "80 00 01 00 00 01 00 00", "10 00 00 00 39 30 00 00" + zeros(28),
       [](C c) { return std::to_string(c.variables().read_axes(HsesVariables::Axes::base, 1)->axes[0]); }, "12345"},
      {"0x81 EX", "81 00 7F 00 00 01 00 00", "00 00 00 00 07 00 00 00" + zeros(28),
       [](C c) { return std::to_string(c.variables().read_axes(HsesVariables::Axes::station, 127)->axes[0]); }, "7"},
      {"0x88 management time", "88 00 01 00 00 01 00 00", text("2026/11/25 13:00", 16) + text("000012:34:56", 12),
       [](C c) { return c.read_management_time()->start + ' ' + c.read_management_time()->elapsed; },
       "2026/11/25 13:00 000012:34:56"},
      {"0x89 system", "89 00 0B 00 00 01 00 00", text("YAS2.94", 24) + text("GP7", 16) + text("12.3", 8),
       [](C c) { return said(c.identity()); }, "GP7, software YAS2.94"},
      {"0x300 groups", "00 03 8D 0A 00 33 00 00 02 00 00 00", "02 00 00 00 01 80",
       [](C c) { return said(c.variables().read_groups(2701, 2)); }, "1 128"},
      {"0x301 registers", "01 03 00 00 00 33 00 00 02 00 00 00", "02 00 00 00 34 12 FF FF",
       [](C c) { return said(c.variables().read_registers(0, 2)); }, "4660 65535"},
      {"0x302 B", "02 03 0A 00 00 33 00 00 04 00 00 00", "04 00 00 00 01 02 03 FF",
       [](C c) { return said(c.variables().read_integers(VariableType::byte, 10, 4)); }, "1 2 3 255"},
      {"0x303 I", "03 03 0A 00 00 33 00 00 02 00 00 00", "02 00 00 00 01 00 FF FF",
       [](C c) { return said(c.variables().read_integers(VariableType::integer, 10, 2)); }, "1 -1"},
      {"0x304 D", "04 03 0A 00 00 33 00 00 01 00 00 00", "01 00 00 00 40 42 0F 00",
       [](C c) { return said(c.variables().read_integers(VariableType::double_integer, 10, 1)); }, "1000000"},
      {"0x305 R", "05 03 00 00 00 33 00 00 02 00 00 00", "02 00 00 00 00 00 C0 3F 00 00 80 BE",
       [](C c) { return said(c.variables().read_reals(0, 2)); }, "1.5 -0.25"},
      {"0x306 S", "06 03 00 00 00 33 00 00 02 00 00 00", "02 00 00 00 " + text("AB", 16) + text("C", 16),
       [](C c) { return said(c.variables().read_strings(0, 2)); }, "AB C"},
      {"0x307 P", "07 03 0A 00 00 33 00 00 01 00 00 00", "01 00 00 00 " + kPulse7,
       [](C c) { return std::to_string(c.variables().read_positions(10, 1)->at(0).axes[1]); }, "-2"},
      {"0x308 BP", "08 03 00 00 00 33 00 00 01 00 00 00", "01 00 00 00 10 00 00 00 09 00 00 00" + zeros(28),
       [](C c) { return std::to_string(c.variables().read_many_axes(HsesVariables::Axes::base, 0, 1)->at(0).axes[0]); },
       "9"},
  };
}

std::vector<Row> writing_rows() {
  using C = HsesClient&;
  const std::string no_axes = zeros(36);  // base and station axes of a move
  DirectMove line{DirectMove::Kind::line, 50, false, {}};
  line.target.x_mm = 300, line.target.rx_deg = 180, line.target.tool = 1;
  CartesianPosition p;
  p.x_mm = -1, p.frame = 4, p.form.back = true;  // user 3
  return {
      {"0x78 contacts", "78 00 8D 0A 01 10 00 00 81", "", [](C c) { return said(c.write_contacts(27010, {0x81})); },
       "done"},
      {"0x79 register", "79 00 00 00 01 10 00 00 34 12", "", [](C c) { return said(c.write_register(0, 0x1234)); },
       "done"},
      {"0x7A B", "7A 00 0A 00 01 10 00 00 02", "", [](C c) { return said(c.write_integer(VariableType::byte, 10, 2)); },
       "done"},
      {"0x7B I", "7B 00 0A 00 01 10 00 00 FE FF", "",
       [](C c) { return said(c.write_integer(VariableType::integer, 10, -2)); }, "done"},
      {"0x7C D", "7C 00 0A 00 01 10 00 00 40 42 0F 00", "",
       [](C c) { return said(c.write_integer(VariableType::double_integer, 10, 1000000)); }, "done"},
      {"0x7D R", "7D 00 00 00 01 10 00 00 00 00 C0 3F", "", [](C c) { return said(c.write_real(0, 1.5)); }, "done"},
      {"0x7E S", "7E 00 00 00 01 10 00 00 " + text("AB", 16), "", [](C c) { return said(c.write_string(0, "AB")); },
       "done"},
      {"0x8C S", "8C 00 00 00 01 10 00 00 " + text("12345678901234567", 32), "",
       [](C c) { return said(c.write_string(0, "12345678901234567")); }, "done"},
      {"0x7F P",
       "7F 00 0A 00 00 02 00 00 12 00 00 00 01 00 00 00" + zeros(4) + " 03 00 00 00" + zeros(4) + " 18 FC FF FF" +
           zeros(28),
       "", [p](C c) { return said(c.write_position_variable(10, p)); }, "done"},
      {"0x80 BP", "80 00 02 00 00 02 00 00 10 00 00 00 07 00 00 00" + zeros(28), "",
       [](C c) { return said(c.variables().write_axes(HsesVariables::Axes::base, 2, {16, {7}})); }, "done"},
      {"0x82 reset", "82 00 01 00 01 10 00 00 01 00 00 00", "", [](C c) { return said(c.reset_alarm()); }, "done"},
      {"0x82 cancel", "82 00 02 00 01 10 00 00 01 00 00 00", "", [](C c) { return said(c.cancel_error()); }, "done"},
      {"0x83 hold", "83 00 01 00 01 10 00 00 01 00 00 00", "", [](C c) { return said(c.hold(true)); }, "done"},
      {"0x83 servo off", "83 00 02 00 01 10 00 00 02 00 00 00", "", [](C c) { return said(c.servo(false)); }, "done"},
      {"0x83 HLOCK", "83 00 03 00 01 10 00 00 01 00 00 00", "", [](C c) { return said(c.lock_pendant(true)); }, "done"},
      {"0x84 cycle", "84 00 02 00 01 10 00 00 03 00 00 00", "",
       [](C c) { return said(c.set_cycle(Cycle::continuous)); }, "done"},
      {"0x85 message", "85 00 01 00 01 10 00 00 48 69", "", [](C c) { return said(c.show_message("Hi")); }, "done"},
      {"0x87 select", "87 00 01 00 00 02 00 00 " + text("A", 32) + "05 00 00 00", "",
       [](C c) { return said(c.select_job("A", 5)); }, "done"},
      {"0x87 master", "87 00 0A 00 00 02 00 00 " + text("A", 32) + "00 00 00 00", "",
       [](C c) { return said(c.set_master_job("A")); }, "done"},
      {"0x8A line",  // robot 1, station 0, V, 500 (0.1 mm/s), base, 300 mm, Rx 180 deg = 1800000, tool 1
       "8A 00 02 00 01 02 00 00 01 00 00 00 00 00 00 00 01 00 00 00 F4 01 00 00 10 00 00 00 E0 93 04 00" + zeros(8) +
           " 40 77 1B 00" + zeros(8) + zeros(8) + zeros(8) + " 01 00 00 00" + zeros(4) + no_axes,
       "", [line](C c) { return said(c.move(line)); }, "done"},
      {"0x8B joint in pulses",  // robot 1, station 0, 2.50 % = 250, pulses, tool 1
       "8B 00 01 00 01 02 00 00 01 00 00 00 00 00 00 00 00 00 00 00 FA 00 00 00 E8 03 00 00 18 FC FF FF" + zeros(24) +
           " 01 00 00 00" + no_axes,
       "", [](C c) { return said(c.move_pulses({false, 2.5, {{1000, -1000, 0, 0, 0, 0}, 1}})); }, "done"},
      {"0x300 groups", "00 03 8D 0A 00 34 00 00 02 00 00 00 01 80", "",
       [](C c) { return said(c.variables().write_groups(2701, {1, 128})); }, "done"},
      {"0x301 registers", "01 03 00 00 00 34 00 00 01 00 00 00 34 12", "",
       [](C c) { return said(c.variables().write_registers(0, {0x1234})); }, "done"},
      {"0x302 B", "02 03 0A 00 00 34 00 00 02 00 00 00 01 FF", "",
       [](C c) { return said(c.variables().write_integers(VariableType::byte, 10, {1, 255})); }, "done"},
      {"0x303 I", "03 03 0A 00 00 34 00 00 01 00 00 00 FE FF", "",
       [](C c) { return said(c.variables().write_integers(VariableType::integer, 10, {-2})); }, "done"},
      {"0x304 D", "04 03 0A 00 00 34 00 00 01 00 00 00 40 42 0F 00", "",
       [](C c) { return said(c.variables().write_integers(VariableType::double_integer, 10, {1000000})); }, "done"},
      {"0x305 R", "05 03 00 00 00 34 00 00 01 00 00 00 00 00 80 BE", "",
       [](C c) { return said(c.variables().write_reals(0, {-0.25})); }, "done"},
      {"0x306 S", "06 03 00 00 00 34 00 00 01 00 00 00 " + text("AB", 16), "",
       [](C c) { return said(c.variables().write_strings(0, {"AB"})); }, "done"},
      {"0x307 P", "07 03 0A 00 00 34 00 00 01 00 00 00 " + kPulse7, "",
       [](C c) { return said(c.variables().write_positions(10, {{0, 0, 0, 0, 0, {1, -2, 3, 4, 5, 6, 0, 0}}})); },
       "done"},
      {"0x309 EX", "09 03 00 00 00 34 00 00 01 00 00 00 00 00 00 00 07 00 00 00" + zeros(28), "",
       [](C c) { return said(c.variables().write_many_axes(HsesVariables::Axes::station, 0, {{0, {7}}})); }, "done"},
  };
}

void expect_rows(const std::vector<Row>& rows) {
  for (const Row& row : rows) {
    SCOPED_TRACE(row.name);
    const Reply answer = says(hex(row.answer));
    ScriptedController controller({says(kIdle), answer, answer});
    HsesClient client(controller.settings());
    ASSERT_TRUE(client.connect());
    EXPECT_EQ(row.call(client), row.says);
    HsesBytes sent = controller.last_datagram();
    ASSERT_GE(sent.size(), kHsesHeaderBytes);
    sent[11] = 0;  // the request id counts
    const HsesBytes tail = hex(row.request);
    const auto payload = static_cast<unsigned>(tail.size() - 8);
    // YERC, header 0x20, size, 3, robot, no ack, id, block 0, eight nines
    HsesBytes whole = hex("59 45 52 43 20 00 00 00 03 01 00 00 00 00 00 00 39 39 39 39 39 39 39 39");
    whole[6] = static_cast<std::uint8_t>(payload), whole[7] = static_cast<std::uint8_t>(payload >> 8);
    whole.insert(whole.end(), tail.begin(), tail.end());
    EXPECT_EQ(words(sent), words(whole));
  }
}

TEST(HsesBytesOfTheReference, WhatIsRead) { expect_rows(reading_rows()); }
TEST(HsesBytesOfTheReference, WhatIsWrittenSwitchedAndMoved) { expect_rows(writing_rows()); }

TEST(HsesBytesOfTheReference, StringsOfOlderControllersHave16Bytes) {
  ScriptedController controller({says(kIdle), refuses(0xA000), says(hex(text("OLD", 16)))});
  HsesClient client(controller.settings());
  ASSERT_TRUE(client.connect());
  EXPECT_EQ(client.read_string(3).value(), "OLD");
  EXPECT_EQ(words(controller.last_datagram()).substr(24 * 3), "7E 00 03 00 01 0E 00 00");
  EXPECT_THROW((void)client.write_string(3, std::string(33, 'A')), std::invalid_argument);
}

TEST(HsesBytesOfTheReference, AHistoryEndsAtTheFirstEmptyAlarm) {
  const std::string alarm = "0B 10 00 00" + zeros(56);
  ScriptedController controller({says(kIdle), says(hex(alarm)), says(hex(alarm)), says(hex(zeros(60)))});
  HsesClient client(controller.settings());
  ASSERT_TRUE(client.connect());
  EXPECT_EQ(client.read_past_alarms(AlarmHistory::major, 100)->size(), 2u);
  EXPECT_EQ(words(controller.last_datagram()).substr(24 * 3), "71 00 03 00 00 01 00 00");
}

TEST(HsesBytesOfTheReference, WhatNoDatagramHoldsIsNeverSent) {
  ScriptedController controller({says(kIdle)});
  HsesClient client(controller.settings());
  ASSERT_TRUE(client.connect());
  EXPECT_THROW((void)client.variables().read_integers(VariableType::byte, 0, 3), std::invalid_argument) << "odd";
  EXPECT_THROW((void)client.variables().read_integers(VariableType::double_integer, 0, 119), std::invalid_argument);
  EXPECT_THROW((void)client.variables().read_groups(70000, 2), std::invalid_argument);
  EXPECT_THROW((void)client.variables().write_reals(0, {1e300}), std::invalid_argument);
  EXPECT_THROW((void)client.move({DirectMove::Kind::joint, 0, false, {}}), std::invalid_argument) << "no speed";
  EXPECT_EQ(controller.received().size(), 1u);
}

}  // namespace
}  // namespace pickcell::robot
