#include "pickcell/robot/tcp80_client.hpp"

#include <arpa/inet.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <sys/socket.h>
#include <unistd.h>

#include <atomic>
#include <functional>
#include <thread>

namespace pickcell::robot {
namespace {

using core::ErrorCode;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

/// What the server waits for, and what it then sends, one segment after the other.
struct Step {
  std::string expect;
  std::vector<std::string> send;
};

enum class Ending { stay, close, reset };

struct Connection {
  std::vector<Step> steps;
  Ending ending = Ending::stay;
};

/// A controller that follows a script, on a real socket. Connections are served one after the other.
class ScriptedServer {
 public:
  explicit ScriptedServer(std::vector<Connection> script) : script_(std::move(script)) {
    listener_ = socket(AF_INET, SOCK_STREAM, 0);
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t size = sizeof address;
    EXPECT_EQ(bind(listener_, reinterpret_cast<sockaddr*>(&address), size), 0);
    EXPECT_EQ(listen(listener_, 4), 0);
    getsockname(listener_, reinterpret_cast<sockaddr*>(&address), &size);
    port_ = ntohs(address.sin_port);
    thread_ = std::thread([this] {
      for (const Connection& connection : script_) serve(connection);
    });
  }
  ~ScriptedServer() {
    (void)finish();
    close(listener_);
  }
  /// Ends the script; everything the client said that was not expected.
  std::string finish() {
    shutdown(listener_, SHUT_RDWR);
    if (thread_.joinable()) thread_.join();
    return surprise_;
  }
  [[nodiscard]] Tcp80Settings settings() const {
    Tcp80Settings s{
        .host = "127.0.0.1", .port = port_, .connect_timeout = {}, .line_timeout = {}, .result_timeout = {}};
    s.connect_timeout = s.line_timeout = s.result_timeout = std::chrono::seconds(20);
    return s;
  }
  [[nodiscard]] int connections() const { return connections_; }

