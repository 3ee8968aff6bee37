#include "pickcell/robot/motoros_codec.hpp"

#include <algorithm>
#include <bit>
#include <stdexcept>
#include <type_traits>

namespace pickcell::robot {

using core::ErrorCode;

namespace {

constexpr std::size_t kWord = 4;

std::uint32_t word_at(std::string_view bytes, std::size_t at, ByteOrder order) {
  std::uint32_t value = 0;
  for (std::size_t i = 0; i < kWord; ++i) {
    const auto byte = static_cast<std::uint8_t>(bytes[at + i]);
    const std::size_t place = order == ByteOrder::little ? i : kWord - 1 - i;
    value |= static_cast<std::uint32_t>(byte) << (8 * place);
  }
  return value;
}

void put(std::string& out, std::uint32_t value, ByteOrder order) {
  for (std::size_t i = 0; i < kWord; ++i) {
    const std::size_t place = order == ByteOrder::little ? i : kWord - 1 - i;
    out += static_cast<char>(value >> (8 * place) & 0xFF);
  }
}

/// A header at least, whole words, no longer than the longest message.
bool possible_length(std::uint32_t length) {
  constexpr std::uint32_t kHeader = kMotoHeaderBytes - kWord;
  return length >= kHeader && length <= kHeader + kMotoLongestBody && length % kWord == 0;
}

/// Writes fields into words.
class Writer {
 public:
  explicit Writer(std::vector<std::uint32_t>& out) : out_(out) {}
  template <class T>
  void operator()(const T& field) {
    out_.push_back(std::bit_cast<std::uint32_t>(field));
  }
  void operator()(const MotoJoints& joints) {
    for (const float v : joints) (*this)(v);
  }

 private:
  std::vector<std::uint32_t>& out_;
};

/// Reads them back; the caller has checked that there are enough.
class Reader {
 public:
  explicit Reader(std::span<const std::uint32_t> words) : words_(words) {}
  template <class T>
  void operator()(T& field) {
    field = std::bit_cast<T>(words_.front());
    words_ = words_.subspan(1);
  }
  void operator()(MotoJoints& joints) {
    for (float& v : joints) (*this)(v);
  }

