#include "pickcell/frames/live_source.hpp"

#include <algorithm>
#include <utility>

#include "pickcell/core/log.hpp"

namespace pickcell::frames {

using core::ErrorCode;
using core::failure;
using std::chrono::milliseconds;
using std::chrono::steady_clock;

namespace {

constexpr milliseconds kPatience{50};       ///< for the next frame, before anything else is looked at
constexpr milliseconds kQuietBefore{150};   ///< without a frame, before the camera is asked whether it is there
constexpr std::size_t kPicturesInWork = 8;  ///< kept for what readers hold
constexpr milliseconds kTriggerSlack{100};  ///< between clocks, for a frame that answers a trigger

core::Duration microseconds(double us) { return core::duration_s(us * 1e-6); }

}  // namespace

LiveSource::LiveSource(Connect connect, Options options, const core::Clock& clock, std::unique_ptr<CameraDevice> device)
    : connect_(std::move(connect)),
      options_(std::move(options)),
      clock_(clock),
      pool_(kPicturesInWork + (options_.policy == Policy::every ? options_.queue_max : 0)),
      ready_(options_.queue_max) {
  adopt(std::move(device));
  thread_ = std::thread([this] { run(); });
}

core::Result<std::unique_ptr<LiveSource>> LiveSource::open(Connect connect, Options options, const core::Clock& clock) {
  auto device = connect();
  if (!device) return core::forward(device);
  return std::unique_ptr<LiveSource>(new LiveSource(std::move(connect), std::move(options), clock, std::move(*device)));
}

LiveSource::~LiveSource() {
  {
    const std::lock_guard lock(mutex_);
    quit_ = true;
  }
  changed_.notify_all();
  thread_.join();
}

SourceInfo LiveSource::info() const {
  const std::lock_guard lock(mutex_);
  return {camera_id_, device_info_.width_px, device_info_.height_px, false};
}

DeviceInfo LiveSource::device() const {
  const std::lock_guard lock(mutex_);
  return device_info_;
}

core::Status LiveSource::health() const {
  const std::lock_guard lock(mutex_);
  if (lost_) return tl::unexpected(*lost_);
  return {};
}

FrameCounters LiveSource::counters() const {
  const std::lock_guard lock(mutex_);
  FrameCounters out = ledger_.counters();
  out.resends = resends_before_ + (device_ ? device_->resends() : 0);
  out.reconnects = reconnects_;
  return out;
}

double LiveSource::drift_ppm() const {
  const std::lock_guard lock(mutex_);
  return map_.drift_ppm();
}

// ---- the camera's thread

void LiveSource::run() {
  std::unique_lock lock(mutex_);
  while (!quit_) {
    const std::shared_ptr<CameraDevice> device = device_;
    lock.unlock();
    if (device)
      receive(*device);
    else
      reconnect();
    lock.lock();
  }
  lock.unlock();
  device_.reset();
}

void LiveSource::receive(CameraDevice& device) {
  auto arrival = device.next(kPatience);
  if (!arrival) {
    mark_lost(arrival.error());
    bury();
  } else if (*arrival) {
    last_sign_ = steady_clock::now();
    take(**arrival);
  } else {
    look_after(device);
  }
}

void LiveSource::look_after(CameraDevice& device) {
  if (steady_clock::now() - last_sign_ < kQuietBefore) return;
  auto alive = device.check();
  if (alive) {
    last_sign_ = steady_clock::now();
    const std::lock_guard lock(mutex_);
    if (!lost_) return;
    // It was only out of reach: the connection still stands on both sides.
    lost_.reset();
    ++reconnects_;
    ++spoilt_;  // what was asked for in between is lost
    core::log(core::LogLevel::warning, "camera", device_info_.id + " answers again");
    changed_.notify_all();
  } else if (alive.error().code != ErrorCode::timeout) {
    mark_lost(alive.error());
    bury();
  } else if (steady_clock::now() - last_sign_ >= options_.lost_after) {
    mark_lost(alive.error());
  }
}

void LiveSource::mark_lost(core::Error why) {
  const std::lock_guard lock(mutex_);
  why.code = ErrorCode::device;
  if (!lost_) core::log(core::LogLevel::error, "camera", why.line());
  lost_ = std::move(why);
  changed_.notify_all();
}

void LiveSource::bury() {
  std::shared_ptr<CameraDevice> dead;
  {
    const std::lock_guard lock(mutex_);
    resends_before_ += device_->resends();
    dead = std::move(device_);
    device_ = nullptr;
  }
  // Taking leave of a camera that does not answer takes seconds, in which the new one shall not wait.
  std::erase_if(graves_, [](auto& g) { return g.wait_for(milliseconds(0)) == std::future_status::ready; });
  graves_.push_back(std::async(std::launch::async, [d = std::move(dead)]() mutable { d.reset(); }));
}

void LiveSource::reconnect() {
  auto device = connect_();
  if (device) {
    adopt(std::move(*device));
    return;
  }
  mark_lost(device.error());
  std::unique_lock lock(mutex_);
  changed_.wait_for(lock, options_.retry_every, [this] { return quit_; });
}

void LiveSource::adopt(std::shared_ptr<CameraDevice> device) {
  const std::lock_guard lock(mutex_);
  device_info_ = device->info();
  camera_id_ = options_.camera_id.empty() ? device_info_.id : options_.camera_id;
  settings_ = std::make_shared<const ExposureSettings>(device_info_.settings);
  device_ = std::move(device);
  if (++connection_ > 1) {
    ++reconnects_;
    core::log(core::LogLevel::warning, "camera", device_info_.id + " is back");
  }
  ledger_.restart();
  map_.reset();
  lost_.reset();
  last_sign_ = steady_clock::now();
  changed_.notify_all();
}

core::TimePoint LiveSource::arrival_time(const Arrival& arrival) const {
  // Simulated time stands still while a device is waited for: it is still the time of the arrival.
  if (clock_.simulated()) return clock_.now();
  return clock_.now() - std::chrono::duration_cast<core::Duration>(steady_clock::now() - arrival.began);
}

bool LiveSource::wanted(core::TimePoint exposure_began) const {
  if (options_.policy == Policy::every) return true;
  if (!wanted_since_) return false;
  return exposure_began + (options_.software_trigger ? kTriggerSlack : milliseconds(0)) >= *wanted_since_;
}

void LiveSource::take(const Arrival& arrival) {
  std::unique_lock lock(mutex_);
  if (lost_) {
    lost_.reset();
    ++reconnects_;
  }
  const Verdict verdict =
      arrival.numbered ? ledger_.enter(arrival.id, arrival.device_ns, arrival.wholeness) : ledger_.enter_unnumbered();
  if (verdict != Verdict::good) {
    if (verdict != Verdict::repeated) ++spoilt_;
    changed_.notify_all();
    return;
  }
  const core::TimePoint arrived = arrival_time(arrival);
  if (arrival.device_ns != 0) map_.observe(arrival.device_ns, arrived);
  const core::TimePoint left = arrival.device_ns != 0 ? map_.at(arrival.device_ns) : arrived;
  if (arrived - left > options_.late_after) {
    ledger_.too_old();
    ++spoilt_;
    changed_.notify_all();
    return;
  }
  const double exposure_us = arrival.exposure_us.value_or(settings_->exposure_us.value_or(0));
  if (!wanted(left - microseconds(options_.readout_us + exposure_us))) return;
  lock.unlock();
  auto frame = frame_of(arrival, left);
  lock.lock();
  if (frame) {
    hand_out(std::move(*frame));
    return;
  }
  ledger_.not_a_picture();
  ++spoilt_;
  changed_.notify_all();
}

void LiveSource::hand_out(Frame frame) {
  if (options_.policy == Policy::newest) ready_.clear();
  if (ready_.full()) {
    (void)ready_.pop();
    ledger_.too_old();
  }
  ready_.push(std::move(frame));
  changed_.notify_all();
}

std::optional<Frame> LiveSource::frame_of(const Arrival& arrival, core::TimePoint left_camera) {
  auto picture = pool_.take();
  if (auto unpacked = unpacker_.unpack(arrival.picture, *picture); !unpacked) {
    core::log(core::LogLevel::warning, "camera", unpacked.error().line());
    return std::nullopt;
  }
  Frame frame;
  frame.picture = std::move(picture);
  frame.camera_id = camera_id_;
  frame.sequence = ledger_.sequence();
  frame.settings = settings_;
  const ExposureSettings& known = *settings_;
  if ((arrival.exposure_us && arrival.exposure_us != known.exposure_us) ||
      (arrival.gain && arrival.gain != known.gain) || arrival.offset_x_px != known.offset_x_px ||
      arrival.offset_y_px != known.offset_y_px) {
    ExposureSettings own = known;
    if (arrival.exposure_us) own.exposure_us = arrival.exposure_us;
    if (arrival.gain) own.gain = arrival.gain;
    own.offset_x_px = arrival.offset_x_px;
    own.offset_y_px = arrival.offset_y_px;
    frame.settings = std::make_shared<const ExposureSettings>(std::move(own));
  }
  const double exposure_us = frame.settings->exposure_us.value_or(0);
  frame.exposed = left_camera - microseconds(options_.readout_us + exposure_us / 2);
  frame.exposed_unix_us =
      clock_.unix_us() - std::chrono::duration_cast<std::chrono::microseconds>(clock_.now() - frame.exposed).count();
  if (arrival.device_ns != 0) frame.device_ns = arrival.device_ns;
  frame.encoder = arrival.encoder;
  return frame;
}

// ---- the reader's thread

core::Status LiveSource::ask_for_exposure(std::unique_lock<std::mutex>& lock) {
  const std::shared_ptr<CameraDevice> device = device_;
  lock.unlock();
  auto asked = device->trigger();
  lock.lock();
  return asked;
}

core::Error LiveSource::why_nothing(bool had_device) const {
  if (lost_) return *lost_;
  const std::string& id = camera_id_;
  if (!had_device) return {ErrorCode::device, id, "no connection", "check the camera and its cable", {}};
  if (options_.software_trigger)
    return {ErrorCode::device,
            id,
            "answers, but no picture came within the time",
            "allow more than exposure and transfer; check packet size and firewall (docs/cameras.md)",
            {}};
  return {ErrorCode::device,
          id,
          "answers, but no picture came within the time",
          "is it waiting for a trigger? else check packet size and firewall (docs/cameras.md)",
          {}};
}

core::Result<Frame> LiveSource::grab(core::Seat& seat, core::Duration timeout) {
  const Time until = steady_clock::now() + timeout;
  std::unique_lock lock(mutex_);
  if (options_.policy == Policy::newest) {
    wanted_since_ = seat.now();
    ready_.clear();
  }
  std::uint64_t asked_of = 0, spoilt = spoilt_;
  while (ready_.empty()) {
    // One exposure per connection, and again after one that was spoilt on the way.
    if (options_.software_trigger && device_ && !lost_ && (asked_of != connection_ || spoilt != spoilt_)) {
      asked_of = connection_;
      spoilt = spoilt_;
      if (auto asked = ask_for_exposure(lock); !asked && !lost_) lost_ = asked.error();
      continue;
    }
    if (changed_.wait_until(lock, until) == std::cv_status::timeout && ready_.empty()) {
      wanted_since_.reset();
      return tl::unexpected(why_nothing(device_ != nullptr));
    }
  }
  wanted_since_.reset();
  return ready_.pop();
}

}  // namespace pickcell::frames
