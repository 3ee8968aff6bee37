#pragma once
/// How well frames of a source arrive: rate, jitter and losses by cause.

#include <iosfwd>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "pickcell/cli/subcommand.hpp"
#include "pickcell/core/json.hpp"
#include "pickcell/frames/frame_source.hpp"
#include "pickcell/frames/live_source.hpp"

namespace pickcell::cli {

struct CameraCommand {
  std::string out;
  std::int64_t frames = 100;
  std::vector<std::string> set;
  double timeout_s = 5;
  double fps = 0;
  bool loop = false;
  bool json = false;
};

[[nodiscard]] core::Result<std::unique_ptr<frames::FrameSource>> open_camera(const std::string& source,
                                                                             const CameraCommand& command,
                                                                             frames::LiveSource::Policy policy,
                                                                             const core::Clock& clock);

/// Times between exposures. Frames that are missing do not count as jitter.
class Rhythm {
 public:
  void add(const frames::Frame& frame);
  /// The camera was away: the time until the next exposure tells nothing.
  void interrupt() { last_.reset(); }
  [[nodiscard]] std::optional<double> rate_hz() const;
  /// Standard deviation of the time from one exposure to the next.
  [[nodiscard]] std::optional<double> jitter_us() const;

 private:
  std::optional<core::TimePoint> last_;
  std::uint64_t last_sequence_ = 0;
  double n_ = 0, mean_s_ = 0, squares_s2_ = 0;
};

/// {"frames","incomplete","missing","repeated","late","resends","rate_hz","jitter_us",...}
[[nodiscard]] core::Json stream_json(const frames::FrameCounters& counters, const Rhythm& rhythm);

[[nodiscard]] core::Result<int> stream(const std::string& source, const CameraCommand& command, Io& io);

}  // namespace pickcell::cli
