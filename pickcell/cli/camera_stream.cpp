#include "pickcell/cli/camera_stream.hpp"

#include <atomic>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <filesystem>
#include <ostream>

#include "pickcell/frames/open_source.hpp"
#include "pickcell/image/codec.hpp"

namespace pickcell::cli {

using core::ErrorCode;
using core::failure;
using core::Json;

namespace {

/// Ctrl-C and SIGTERM raise a flag instead of ending the process: the figures are still printed.
class StopFlag {
 public:
  StopFlag() {
    raised_ = false;
    struct sigaction action{};
    action.sa_handler = [](int) { raised_ = true; };
    (void)sigaction(SIGINT, &action, &interrupt_);
    (void)sigaction(SIGTERM, &action, &terminate_);
  }
  ~StopFlag() {
    (void)sigaction(SIGINT, &interrupt_, nullptr);
    (void)sigaction(SIGTERM, &terminate_, nullptr);
  }
  StopFlag(const StopFlag&) = delete;
  StopFlag& operator=(const StopFlag&) = delete;
  [[nodiscard]] static bool raised() { return raised_; }

 private:
  static inline std::atomic<bool> raised_{false};
  struct sigaction interrupt_{}, terminate_{};
};

std::string words(const frames::FrameCounters& c, const Rhythm& rhythm) {
  char out[400];
  std::snprintf(out, sizeof out,
                "%llu frames, %.2f Hz, jitter %.0f us; incomplete %llu, torn %llu, missing %llu, repeated %llu, late "
                "%llu, resends %llu, reconnects %llu",
                static_cast<unsigned long long>(c.frames), rhythm.rate_hz().value_or(0), rhythm.jitter_us().value_or(0),
                static_cast<unsigned long long>(c.incomplete), static_cast<unsigned long long>(c.torn),
                static_cast<unsigned long long>(c.missing), static_cast<unsigned long long>(c.repeated),
                static_cast<unsigned long long>(c.late), static_cast<unsigned long long>(c.resends),
                static_cast<unsigned long long>(c.reconnects));
  return out;
}

core::Status record(const std::string& folder, const frames::Frame& frame) {
  char name[32];
  std::snprintf(name, sizeof name, "%08llu.png", static_cast<unsigned long long>(frame.sequence));
  return image::save_png(std::filesystem::path(folder) / name, frame.picture->view());
}

/// Until so many frames came, the source ended or somebody stopped it. The error of a source that stays away.
struct Watch {
  frames::FrameSource& source;
  const CameraCommand& command;
  Io& io;
  Rhythm rhythm{};
  std::uint64_t got = 0, reconnects = 0;

  core::Status follow() {
    core::RealClock clock;
    const auto seat = clock.join("camera");
    core::TimePoint shown = clock.now();
    while (!StopFlag::raised() && (command.frames == 0 || got < static_cast<std::uint64_t>(command.frames))) {
      auto frame = source.grab(*seat, core::duration_s(command.timeout_s));
      if (!frame) {
        if (frame.error().code == ErrorCode::negative) return {};
        return core::forward(frame);
      }
      ++got;
      if (const auto times = source.counters().reconnects; times != reconnects) {
        reconnects = times;
        rhythm.interrupt();
      }
      rhythm.add(*frame);
      if (!command.out.empty())
        if (auto saved = record(command.out, *frame); !saved) return saved;
      if (!command.json && clock.now() - shown >= std::chrono::seconds(1)) {
        io.out << words(counters(), rhythm) << std::endl;
        shown = clock.now();
      }
    }
    return {};
  }
  /// Sources that lose nothing do not count.
  [[nodiscard]] frames::FrameCounters counters() const {
    frames::FrameCounters out = source.counters();
    if (out.frames < got) out.frames = got;
    return out;
  }
};

}  // namespace

core::Result<std::unique_ptr<frames::FrameSource>> open_camera(const std::string& source, const CameraCommand& command,
                                                               frames::LiveSource::Policy policy,
                                                               const core::Clock& clock) {
  auto settings = frames::parse_camera_settings(command.set);
  if (!settings) return core::forward(settings);
  frames::SourceOptions options;
  options.settings = std::move(*settings);
  options.policy = policy;
  options.fps = command.fps;
  options.loop = command.loop;
  return frames::open_source(source, options, clock);
}

void Rhythm::add(const frames::Frame& frame) {
  if (last_ && frame.sequence > last_sequence_) {
    const double step_s = core::seconds(frame.exposed - *last_) / static_cast<double>(frame.sequence - last_sequence_);
    n_ += 1;
    const double off = step_s - mean_s_;
    mean_s_ += off / n_;
    squares_s2_ += off * (step_s - mean_s_);
  }
  last_ = frame.exposed;
  last_sequence_ = frame.sequence;
}

std::optional<double> Rhythm::rate_hz() const {
  if (n_ < 1 || mean_s_ <= 0) return std::nullopt;
  return 1 / mean_s_;
}

std::optional<double> Rhythm::jitter_us() const {
  if (n_ < 2) return std::nullopt;
  return 1e6 * std::sqrt(squares_s2_ / (n_ - 1));
}

Json stream_json(const frames::FrameCounters& c, const Rhythm& rhythm) {
  const auto count = [](std::uint64_t n) { return Json(static_cast<std::int64_t>(n)); };
  Json out = Json::object();
  out.set("frames", count(c.frames)).set("incomplete", count(c.incomplete)).set("missing", count(c.missing));
  out.set("repeated", count(c.repeated)).set("late", count(c.late)).set("resends", count(c.resends));
  out.set("rate_hz", rhythm.rate_hz() ? Json(*rhythm.rate_hz()) : Json());
  out.set("jitter_us", rhythm.jitter_us() ? Json(*rhythm.jitter_us()) : Json());
  out.set("torn", count(c.torn)).set("reconnects", count(c.reconnects));
  return out;
}

core::Result<int> stream(const std::string& source, const CameraCommand& command, Io& io) {
  const StopFlag stop;
  core::RealClock clock;
  if (!command.out.empty()) {
    std::error_code problem;
    std::filesystem::create_directories(command.out, problem);
    if (problem) return failure(ErrorCode::unreadable, command.out, problem.message(), "name a folder to write to");
  }
  auto opened = open_camera(source, command, frames::LiveSource::Policy::every, clock);
  if (!opened) return core::forward(opened);
  Watch watch{**opened, command, io};
  auto end = watch.follow();
  const frames::FrameCounters counters = watch.counters();
  io.out << (command.json ? stream_json(counters, watch.rhythm).dump() : words(counters, watch.rhythm)) << std::endl;
  if (!end) return core::forward(end);
  return 0;
}

}  // namespace pickcell::cli
