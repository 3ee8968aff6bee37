// A recorded move of a real controller (big-endian, seven axes; ros-industrial/packet-simplemessage): its bytes decoded
// and written again, the simulated controller against the recorded client, our client against the recorded controller.

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <map>
#include <optional>
#include <thread>

#include "pcapng.hpp"
#include "pickcell/core/file.hpp"
#include "pickcell/robot/motoros_client.hpp"
#include "pickcell/robot/motoros_codec.hpp"
#include "pickcell/sim/job_interpreter.hpp"
#include "pickcell/sim/motoros_motion.hpp"

namespace pickcell {
namespace {

namespace moto = robot::moto;
using robot::ByteOrder;
using robot::MotoFrame;

constexpr int kMotionPort = 50240, kStatePort = 50241;

struct Message {
  double time_s = 0;
  bool from_controller = false;
  int port = 0;
  MotoFrame frame;
  std::string bytes;
};

class Capture : public ::testing::Test {
 protected:
  void SetUp() override {
    const char* given = std::getenv("PICKCELL_DATA");
    const auto folder = given ? std::filesystem::path(given)
                              : std::filesystem::path(PICKCELL_SOURCE_DIR).parent_path() / "shared" / "data";
    const auto file = folder / "captures" / "motoman_single_group_simple_move.pcapng";
    if (!std::filesystem::exists(file)) GTEST_SKIP() << file << " is not there";
    const auto bytes = core::read_text_file(file);
    ASSERT_TRUE(bytes) << bytes.error().line();
    for (const CapturedSegment& s : tcp_segments(*bytes)) {
      const bool from_controller = s.from_port == kMotionPort || s.from_port == kStatePort;
      robot::MotoFrameSplitter splitter(ByteOrder::big);
      splitter.feed(s.payload);
      const auto frame = splitter.next();
      ASSERT_TRUE(frame && *frame) << (frame ? "unfinished" : frame.error().line());
      ASSERT_EQ(splitter.pending(), 0u) << "one message per segment";
      messages_.push_back({s.time_s, from_controller, from_controller ? s.from_port : s.to_port, **frame, s.payload});
    }
  }
  std::vector<Message> of(int port, bool from_controller) const {
    std::vector<Message> out;
    for (const Message& m : messages_)
      if (m.port == port && m.from_controller == from_controller) out.push_back(m);
    return out;
  }
  std::vector<Message> messages_;
};

TEST_F(Capture, IsUnderstoodAndWrittenAgainByteByByte) {
  std::map<std::int32_t, int> types, results;
  const auto same = [](const Message& m, const auto& parsed) {
    ASSERT_TRUE(parsed);
    EXPECT_EQ(moto_bytes(moto_frame(*parsed), ByteOrder::big), m.bytes);
  };
  for (const Message& m : messages_) {
    EXPECT_EQ(robot::moto_byte_order(std::span<const char, 4>(m.bytes.data(), 4)), ByteOrder::big);
    ++types[m.frame.type];
    switch (m.frame.type) {
      case moto::kRobotStatus:
        same(m, robot::parse_moto_status(m.frame));
        break;
      case moto::kFeedback:
        same(m, robot::parse_moto_feedback(m.frame));
        break;
      case moto::kTrajectoryPoint:
        same(m, robot::parse_moto_point(m.frame));
        break;
      case moto::kMotionControl:
        same(m, robot::parse_moto_command(m.frame));
        break;
      case moto::kMotionReply:
        same(m, robot::parse_moto_reply(m.frame));
        ++results[robot::parse_moto_reply(m.frame)->result];
        break;
      default:
        ADD_FAILURE() << "type " << m.frame.type;
    }
  }
  // The counts of the reference.
  EXPECT_EQ(types, (std::map<std::int32_t, int>{{13, 22}, {14, 58}, {15, 22}, {2001, 2}, {2002, 60}}));
  EXPECT_EQ(results, (std::map<std::int32_t, int>{{moto::ok, 11}, {moto::busy, 48}, {moto::no, 1}}));
}

TEST_F(Capture, StatePairsComeEvery25Ms) {
  double last_s = -1;
  for (const Message& m : of(kStatePort, true)) {
    if (m.frame.type != moto::kFeedback) continue;
    if (last_s >= 0) {
      EXPECT_NEAR(m.time_s - last_s, 0.025, 0.002);
    }
    last_s = m.time_s;
  }
}

/// The recorded messages at their recorded times; the answers are those of the real controller.
TEST_F(Capture, TheSimulatedControllerAnswersTheRecordedClientAsTheRealOneDid) {
  sim::ControllerSettings settings;
  settings.type = "fs100";
  sim::ControllerState state(settings);
  const auto first = robot::parse_moto_feedback(of(kStatePort, true).front().frame).value();
  for (int i = 0; i < 6; ++i) state.q[i] = static_cast<double>(first.position[static_cast<std::size_t>(i)]);
  state.servo = true;
  sim::MotoRosSettings two_ms;
  two_ms.increment_s = 0.002;  // 48 busy answers in these 0.3 s are only explained by 200 increments of 2 ms
  sim::MotoRosMotion motion(two_ms);

  const auto requests = of(kMotionPort, false), replies = of(kMotionPort, true);
  ASSERT_EQ(requests.size(), replies.size());
  constexpr double kTick_s = 0.002;
  double now_s = 0.0015;  // the phase of the real controller's interpolation clock: the one free parameter
  int differing = 0, busy = 0, taken = 0;
  for (std::size_t i = 0; i < requests.size(); ++i) {
    const auto run_until = [&](double t_s) {
      for (; now_s < t_s; now_s += kTick_s) {
        sim::run_tick(state, kTick_s);
        motion.tick(state, kTick_s);
      }
    };
    run_until(requests[i].time_s);
    sim::MotoRosAnswer answer = motion.handle(state, requests[i].frame);
    if (answer.later) {
      while (!(answer.frame = motion.waited(state)) && now_s < 6) run_until(now_s + kTick_s);
      EXPECT_NEAR(now_s - requests[i].time_s, replies[i].time_s - requests[i].time_s, 0.05) << "the start took 110 ms";
    }
    ASSERT_TRUE(answer.frame);
    const auto ours = robot::parse_moto_reply(*answer.frame).value();
    const auto theirs = robot::parse_moto_reply(replies[i].frame).value();
    EXPECT_EQ(ours.command, theirs.command);
    EXPECT_EQ(ours.sequence, theirs.sequence);
    EXPECT_EQ(answer.frame->comm, replies[i].frame.comm);
    EXPECT_EQ(answer.frame->reply, replies[i].frame.reply);
    differing += ours.result != theirs.result;
    busy += ours.result == moto::busy;
    taken += ours.result == moto::ok;
  }
  EXPECT_EQ(differing, 0);
  EXPECT_EQ(busy, 48);
  EXPECT_EQ(taken, 11);
  // It ends where the last point says.
  const auto last = robot::parse_moto_point(requests.back().frame).value();
  for (int n = 0; n < 2000; ++n) sim::run_tick(state, kTick_s), motion.tick(state, kTick_s);
  for (int i = 0; i < 6; ++i)
    EXPECT_NEAR(state.q[i], static_cast<double>(last.position[static_cast<std::size_t>(i)]), 1e-6);
}

/// Plays the recorded controller: state pairs over and over, and the n-th recorded reply to the n-th request.
class RecordedController {
 public:
  RecordedController(std::vector<Message> replies, std::string state)
      : replies_(std::move(replies)), state_(std::move(state)) {
    for (int tries = 0; tries < 50 && !listen_on_two_ports(); ++tries) {
    }
    thread_ = std::jthread([this](const std::stop_token& stop) { run(stop); });
  }
  ~RecordedController() {
    thread_.request_stop();
    thread_.join();
    for (const int fd : {listeners_[0], listeners_[1], hosts_[0], hosts_[1]})
      if (fd >= 0) (void)::close(fd);
  }
  RecordedController(const RecordedController&) = delete;
  RecordedController& operator=(const RecordedController&) = delete;
  [[nodiscard]] int port() const { return port_; }
  /// After the client has had its last reply.
  [[nodiscard]] const std::string& received() const { return received_; }