 private:
  void serve(const Connection& connection) {
    const int client = accept(listener_, nullptr, nullptr);
    if (client < 0) return;
    ++connections_;
    const int on = 1;
    setsockopt(client, IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
    bool alive = true;
    for (const Step& step : connection.steps) {
      alive = alive && receive(client, step.expect);
      for (const std::string& piece : step.send) {
        if (alive) alive = send(client, piece.data(), piece.size(), MSG_NOSIGNAL) == static_cast<ssize_t>(piece.size());
      }
    }
    if (connection.ending == Ending::stay) {
      char rest[256];
      for (ssize_t n = 0; (n = recv(client, rest, sizeof rest, 0)) > 0;)
        surprise_.append(rest, static_cast<std::size_t>(n));
    } else if (connection.ending == Ending::reset) {
      const linger now{1, 0};
      setsockopt(client, SOL_SOCKET, SO_LINGER, &now, sizeof now);
    }
    close(client);
  }

  bool receive(int client, const std::string& expected) {
    std::string got;
    char c = 0;
    while (got.size() < expected.size() && recv(client, &c, 1, 0) == 1) got += c;
    if (got != expected) surprise_ += got;
    return got == expected;
  }

  std::vector<Connection> script_;
  int listener_ = -1;
  int port_ = 0;
  std::string surprise_;
  std::atomic<int> connections_ = 0;
  std::thread thread_;
};

std::vector<std::string> byte_by_byte(const std::string& text) {
  std::vector<std::string> pieces;
  for (const char c : text) pieces.emplace_back(1, c);
  return pieces;
}

const Step kHello{"CONNECT Robot_access Keep-Alive:-1\r\n", {"OK: DX Information Server( 1.07) Keep-Alive:-1.\r\n"}};
const Step kStatus{"HOSTCTRL_REQUEST RSTATS 0\r\n", {"OK: RSTATS\r\n", "194,64\r"}};

TEST(Tcp80Client, AsksAndIsAnswered) {
  ScriptedServer server({{{kHello,
                           kStatus,
                           {"HOSTCTRL_REQUEST RPOSC 4\r\n", {"OK: RPOSC\r\n"}},
                           {"0,0\r", {"1.000,2.000,3.000,180.0000,0.0000,90.0000,0,1\r"}},
                           {"HOSTCTRL_REQUEST LOADV 7\r\n", {"OK: LOADV\r\n"}},
                           {"0,10,1\r", {"0000\r\n"}},
                           {"HOSTCTRL_REQUEST SAVEV 5\r\n", {"OK: SAVEV\r\n"}},
                           {"2,12\r", {"0000\r\n"}},  // a value that looks like an acceptance
                           {"HOSTCTRL_REQUEST START 8\r\n", {"OK: START\r\n"}},
                           {"VISPICK\r", {"0000\r\n"}}}}});
  Tcp80Client client(server.settings());
  ASSERT_TRUE(client.connect());
  EXPECT_EQ(client.banner(), "OK: DX Information Server( 1.07) Keep-Alive:-1.");
  EXPECT_TRUE(client.read_status()->servo);
  EXPECT_DOUBLE_EQ(client.read_position(0)->rz_deg, 90);
  EXPECT_TRUE(client.write_integer(VariableType::byte, 10, 1));
  EXPECT_EQ(client.read_integer(VariableType::double_integer, 12).value(), 0);
  EXPECT_TRUE(client.start_job("VISPICK"));
  client.disconnect();
  EXPECT_EQ(server.finish(), "");
}

TEST(Tcp80Client, BareCrServerInOneByteSegments) {  // as the Diamond simulator answers
  ScriptedServer server({{{{kHello.expect, byte_by_byte("OK: NX Information Server(1.0) Keep-Alive:-1.\r")},
                           {kStatus.expect, byte_by_byte("OK: RSTATS\r128,0\r")},
                           {"HOSTCTRL_REQUEST HOLD 2\r\n", byte_by_byte("OK: HOLD\r")},
                           {"1\r", byte_by_byte("0000\r")},
                           {kStatus.expect, byte_by_byte("OK: RSTATS\r128,8\r")}}}});
  Tcp80Client client(server.settings());
  ASSERT_TRUE(client.connect());
  EXPECT_TRUE(client.read_status()->remote);
  EXPECT_TRUE(client.hold(true));
  EXPECT_TRUE(client.read_status()->hold_command);
}

TEST(Tcp80Client, EverythingInOneSegmentAndLateLineFeeds) {
  ScriptedServer server(
      {{{kHello, {kStatus.expect, {"OK: RSTATS\r\n194,64\r"}}, {kStatus.expect, {"\nOK: RSTATS\r", "\n194,0\r"}}}}});
  Tcp80Client client(server.settings());
  ASSERT_TRUE(client.connect());
  EXPECT_TRUE(client.read_status()->servo);
  EXPECT_FALSE(client.read_status()->servo);
}

TEST(Tcp80Client, ARefusalNamesNumberMeaningAndRemedyAndLeavesTheSessionOpen) {
  ScriptedServer server({{{kHello,
                           {"HOSTCTRL_REQUEST SVON 2\r\n", {"OK: SVON\r\n"}},
                           {"1\r", {"ERROR: SVON is not successful(2060).\r\n"}},
                           {"HOSTCTRL_REQUEST START 8\r\n", {"NG: refused (2100).\r\n"}},
                           kStatus}}});
  Tcp80Client client(server.settings());
  ASSERT_TRUE(client.connect());
  const auto refused = client.servo(true);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::refused);
  EXPECT_THAT(refused.error().line(),
              HasSubstr("SVON: refused with 2060: an error or alarm is present; read the alarm"));
  EXPECT_THAT(refused.error().trail, Contains("< ERROR: SVON is not successful(2060)."));
  EXPECT_THAT(client.start_job("VISPICK").error().line(), HasSubstr("2100: command remote is not set"));
  EXPECT_TRUE(client.connected());
  EXPECT_TRUE(client.read_status());
}

TEST(Tcp80Client, OneCommandPerConnection) {
  const Step hello{kHello.expect, {"OK: DX Information Server( 1.16).\r\n"}};
  ScriptedServer server(
      {{{hello, kStatus}, Ending::close},
       {{hello, kStatus}, Ending::close},
       {{hello, {"HOSTCTRL_REQUEST HOLD 2\r\n", {"OK: HOLD\r\n"}}, {"1\r", {"0000\r\n"}}}, Ending::close}});
  Tcp80Client client(server.settings());
  ASSERT_TRUE(client.connect());
  EXPECT_TRUE(client.read_status());
  EXPECT_TRUE(client.read_status());
  EXPECT_TRUE(client.hold(true));
  EXPECT_EQ(server.connections(), 3);
}

TEST(Tcp80Client, AReadIsRepeatedOnceOnANewSession) {
  ScriptedServer server({{{kHello, kStatus}, Ending::close}, {{kHello, kStatus}}});
  Tcp80Client client(server.settings());
  ASSERT_TRUE(client.connect());
  EXPECT_TRUE(client.read_status());
  EXPECT_TRUE(client.read_status());
  EXPECT_EQ(server.connections(), 2);
}

TEST(Tcp80Client, AStartWhoseAnswerIsLostIsNeverRepeated) {
  for (const Ending ending : {Ending::close, Ending::reset}) {
    ScriptedServer server(
        {{{kHello, {"HOSTCTRL_REQUEST START 8\r\n", {"OK: START\r\n"}}, {"VISPICK\r", {}}}, ending}, {{kHello}}});
    Tcp80Client client(server.settings());
    ASSERT_TRUE(client.connect());
    const auto started = client.start_job("VISPICK");
    ASSERT_FALSE(started);
    EXPECT_EQ(started.error().code, ErrorCode::link);
    EXPECT_THAT(started.error().trail, ElementsAre(HasSubstr("CONNECT"), HasSubstr("OK: DX"), HasSubstr("START 8"),
                                                   HasSubstr("OK: START"), HasSubstr("VISPICK")));
    EXPECT_FALSE(client.connected());
    EXPECT_EQ(server.connections(), 1);
  }
}

TEST(Tcp80Client, HalfALineThenTheEnd) {
  ScriptedServer server({{{kHello, {"HOSTCTRL_REQUEST RESET 0\r\n", {"OK: RESET\r\n", "00"}}}, Ending::close}});
  Tcp80Client client(server.settings());
  ASSERT_TRUE(client.connect());
  const auto lost = client.reset_alarm();
  ASSERT_FALSE(lost);
  EXPECT_THAT(lost.error().line(), HasSubstr("closed the connection after half a line: \"00\""));
}

TEST(Tcp80Client, SilenceEndsAtTheDeadlineAndClosesTheSession) {
  ScriptedServer server({{{kHello, {"HOSTCTRL_REQUEST RESET 0\r\n", {}}}}});
  auto settings = server.settings();
  settings.line_timeout = std::chrono::milliseconds(60);
  Tcp80Client client(settings);
  ASSERT_TRUE(client.connect());
  const auto begin = std::chrono::steady_clock::now();
  const auto silent = client.reset_alarm();
  EXPECT_GE(std::chrono::steady_clock::now() - begin, std::chrono::milliseconds(60));
  ASSERT_FALSE(silent);
  EXPECT_EQ(silent.error().code, ErrorCode::timeout);
  EXPECT_THAT(silent.error().line(), HasSubstr("127.0.0.1:" + std::to_string(settings.port)));
  EXPECT_FALSE(client.connected());
}

TEST(Tcp80Client, AnAnswerToSomethingElseClosesTheSession) {
  ScriptedServer server({{{kHello, {"HOSTCTRL_REQUEST RESET 0\r\n", {"OK: RSTATS\r\n", "194,64\r"}}}}});
  Tcp80Client client(server.settings());
  ASSERT_TRUE(client.connect());
  const auto wrong = client.reset_alarm();
  ASSERT_FALSE(wrong);
  EXPECT_THAT(wrong.error().why, HasSubstr("out of step"));
  EXPECT_FALSE(client.connected());
}

TEST(Tcp80Client, WhoeverIsNoControllerIsNamed) {
  ScriptedServer web({Connection{{Step{kHello.expect, {"HTTP/1.1 400 Bad Request\r\n"}}}}});
  const auto greeted = Tcp80Client(web.settings()).connect();
  ASSERT_FALSE(greeted);
  EXPECT_THAT(greeted.error().line(), HasSubstr("HTTP/1.1 400"));
  ScriptedServer full({Connection{{Step{kHello.expect, {"NG: HTTP Error Response\r\n"}}}, Ending::close}});
  EXPECT_THAT(Tcp80Client(full.settings()).connect().error().line(), HasSubstr("NG: HTTP Error Response"));
}

TEST(Tcp80Client, NobodyListening) {
  Tcp80Settings settings;
  {
    ScriptedServer gone({});
    settings = gone.settings();
  }
  Tcp80Client client(settings);
  const auto refused = client.connect();
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::link);
  EXPECT_THAT(refused.error().line(),
              HasSubstr("127.0.0.1:" + std::to_string(settings.port) + ": cannot connect: Connection refused"));
  EXPECT_FALSE(client.read_status());
}

TEST(Tcp80Client, ContactsAreReadAndWrittenInGroupsOfEight) {
  ScriptedServer server({{{kHello,
                           {"HOSTCTRL_REQUEST IOREAD 9\r\n", {"OK: IOREAD\r\n"}},
                           {"27010,16\r", {"5,255\r"}},
                           {"HOSTCTRL_REQUEST IOWRITE 10\r\n", {"OK: IOWRITE\r\n"}},
                           {"27010,8,1\r", {"0000\r\n"}}}}});
  Tcp80Client client(server.settings());
  ASSERT_TRUE(client.connect());
  EXPECT_THAT(client.read_contacts(27010, 2).value(), ElementsAre(5, 255));
  EXPECT_TRUE(client.write_contacts(27010, {1}));
}

/// Sections 1.3 to 1.6, command by command: what is sent is written out from the reference. The size counts the CR.
TEST(Tcp80Client, EveryCommandOfTheReference) {
  struct Row {
    std::string command, operands, answer;
    std::function<bool(Tcp80Client&)> call;
  };
  using C = Tcp80Client&;
  DirectMove move{DirectMove::Kind::joint, 2.5, false, {}};
  move.target.x_mm = 300, move.target.rx_deg = 180, move.target.form.back = true, move.target.tool = 1;
  DirectMove line = move, turn = move, by = move;
  line.kind = DirectMove::Kind::line, turn.kind = DirectMove::Kind::line, turn.turning = true;
  by.kind = DirectMove::Kind::line_by;
  const std::string place = "0,300.000,0.000,0.000,180.0000,0.0000,0.0000,4,1,0,0,0,0,0,0";
  const std::string done = "0000\r\n";
  const std::vector<Row> rows = {
      {"RALARM", "", "0,0,4107,3,0,0,0,0,0,0\r", [](C c) { return c.read_alarms()->at(0).code == 4107; }},
      {"RSTATS", "", "202,64\r", [](C c) { return c.read_status()->running; }},
      {"RPOSJ", "", "1,2,3,4,5,6,0,0,0,0,0,0\r", [](C c) { return c.read_pulses()->at(5) == 6; }},
      {"RPOSC", "3,0", "1.000,2.000,3.000,180.0000,0.0000,0.0000,0,1\r",
       [](C c) { return c.read_position(3)->frame == 3; }},
      {"RJSEQ", "", "VISPICK,12,3\r", [](C c) { return c.read_job()->line == 12; }},
      {"RJDIR", "*", "A,B\r", [](C c) { return c.list_jobs()->size() == 2; }},
      {"RUFRAME", "2", "1,2,3\r", [](C c) { return c.read_user_frame(2).value() == "1,2,3"; }},
      {"SAVEV", "0,99", "255\r", [](C c) { return c.read_integer(VariableType::byte, 99).value() == 255; }},
      {"SAVEV", "1,10", "-2\r", [](C c) { return c.read_integer(VariableType::integer, 10).value() == -2; }},
      {"SAVEV", "3,3", "1.500000\r", [](C c) { return c.read_real(3).value() == 1.5; }},
      {"SAVEV", "4,10", "0,1,2,3,4,5,6,1\r",
       [](C c) { return std::holds_alternative<PulsePosition>(c.read_position_variable(10).value()); }},
      {"SAVEV", "7,5", "A TEXT, OF SORTS\r", [](C c) { return c.read_string(5).value() == "A TEXT, OF SORTS"; }},
      {"IOREAD", "10,8", "129\r", [](C c) { return c.read_contacts(10, 1)->at(0) == 129; }},
      {"LOADV", "2,13,1000000", done,
       [](C c) { return c.write_integer(VariableType::double_integer, 13, 1000000).has_value(); }},
      {"LOADV", "3,3,1.500000", done, [](C c) { return c.write_real(3, 1.5).has_value(); }},
      {"LOADV", "7,5,AB", done, [](C c) { return c.write_string(5, "AB").has_value(); }},
      {"LOADV", "4,10,1,0,300.000,0.000,0.000,180.0000,0.0000,0.0000,4,1", done,
       [=](C c) { return c.write_position_variable(10, move.target).has_value(); }},
      {"IOWRITE", "27010,16,1,128", done, [](C c) { return c.write_contacts(27010, {1, 128}).has_value(); }},
      {"HOLD", "0", done, [](C c) { return c.hold(false).has_value(); }},
      {"RESET", "", done, [](C c) { return c.reset_alarm().has_value(); }},
      {"CANCEL", "", done, [](C c) { return c.cancel_error().has_value(); }},
      {"SVON", "1", done, [](C c) { return c.servo(true).has_value(); }},
      {"MODE", "2", done, [](C c) { return c.set_mode(true).has_value(); }},
      {"CYCLE", "2", done, [](C c) { return c.set_cycle(Cycle::one_cycle).has_value(); }},
      {"HLOCK", "1", done, [](C c) { return c.lock_pendant(true).has_value(); }},
      {"MDSP", "Hello, you", done, [](C c) { return c.show_message("Hello, you").has_value(); }},
      {"JSEQ", "A,7", done, [](C c) { return c.select_job("A", 7).has_value(); }},
      {"SETMJ", "A", done, [](C c) { return c.set_master_job("A").has_value(); }},
      {"DELETE", "A", done, [](C c) { return c.delete_job("A").has_value(); }},
      {"MOVJ", "2.50," + place, done, [=](C c) { return c.move(move).has_value(); }},
      {"MOVL", "0,2.5," + place, done, [=](C c) { return c.move(line).has_value(); }},
      {"MOVL", "1,2.5," + place, done, [=](C c) { return c.move(turn).has_value(); }},
      {"IMOV", "0,2.5," + place, done, [=](C c) { return c.move(by).has_value(); }},
      {"PMOVJ", "2.50,1000,-1000,0,0,0,0,0,0,0,0,0,0,1", done,
       [](C c) { return c.move_pulses({false, 2.5, {{1000, -1000, 0, 0, 0, 0}, 1}}).has_value(); }},
  };
  Connection session{{kHello}};
  for (const Row& row : rows) {
    const std::size_t size = row.operands.empty() ? 0 : row.operands.size() + 1;
    const std::string header = "HOSTCTRL_REQUEST " + row.command + ' ' + std::to_string(size) + "\r\n";
    const std::string ok = "OK: " + row.command + "\r\n";
    if (size == 0) {
      session.steps.push_back({header, {ok, row.answer}});
    } else {
      session.steps.push_back({header, {ok}});
      session.steps.push_back({row.operands + '\r', {row.answer}});
    }
  }
  ScriptedServer server({session});
  Tcp80Client client(server.settings());
  ASSERT_TRUE(client.connect());
  for (const Row& row : rows) EXPECT_TRUE(row.call(client)) << row.command << ' ' << row.operands;
  client.disconnect();
  EXPECT_EQ(server.finish(), "");
}

TEST(Tcp80Client, OperandsCannotBeginAnotherCommand) {
  ScriptedServer server({{{kHello}}});
  Tcp80Client client(server.settings());
  ASSERT_TRUE(client.connect());
  EXPECT_EQ(client.start_job("A\rHOSTCTRL_REQUEST SVON 2").error().code, ErrorCode::usage);
  EXPECT_EQ(client.show_message("A\nB").error().code, ErrorCode::usage);
  EXPECT_THROW((void)client.write_string(1, "A\r"), std::invalid_argument);
  EXPECT_EQ(client.move_pulses({true, 5, {}}).error().code, ErrorCode::usage) << "PMOVL: nobody knows its operands";
  EXPECT_EQ(client.read_register(1).error().code, ErrorCode::usage);
  EXPECT_THAT(client.read_job_text("A").error().line(), HasSubstr("TCP port 80 has no files; use an hses:// link"));
  client.disconnect();
  EXPECT_EQ(server.finish(), "");
}

}  // namespace
}  // namespace pickcell::robot