 private:
  std::span<const std::uint32_t> words_;
};

// The layouts: fields in the order of the wire. M is const when written.
template <class M, class F>
void fields(M& m, F&& f) {
  using T = std::remove_const_t<M>;
  if constexpr (std::is_same_v<T, MotoStatus>) {
    f(m.drives_powered), f(m.e_stopped), f(m.error_code), f(m.in_error), f(m.in_motion), f(m.mode),
        f(m.motion_possible);
  } else if constexpr (std::is_same_v<T, MotoFeedback>) {
    f(m.group), f(m.valid), f(m.time_s), f(m.position), f(m.velocity), f(m.acceleration);
  } else if constexpr (std::is_same_v<T, MotoTrajectoryPoint>) {
    f(m.group), f(m.sequence), f(m.valid), f(m.time_s), f(m.position), f(m.velocity), f(m.acceleration);
  } else if constexpr (std::is_same_v<T, MotoTrajectoryPointEx>) {
    f(m.groups), f(m.sequence);
    for (auto& part : m.parts) fields(part, f);
  } else if constexpr (std::is_same_v<T, MotoFeedbackEx>) {
    f(m.groups);
    for (auto& part : m.parts) fields(part, f);
  } else if constexpr (std::is_same_v<T, MotoCommand>) {
    f(m.group), f(m.sequence), f(m.command), f(m.data);
  } else if constexpr (std::is_same_v<T, MotoReply>) {
    f(m.group), f(m.sequence), f(m.command), f(m.result), f(m.subcode), f(m.data);
  } else if constexpr (std::is_same_v<T, MotoSelectTool>) {
    f(m.group), f(m.tool), f(m.sequence);
  } else if constexpr (std::is_same_v<T, MotoAddress>) {
    f(m.address);
  } else if constexpr (std::is_same_v<T, MotoWrite>) {
    f(m.address), f(m.value);
  } else if constexpr (std::is_same_v<T, MotoValue>) {
    f(m.value), f(m.result);
  } else if constexpr (std::is_same_v<T, MotoWritten>) {
    f(m.result);
  } else if constexpr (std::is_same_v<T, MotoDhParameters>) {
    for (auto& group : m.groups)
      for (auto& link : group) f(link.theta), f(link.d), f(link.a), f(link.alpha);
  } else {
    static_assert(std::is_same_v<T, MotoIoRefusal>);
    f(m.result), f(m.subcode);
  }
}

template <class M>
MotoFrame written(std::int32_t type, std::int32_t comm, std::int32_t reply, const M& m) {
  MotoFrame frame{type, comm, reply, {}};
  fields(m, Writer(frame.body));
  return frame;
}

template <class M>
std::size_t words_of() {
  std::vector<std::uint32_t> words;
  const M m{};
  fields(m, Writer(words));
  return words.size();
}

auto damaged(std::string why) {
  return core::failure(ErrorCode::link, "MotoROS message", std::move(why),
                       "check that the address is a MotoROS controller and that the byte order is its own");
}

core::Status expect(const MotoFrame& frame, std::int32_t type) {
  if (frame.type == type) return {};
  return damaged("type " + std::to_string(frame.type) + " where " + std::to_string(type) + " was expected");
}

template <class M>
core::Result<M> parse(const MotoFrame& frame, std::int32_t type) {
  if (auto as_expected = expect(frame, type); !as_expected) return core::forward(as_expected);
  static const std::size_t words = words_of<M>();
  if (frame.body.size() != words) {
    return damaged("type " + std::to_string(type) + " with a body of " + std::to_string(frame.body.size() * kWord) +
                   " bytes instead of " + std::to_string(words * kWord));
  }
  M m;
  fields(m, Reader(frame.body));
  return m;
}

/// Messages whose parts beyond the counted ones may be missing.
template <class M>
core::Result<M> parse_groups(MotoFrame frame, std::int32_t type) {
  if (auto as_expected = expect(frame, type); !as_expected) return core::forward(as_expected);
  static const std::size_t whole = words_of<M>(), part = words_of<MotoFeedback>();
  const std::size_t head = whole - moto::kGroups * part;
  const std::uint32_t groups = frame.body.empty() ? 0 : frame.body.front();
  if (groups > moto::kGroups || frame.body.size() < head + groups * part || frame.body.size() > whole)
    return damaged("type " + std::to_string(type) + " with a body of " + std::to_string(frame.body.size() * kWord) +
                   " bytes for " + std::to_string(groups) + " groups");
  frame.body.resize(whole);
  return parse<M>(frame, type);
}

/// Whether a reply tells of success.
std::int32_t outcome(std::int32_t result) { return result == 0 ? moto::kSuccess : moto::kFailure; }

}  // namespace

std::string moto_bytes(const MotoFrame& frame, ByteOrder order) {
  if (frame.body.size() * kWord > kMotoLongestBody) throw std::invalid_argument("a MotoROS body has at most 536 bytes");
  std::string out;
  out.reserve(kMotoHeaderBytes + frame.body.size() * kWord);
  put(out, static_cast<std::uint32_t>(kMotoHeaderBytes - kWord + frame.body.size() * kWord), order);
  for (const std::int32_t v : {frame.type, frame.comm, frame.reply}) put(out, static_cast<std::uint32_t>(v), order);
  for (const std::uint32_t v : frame.body) put(out, v, order);
  return out;
}

std::optional<ByteOrder> moto_byte_order(std::span<const char, 4> first_bytes) {
  const std::string_view bytes(first_bytes.data(), first_bytes.size());
  for (const ByteOrder order : {ByteOrder::little, ByteOrder::big})
    if (possible_length(word_at(bytes, 0, order))) return order;
  return std::nullopt;
}

core::Result<std::optional<MotoFrame>> MotoFrameSplitter::next() {
  if (bytes_.size() < kWord) return std::nullopt;
  const std::uint32_t length = word_at(bytes_, 0, order_);
  if (!possible_length(length)) return damaged("a frame of " + std::to_string(length) + " bytes");
  if (bytes_.size() < kWord + length) return std::nullopt;
  MotoFrame frame;
  frame.type = static_cast<std::int32_t>(word_at(bytes_, 4, order_));
  frame.comm = static_cast<std::int32_t>(word_at(bytes_, 8, order_));
  frame.reply = static_cast<std::int32_t>(word_at(bytes_, 12, order_));
  frame.body.reserve((length + kWord - kMotoHeaderBytes) / kWord);
  for (std::size_t at = kMotoHeaderBytes; at < kWord + length; at += kWord)
    frame.body.push_back(word_at(bytes_, at, order_));
  bytes_.erase(0, kWord + length);
  return frame;
}

MotoFrame moto_frame(const MotoStatus& m) { return written(moto::kRobotStatus, moto::kTopic, moto::kNoReply, m); }
MotoFrame moto_frame(const MotoFeedback& m) { return written(moto::kFeedback, moto::kTopic, moto::kNoReply, m); }
MotoFrame moto_frame(const MotoFeedbackEx& m) { return written(moto::kFeedbackEx, moto::kTopic, moto::kNoReply, m); }
MotoFrame moto_frame(const MotoTrajectoryPoint& m) {
  return written(moto::kTrajectoryPoint, moto::kRequest, moto::kNoReply, m);
}
MotoFrame moto_frame(const MotoTrajectoryPointEx& m) {
  return written(moto::kTrajectoryPointEx, moto::kRequest, moto::kNoReply, m);
}
MotoFrame moto_frame(const MotoCommand& m) { return written(moto::kMotionControl, moto::kRequest, moto::kNoReply, m); }
/// The reply type is success whatever the result says: so does the recorded controller.
MotoFrame moto_frame(const MotoReply& m) { return written(moto::kMotionReply, moto::kReply, moto::kSuccess, m); }
MotoFrame moto_frame(const MotoSelectTool& m) { return written(moto::kSelectTool, moto::kRequest, moto::kNoReply, m); }
MotoFrame moto_frame(const MotoDhParameters& m) {
  return written(moto::kDhParameters, moto::kReply, moto::kSuccess, m);
}
MotoFrame moto_frame(const MotoIoRefusal& m) { return written(moto::kIoReply, moto::kReply, moto::kFailure, m); }
MotoFrame moto_frame(std::int32_t type, const MotoAddress& m) {
  return written(type, moto::kRequest, moto::kNoReply, m);
}
MotoFrame moto_frame(std::int32_t type, const MotoWrite& m) { return written(type, moto::kRequest, moto::kNoReply, m); }
MotoFrame moto_frame(std::int32_t type, const MotoValue& m) {
  return written(type, moto::kReply, outcome(m.result), m);
}
MotoFrame moto_frame(std::int32_t type, const MotoWritten& m) {
  return written(type, moto::kReply, outcome(m.result), m);
}

core::Result<MotoStatus> parse_moto_status(const MotoFrame& f) { return parse<MotoStatus>(f, moto::kRobotStatus); }
core::Result<MotoFeedback> parse_moto_feedback(const MotoFrame& f) { return parse<MotoFeedback>(f, moto::kFeedback); }
core::Result<MotoFeedbackEx> parse_moto_feedback_ex(const MotoFrame& f) {
  return parse_groups<MotoFeedbackEx>(f, moto::kFeedbackEx);
}
core::Result<MotoTrajectoryPoint> parse_moto_point(const MotoFrame& f) {
  return parse<MotoTrajectoryPoint>(f, moto::kTrajectoryPoint);
}
core::Result<MotoTrajectoryPointEx> parse_moto_point_ex(const MotoFrame& f) {
  return parse_groups<MotoTrajectoryPointEx>(f, moto::kTrajectoryPointEx);
}
core::Result<MotoCommand> parse_moto_command(const MotoFrame& f) { return parse<MotoCommand>(f, moto::kMotionControl); }
core::Result<MotoReply> parse_moto_reply(const MotoFrame& f) { return parse<MotoReply>(f, moto::kMotionReply); }
core::Result<MotoSelectTool> parse_moto_select_tool(const MotoFrame& f) {
  return parse<MotoSelectTool>(f, moto::kSelectTool);
}
core::Result<MotoDhParameters> parse_moto_dh_parameters(const MotoFrame& f) {
  return parse<MotoDhParameters>(f, moto::kDhParameters);
}
core::Result<MotoAddress> parse_moto_address(const MotoFrame& f, std::int32_t type) {
  return parse<MotoAddress>(f, type);
}
core::Result<MotoWrite> parse_moto_write(const MotoFrame& f, std::int32_t type) { return parse<MotoWrite>(f, type); }
core::Result<MotoValue> parse_moto_value(const MotoFrame& f, std::int32_t type) { return parse<MotoValue>(f, type); }
core::Result<MotoWritten> parse_moto_written(const MotoFrame& f, std::int32_t type) {
  return parse<MotoWritten>(f, type);
}
core::Result<MotoIoRefusal> parse_moto_io_refusal(const MotoFrame& f) {
  return parse<MotoIoRefusal>(f, moto::kIoReply);
}

}  // namespace pickcell::robot
