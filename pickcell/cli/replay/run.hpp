#pragma once
/// A recorded run searched again: its pictures, today's code.

#include <cstddef>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "pickcell/cell/recorded_run.hpp"
#include "pickcell/cli/replay/compare.hpp"
#include "pickcell/cli/replay/shard.hpp"
#include "pickcell/core/result.hpp"

namespace pickcell::cli {

struct ReplayOptions {
  std::filesystem::path run;
  std::optional<std::filesystem::path> cell;  ///< models, calibration and limits of this cell instead of the run's own
  Shard shard;
  int threads = 0;  ///< of the matcher; 0: all
  Tolerance tolerance;
};

/// A frame in which something changed.
struct ChangedFrame {
  std::int64_t sequence = 0;
  std::string file;
  std::vector<FindChange> finds;  ///< worst first, without those that are the same
};

struct Replay {
  ReplayOptions options;
  cell::RecordedInfo info;
  std::string engine;
  std::string cell;                ///< whose models and calibration: "recorded", or the cell file
  std::vector<std::string> notes;  ///< what a reader of the figures must know, in words
  std::size_t frames = 0;          ///< of the shard: same + changed + without_picture + unreadable
  std::size_t same = 0, without_picture = 0, unreadable = 0;
  std::vector<ChangedFrame> changed;  ///< worst first
  std::size_t finds_recorded = 0, finds_same = 0, finds_changed = 0, finds_lost = 0, finds_new = 0;
  double most_px = 0, most_deg = 0, most_mm = 0;  ///< largest differences of all pairs, the same ones too
  std::vector<double> recorded_ms, now_ms;        ///< of the frames that were searched

  [[nodiscard]] bool all_same() const { return changed.empty() && unreadable == 0; }
};

/// Reports each picture that cannot be read and goes on. Errors: unreadable: no run or a damaged one, one without any
/// picture, files of the cell that are gone; usage: an engine that this build does not have.
[[nodiscard]] core::Result<Replay> replay(const ReplayOptions& options,
                                          const std::function<void(const core::Error&)>& unreadable);

}  // namespace pickcell::cli
