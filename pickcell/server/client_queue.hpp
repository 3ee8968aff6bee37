#pragma once
/// What waits for one connected page, and in which order it goes out. However slow the page: at most one frame waits,
/// text that describes a state waits once, and only alarms queue, to a limit. Pure: time is an argument, writing is the
/// caller's.

#include <array>
#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <string>

#include "pickcell/cell/cell_port.hpp"
#include "pickcell/server/adaptive_video.hpp"

namespace pickcell::server {

using ShownFramePtr = std::shared_ptr<const cell::ShownFrame>;

/// Texts of which only the latest counts; composed when they are written. In the order of urgency.
enum class Topic : std::uint8_t { hello, snap, video, state, log, heartbeat };
constexpr std::size_t kTopics = 6;

struct QueueLimits {
  std::size_t alarms = 256;
  WallDuration ack_drop = std::chrono::seconds(30);     ///< without acknowledgement: the video subscription ends
  WallDuration write_stall = std::chrono::seconds(10);  ///< one write not finished: the client does not read
};

/// The frame id on the wire: the low 32 bits of the exposure count.
[[nodiscard]] std::uint32_t wire_frame_id(const cell::ShownFrame& shown);

/// One frame to encode and write.
struct FrameOut {
  ShownFramePtr shown;
  int max_width_px = 0;
  int quality = 0;
};

/// The next message: exactly one of the members is set, or none when there is nothing to write.
struct Outgoing {
  std::optional<Topic> topic;
  std::optional<std::string> alarm;
  std::optional<FrameOut> frame;
  [[nodiscard]] bool empty() const { return !topic && !alarm && !frame; }
};

enum class QueueVerdict { fine, video_dropped, cut };

class ClientQueue {
 public:
  explicit ClientQueue(QueueLimits limits = {}) : limits_(limits) {}

  /// A snap contains every alarm, so alarms that wait are dropped and later ones wait for it.
  void mark(Topic topic);
  /// False when the limit is passed: close the connection (1013), the page reconnects and gets a snap.
  [[nodiscard]] bool push_alarm(std::string text);

  /// Starts over with one credit.
  void subscribe(VideoRequest request);
  void unsubscribe();
  [[nodiscard]] const std::optional<VideoRequest>& video() const { return video_; }
  /// Replaces a frame that still waits.
  void offer(ShownFramePtr shown);
  /// The page has drawn the frame; ids that were not sent are ignored.
  void acknowledge(std::uint32_t frame_id, WallTime now);

  /// Takes the next message; the caller writes it and then calls written(). Nothing while a write is in progress.
  [[nodiscard]] Outgoing next(WallTime now);
  void written(WallTime now);
  /// When next() may have something although nothing arrives: the waiting frame's earliest time.
  [[nodiscard]] std::optional<WallTime> wake_at() const;
  /// To be called regularly.
  [[nodiscard]] QueueVerdict check(WallTime now);

  [[nodiscard]] std::size_t frames_waiting() const { return slot_ ? 1 : 0; }
  [[nodiscard]] std::uint64_t frames_sent() const { return frames_sent_; }
  [[nodiscard]] std::uint64_t frames_replaced() const { return frames_replaced_; }
  [[nodiscard]] const AdaptiveVideo& adaptive() const { return adaptive_; }

 private:
  struct Unacknowledged {
    std::uint32_t frame_id;
    WallTime since;
  };
  QueueLimits limits_;
  std::array<bool, kTopics> marked_{};
  std::deque<std::string> alarms_;
  std::optional<VideoRequest> video_;
  AdaptiveVideo adaptive_;
  ShownFramePtr slot_;
  std::optional<Unacknowledged> unacknowledged_;  ///< the credit is out
  WallTime next_frame_due_{};
  std::optional<WallTime> writing_since_;
  std::uint64_t frames_sent_ = 0;
  std::uint64_t frames_replaced_ = 0;
};

}  // namespace pickcell::server
