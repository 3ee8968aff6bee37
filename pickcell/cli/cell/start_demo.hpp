#pragma once
/// The demonstration cell: a folder with three taught parts, calibrations and CELL.toml, as a user's cell has them.

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "pickcell/core/result.hpp"

namespace pickcell::cli {

struct DemoOptions {
  std::uint64_t seed = 1;
  std::int64_t now_unix_us = 0;  ///< date of models and calibrations
  bool calibrate = false;        ///< camera.toml and plane.toml by calibrating, where the build can; else exact ones
  std::vector<std::string> kinds = {"bracket_l", "gear_18", "label_box"};  ///< at most four
  int camera_width_px = 1280;
  int camera_height_px = 1024;
  int parts_per_pitch = 4;
  /// Templates of this size about the part, without a mask (the paper's); unset: as large as the part, with its mask.
  struct TemplateSize {
    int w, h;
  };
  std::optional<TemplateSize> template_px{};
};

/// Photographs each kind with the simulated camera, teaches it, and writes PART.pcm, camera.toml, plane.toml (of the
/// cell's own calibration, or what a faultless one would give) and CELL.toml into the folder, which is made. Returns
/// the path of CELL.toml.
[[nodiscard]] core::Result<std::filesystem::path> prepare_demo(const std::filesystem::path& folder,
                                                               const DemoOptions& options);

/// A new folder for one demonstration below the user's state folder ($XDG_STATE_HOME, ~/.local/state), so that runs
/// never share a journal. Of earlier demonstrations the newest ones are kept.
[[nodiscard]] core::Result<std::filesystem::path> new_demo_folder();

}  // namespace pickcell::cli
