#include "pickcell/server/client_queue.hpp"

#include <utility>

namespace pickcell::server {

std::uint32_t wire_frame_id(const cell::ShownFrame& shown) { return static_cast<std::uint32_t>(shown.frame.sequence); }

void ClientQueue::mark(Topic topic) {
  marked_[static_cast<std::size_t>(topic)] = true;
  if (topic == Topic::snap) alarms_.clear();
}

bool ClientQueue::push_alarm(std::string text) {
  if (marked_[static_cast<std::size_t>(Topic::snap)]) return true;
  if (alarms_.size() >= limits_.alarms) return false;
  alarms_.push_back(std::move(text));
  return true;
}

void ClientQueue::subscribe(VideoRequest request) {
  unsubscribe();
  video_ = request;
}

void ClientQueue::unsubscribe() {
  video_.reset();
  slot_.reset();
  unacknowledged_.reset();
  next_frame_due_ = {};
}

void ClientQueue::offer(ShownFramePtr shown) {
  if (!video_ || !shown) return;
  if (slot_) ++frames_replaced_;
  slot_ = std::move(shown);
}

void ClientQueue::acknowledge(std::uint32_t frame_id, WallTime now) {
  if (!unacknowledged_ || unacknowledged_->frame_id != frame_id) return;
  adaptive_.acknowledged(now - unacknowledged_->since, now);
  unacknowledged_.reset();
}

Outgoing ClientQueue::next(WallTime now) {
  Outgoing out;
  if (writing_since_) return out;
  for (std::size_t i = 0; i < kTopics && out.empty(); ++i) {
    if (i == static_cast<std::size_t>(Topic::video) && !alarms_.empty()) {
      out.alarm = std::move(alarms_.front());
      alarms_.pop_front();
    } else if (std::exchange(marked_[i], false)) {
      out.topic = static_cast<Topic>(i);
    }
  }
  if (out.empty() && slot_ && !unacknowledged_ && now >= next_frame_due_) {
    const VideoRequest granted = adaptive_.limit(*video_);
    unacknowledged_ = Unacknowledged{wire_frame_id(*slot_), now};
    next_frame_due_ =
        now + std::chrono::duration_cast<WallDuration>(std::chrono::duration<double>(1 / granted.max_fps));
    out.frame = FrameOut{std::exchange(slot_, nullptr), granted.max_width_px, granted.quality};
    ++frames_sent_;
  }
  if (!out.empty()) writing_since_ = now;
  return out;
}

void ClientQueue::written(WallTime) { writing_since_.reset(); }

std::optional<WallTime> ClientQueue::wake_at() const {
  if (!slot_ || unacknowledged_ || writing_since_) return std::nullopt;
  return next_frame_due_;
}

QueueVerdict ClientQueue::check(WallTime now) {
  if (writing_since_ && now - *writing_since_ > limits_.write_stall) return QueueVerdict::cut;
  if (unacknowledged_ && now - unacknowledged_->since > limits_.ack_drop) {
    unsubscribe();
    mark(Topic::video);
    return QueueVerdict::video_dropped;
  }
  return QueueVerdict::fine;
}

}  // namespace pickcell::server
