#include "pickcell/robot/motoros_client.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "pickcell/robot/motoros_fault.hpp"

namespace pickcell::robot {

using core::ErrorCode;

namespace {

constexpr int kStateOffset = 1, kIoOffset = 2;

bool session_broke(const core::Error& error) {
  return error.code == ErrorCode::link || error.code == ErrorCode::timeout;
}

std::string in_words(const MotoFrame& frame) {
  std::string text = "type " + std::to_string(frame.type);
  constexpr std::size_t kShown = 5;
  for (std::size_t i = 0; i < frame.body.size() && i < kShown; ++i)
    text += (i == 0 ? ": " : ", ") + std::to_string(static_cast<std::int32_t>(frame.body[i]));
  return frame.body.size() > kShown ? text + ", ..." : text;
}

}  // namespace

MotoRosClient::MotoRosClient(MotoRosClientSettings settings)
    : settings_(std::move(settings)), order_(settings_.order) {}

std::string MotoRosClient::peer() const { return settings_.host + ':' + std::to_string(settings_.port); }

void MotoRosClient::remember(char direction, const MotoFrame& frame) {
  trail_.add(std::string(1, direction) + ' ' + in_words(frame));
}

core::Status MotoRosClient::open(Port& port, int offset) {
  port = {};
  auto link = ByteLink::connect(settings_.host, settings_.port + offset, from_now(settings_.connect_timeout));
  if (!link) return core::forward(link);
  port.link = std::move(*link);
  if (order_) port.splitter.emplace(*order_);
  return {};
}

/// The controller speaks first here; the length of its first message shows its byte order.
core::Status MotoRosClient::open_state() {
  if (auto opened = open(state_, kStateOffset); !opened) return opened;
  if (order_) return {};
  std::string first;
  const WallDeadline deadline = from_now(settings_.state_timeout);
  while (first.size() < 4) {
    std::array<char, 256> buffer;
    auto n = state_.link->read(buffer, deadline);
    if (!n) {
      state_ = {};
      return core::forward(n);
    }
    first.append(buffer.data(), *n);
  }
  order_ = settings_.order = moto_byte_order(std::span<const char, 4>(first.data(), 4));
  if (!order_) {
    state_ = {};
    return core::failure(ErrorCode::link, settings_.host + ':' + std::to_string(settings_.port + kStateOffset),
                         "this is no MotoROS: the first bytes are no message", "check host and port");
  }
  state_.splitter.emplace(*order_);
  state_.splitter->feed(first);
  return {};
}

core::Status MotoRosClient::connect() {
  disconnect();
  trail_.clear();
  if (auto opened = open_state(); !opened) return opened;
  return open(motion_, 0);
}

void MotoRosClient::disconnect() {
  for (Port* port : {&motion_, &state_, &io_}) *port = Port{};
}

core::Result<MotoFrame> MotoRosClient::frame(Port& port, WallDeadline deadline) {
  for (;;) {
    auto next = port.splitter->next();
    if (!next) return core::forward(next);
    if (*next) return std::move(**next);
    std::array<char, 4096> buffer;
    auto n = port.link->read(buffer, deadline);
    if (!n && port.splitter->pending() > 0)
      n.error().why += " after " + std::to_string(port.splitter->pending()) + " bytes of a message";
    if (!n) return core::forward(n);
    port.splitter->feed({buffer.data(), *n});
  }
}

// --- state ---

core::Result<MotoRosState> MotoRosClient::fresh_pair() {
  const WallDeadline deadline = from_now(settings_.state_timeout);
  for (;;) {  // what waited is older
    auto old = frame(state_, std::chrono::steady_clock::now());
    if (auto early = in_time(peer(), deadline); !early) return core::forward(early);
    if (old) continue;
    if (old.error().code != ErrorCode::timeout) return core::forward(old);
    break;
  }
  std::optional<MotoFeedback> feedback;
  for (;;) {
    if (auto early = in_time(peer(), deadline); !early) return core::forward(early);
    auto next = frame(state_, deadline);
    if (!next) return core::forward(next);
    if (next->type == moto::kFeedback) {
      auto parsed = parse_moto_feedback(*next);
      if (!parsed) return core::forward(parsed);
      if (!std::ranges::all_of(parsed->position, [](float rad) { return std::isfinite(rad); }))
        return core::failure(ErrorCode::link, peer(), "the position it tells is no number",
                             "check that the address is a MotoROS controller");
      if (parsed->group == 0) feedback = *parsed;
    } else if (next->type == moto::kRobotStatus && feedback) {
      auto status = parse_moto_status(*next);
      if (!status) return core::forward(status);
      return MotoRosState{*status, *feedback};
    }
  }
}

core::Result<MotoRosState> MotoRosClient::read_state() {
  for (int attempt = 1;; ++attempt) {
    core::Status opened;
    if (!state_.link) opened = open_state();
    auto pair = opened ? fresh_pair() : core::Result<MotoRosState>(core::forward(opened));
    if (pair) return pair;
    state_ = {};
    if (attempt == 2) return tl::unexpected(trail_.onto(std::move(pair.error())));
  }
}

// --- motion ---

core::Result<MotoFrame> MotoRosClient::exchange(Port& port, const MotoFrame& request, std::int32_t reply_type,
                                                std::chrono::milliseconds timeout) {
  const WallDeadline deadline = from_now(timeout);
  remember('>', request);
  // One write per message: the controller mishandles messages that arrive in pieces.
  auto sent = port.link->write(moto_bytes(request, *order_), deadline);
  auto answer = sent ? frame(port, deadline) : core::Result<MotoFrame>(core::forward(sent));
  if (answer) {
    remember('<', *answer);
    if (answer->type == reply_type || answer->type == moto::kIoReply) return answer;
    answer = core::failure(ErrorCode::link, peer(), "out of step: " + in_words(*answer), "connect again");
  }
  if (answer.error().code == ErrorCode::timeout && &port == &motion_)
    port.doubtful = true;
  else
    port = {};
  return tl::unexpected(trail_.onto(std::move(answer.error())));
}

/// Nothing waits to be read before anything was asked. What does is late or doubled, and would be taken for the answer
/// to the next question: those of the I/O port carry no number.
bool MotoRosClient::quiet(Port& port) {
  const auto stray = frame(port, std::chrono::steady_clock::now());
  if (stray) remember('<', *stray);
  return !stray && stray.error().code == ErrorCode::timeout && port.splitter->pending() == 0;
}

core::Result<MotoReply> MotoRosClient::ask(const MotoFrame& request, const std::string& what,
                                           std::chrono::milliseconds timeout) {
  if (!connected()) return core::failure(ErrorCode::link, peer(), "not connected", "connect first");
  if (!quiet(motion_)) {
    motion_ = {};
    return tl::unexpected(trail_.onto(
        {ErrorCode::link, peer() + ' ' + what, "out of step: lost, or answered unasked", "connect again", {}}));
  }
  auto answer = exchange(motion_, request, moto::kMotionReply, timeout);
  if (!answer) {
    answer.error().what += ' ' + what;
    return core::forward(answer);
  }
  auto reply = parse_moto_reply(*answer);
  // The reply names what it answers; one to something else is late or doubled.
  const bool control = request.type == moto::kMotionControl;
  const auto asked = control ? static_cast<std::int32_t>(request.body[2]) : request.type;
  const std::size_t at = request.type == moto::kSelectTool ? 2 : 1;
  const auto sequence = static_cast<std::int32_t>(request.body[at]);
  if (reply && (reply->command != asked || (reply->sequence != sequence && reply->result != moto::invalid)))
    reply = core::failure(ErrorCode::link, peer() + ' ' + what, "out of step: " + in_words(*answer), "connect again");
  if (!reply) {
    motion_ = {};
    return tl::unexpected(trail_.onto(std::move(reply.error())));
  }
  last_reply_ = *reply;
  return reply;
}

core::Status MotoRosClient::command(std::int32_t command, const std::string& what, std::chrono::milliseconds timeout) {
  MotoCommand c;
  c.command = command;
  auto reply = ask(moto_frame(c), what, timeout);
  if (!reply) return core::forward(reply);
  if (reply->result == moto::ok) return {};
  const MotoFault fault = moto_fault(reply->result, reply->subcode);
  return tl::unexpected(trail_.onto({ErrorCode::refused, peer() + ' ' + what, fault.meaning, fault.remedy, {}}));
}

core::Result<bool> MotoRosClient::ready() {
  MotoCommand c;
  c.command = moto::kCheckReady;
  auto reply = ask(moto_frame(c), "check ready", settings_.reply_timeout);
  if (!reply) return core::forward(reply);
  return reply->result == moto::ok;
}

core::Status MotoRosClient::start_trajectory_mode() {
  return command(moto::kStartTrajectoryMode, "start trajectory mode", settings_.start_timeout);
}

core::Status MotoRosClient::stop_trajectory_mode() {
  return command(moto::kStopTrajectoryMode, "stop trajectory mode", settings_.reply_timeout);
}

/// Replies to what was asked before are passed over.
core::Status MotoRosClient::stop_on_this_connection() {
  const WallDeadline deadline = from_now(settings_.reply_timeout);
  MotoCommand stop;
  stop.command = moto::kStop;
  const MotoFrame request = moto_frame(stop);
  remember('>', request);
  if (auto sent = motion_.link->write(moto_bytes(request, *order_), deadline); !sent) return sent;
  for (;;) {
    auto answer = frame(motion_, deadline);
    if (!answer) return core::forward(answer);
    remember('<', *answer);
    const auto reply = parse_moto_reply(*answer);
    if (!reply || reply->command != moto::kStop) {
      if (auto early = in_time(peer(), deadline); !early) return early;
      continue;
    }
    if (reply->result == moto::ok) return {};
    const MotoFault fault = moto_fault(reply->result, reply->subcode);
    return core::failure(ErrorCode::refused, peer() + " stop", fault.meaning, fault.remedy);
  }
}

core::Status MotoRosClient::stop() {
  if (!order_) return core::failure(ErrorCode::link, peer(), "byte order not known yet", "connect first");
  const bool doubtful = motion_.doubtful;
  core::Status stopped;
  if (motion_.link) {
    stopped = stop_on_this_connection();
    if (doubtful || !stopped) motion_ = {};
    if (stopped) return stopped;
  }
  if (auto opened = open(motion_, 0); !opened) return opened;
  stopped = stop_on_this_connection();
  if (!stopped) {
    motion_ = {};
    return tl::unexpected(trail_.onto(std::move(stopped.error())));
  }
  return stopped;
}

core::Status MotoRosClient::servo(bool on) {
  return command(on ? moto::kServoOn : moto::kServoOff, on ? "servo on" : "servo off", settings_.start_timeout);
}

core::Status MotoRosClient::reset_alarm() { return command(moto::kResetAlarm, "reset alarm", settings_.reply_timeout); }

core::Status MotoRosClient::select_tool(int tool) {
  auto reply = ask(moto_frame(MotoSelectTool{0, tool, 0}), "select tool", settings_.reply_timeout);
  if (!reply) return core::forward(reply);
  if (reply->result == moto::ok) return {};
  const MotoFault fault = moto_fault(reply->result, reply->subcode);
  return tl::unexpected(trail_.onto({ErrorCode::refused, peer() + " select tool", fault.meaning, fault.remedy, {}}));
}

core::Result<MotoDhParameters> MotoRosClient::read_dh_parameters() {
  if (!connected()) return core::failure(ErrorCode::link, peer(), "not connected", "connect first");
  const MotoFrame request{moto::kDhParameters, moto::kRequest, moto::kNoReply, {}};
  auto answer = exchange(motion_, request, moto::kDhParameters, settings_.reply_timeout);
  if (!answer) return core::forward(answer);
  if (answer->reply == moto::kFailure)
    return tl::unexpected(trail_.onto({ErrorCode::refused,
                                       peer() + " DH parameters",
                                       "the controller cannot read them out",
                                       "use the arm's data sheet",
                                       {}}));
  return parse_moto_dh_parameters(*answer);
}

core::Result<int> MotoRosClient::queue_count() {
  if (auto counted = command(moto::kQueueCount, "queue count", settings_.reply_timeout); !counted)
    return core::forward(counted);
  return last_reply_.subcode;
}

core::Result<MotoRosClient::Taken> MotoRosClient::send_point(const MotoTrajectoryPoint& point) {
  const std::string what = "point " + std::to_string(point.sequence);
  auto reply = ask(moto_frame(point), what, settings_.reply_timeout);
  if (!reply) return core::forward(reply);
  if (reply->result == moto::ok) return Taken::yes;
  if (reply->result == moto::busy) return Taken::busy;
  const MotoFault fault = moto_fault(reply->result, reply->subcode);
  return tl::unexpected(trail_.onto({ErrorCode::refused, peer() + ' ' + what, fault.meaning, fault.remedy, {}}));
}

// --- inputs and outputs ---

core::Result<MotoFrame> MotoRosClient::io(const MotoFrame& request) {
  if (!order_) return core::failure(ErrorCode::link, peer(), "not connected", "connect first");
  if (io_.link && !quiet(io_)) io_ = {};  // nothing was asked yet: a new connection begins anew
  if (!io_.link) {
    if (auto opened = open(io_, kIoOffset); !opened) return core::forward(opened);
  }
  auto answer = exchange(io_, request, moto::io_reply(request.type), settings_.reply_timeout);
  if (!answer || answer->type != moto::kIoReply) return answer;
  auto refusal = parse_moto_io_refusal(*answer);
  if (!refusal) return core::forward(refusal);
  const MotoFault fault = moto_fault(refusal->result, refusal->subcode);
  return tl::unexpected(trail_.onto({ErrorCode::refused, peer() + " I/O", fault.meaning, fault.remedy, {}}));
}

core::Result<MotoValue> MotoRosClient::io_read(std::int32_t type, std::uint32_t address) {
  auto answer = io(moto_frame(type, MotoAddress{address}));
  if (!answer && session_broke(answer.error())) answer = io(moto_frame(type, MotoAddress{address}));  // a read
  if (!answer) return core::forward(answer);
  auto value = parse_moto_value(*answer, moto::io_reply(type));
  if (!value || value->result == moto::io_ok) return value;
  const MotoFault fault = moto_io_fault(value->result);
  return tl::unexpected(
      trail_.onto({ErrorCode::refused, peer() + " read " + std::to_string(address), fault.meaning, fault.remedy, {}}));
}

core::Status MotoRosClient::io_write(std::int32_t type, std::uint32_t address, std::uint32_t value) {
  auto answer = io(moto_frame(type, MotoWrite{address, value}));
  if (!answer) return core::forward(answer);
  auto written = parse_moto_written(*answer, moto::io_reply(type));
  if (!written) return core::forward(written);
  if (written->result == moto::io_ok) return {};
  const MotoFault fault = moto_io_fault(written->result);
  return tl::unexpected(
      trail_.onto({ErrorCode::refused, peer() + " write " + std::to_string(address), fault.meaning, fault.remedy, {}}));
}

core::Result<bool> MotoRosClient::read_bit(std::uint32_t contact) {
  auto value = io_read(moto::kReadBit, contact);
  if (!value) return core::forward(value);
  return value->value != 0;
}

core::Result<std::uint8_t> MotoRosClient::read_group(std::uint32_t group) {
  auto value = io_read(moto::kReadGroup, group);
  if (!value) return core::forward(value);
  return static_cast<std::uint8_t>(value->value);
}

core::Result<std::uint16_t> MotoRosClient::read_register(std::uint32_t number) {
  auto value = io_read(moto::kReadRegister, number);
  if (!value) return core::forward(value);
  return static_cast<std::uint16_t>(value->value);
}

core::Status MotoRosClient::write_bit(std::uint32_t contact, bool on) {
  return io_write(moto::kWriteBit, contact, on ? 1 : 0);
}

core::Status MotoRosClient::write_group(std::uint32_t group, std::uint8_t value) {
  return io_write(moto::kWriteGroup, group, value);
}

core::Status MotoRosClient::write_register(std::uint32_t number, std::uint16_t value) {
  return io_write(moto::kWriteRegister, number, value);
}

}  // namespace pickcell::robot