 private:
  static int listener(int port) {
    sockaddr_in a{};
    a.sin_family = AF_INET;
    a.sin_port = htons(static_cast<std::uint16_t>(port));
    a.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    const int fd = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
    if (::bind(fd, reinterpret_cast<const sockaddr*>(&a), sizeof a) == 0 && ::listen(fd, 2) == 0) return fd;
    (void)::close(fd);
    return -1;
  }
  bool listen_on_two_ports() {
    for (int& fd : listeners_)
      if (fd >= 0) (void)::close(std::exchange(fd, -1));
    sockaddr_in a{};
    socklen_t size = sizeof a;
    listeners_[0] = listener(0);
    if (::getsockname(listeners_[0], reinterpret_cast<sockaddr*>(&a), &size) != 0) return false;
    port_ = ntohs(a.sin_port);
    listeners_[1] = listener(port_ + 1);
    return listeners_[1] >= 0;
  }
  void run(const std::stop_token& stop) {
    std::size_t answered = 0;
    while (!stop.stop_requested()) {
      std::array<pollfd, 3> fds{{{listeners_[0], POLLIN, 0}, {listeners_[1], POLLIN, 0}, {hosts_[0], POLLIN, 0}}};
      (void)::poll(fds.data(), fds.size(), 5);
      for (std::size_t i : {0, 1})
        if (fds[i].revents & POLLIN) hosts_[i] = ::accept(listeners_[i], nullptr, nullptr);
      if (hosts_[1] >= 0) (void)!::send(hosts_[1], state_.data(), state_.size(), MSG_NOSIGNAL | MSG_DONTWAIT);
      if (!(fds[2].revents & POLLIN)) continue;
      std::array<char, 1024> buffer;
      const ssize_t n = ::recv(hosts_[0], buffer.data(), buffer.size(), 0);
      if (n <= 0) return;
      received_.append(buffer.data(), static_cast<std::size_t>(n));
      splitter_.feed({buffer.data(), static_cast<std::size_t>(n)});
      while (splitter_.next().value() && answered < replies_.size()) {
        const std::string& reply = replies_[answered++].bytes;
        (void)!::send(hosts_[0], reply.data(), reply.size(), MSG_NOSIGNAL);
      }
    }
  }

  std::vector<Message> replies_;
  std::string state_;
  std::array<int, 2> listeners_{-1, -1}, hosts_{-1, -1};
  int port_ = 0;
  robot::MotoFrameSplitter splitter_{ByteOrder::big};
  std::string received_;
  std::jthread thread_;
};

TEST_F(Capture, OurClientSendsTheRecordedControllerWhatTheRecordedClientSent) {
  const auto states = of(kStatePort, true);
  RecordedController controller(of(kMotionPort, true), states[0].bytes + states[1].bytes);
  robot::MotoRosClientSettings settings;
  settings.host = "127.0.0.1";
  settings.port = controller.port();
  settings.reply_timeout = std::chrono::seconds(10);
  robot::MotoRosClient client(settings);
  const auto connected = client.connect();
  ASSERT_TRUE(connected) << connected.error().line();
  EXPECT_EQ(client.order(), ByteOrder::big);
  const auto state = client.read_state();
  ASSERT_TRUE(state) << state.error().line();
  EXPECT_EQ(state->status, (robot::MotoStatus{1, 0, 0, 0, 0, 2, 0}));
  EXPECT_NEAR(state->feedback.position[0], -0.95005, 1e-5);

  EXPECT_FALSE(client.ready().value());
  ASSERT_TRUE(client.start_trajectory_mode());
  std::string expected;
  std::optional<std::int32_t> last;
  int busy = 0;
  for (const Message& m : of(kMotionPort, false)) {
    expected += m.bytes;
    if (m.frame.type != moto::kTrajectoryPoint) continue;
    const auto point = robot::parse_moto_point(m.frame).value();
    if (last == point.sequence) continue;  // the repeats are the client's own affair
    last = point.sequence;
    for (;;) {
      const auto taken = client.send_point(point);
      ASSERT_TRUE(taken) << taken.error().line();
      if (*taken == robot::MotoRosClient::Taken::yes) break;
      ++busy;
    }
  }
  EXPECT_EQ(busy, 48);
  EXPECT_EQ(controller.received(), expected);
}

}  // namespace
}  // namespace pickcell
