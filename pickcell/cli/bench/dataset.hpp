#pragma once
/// A set of pictures with known poses: truth.json beside templates/ and images/ (docs/interfaces.md, bench). Keys that
/// are not read are ignored, so that anyone can write a set.

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "pickcell/core/result.hpp"
#include "pickcell/matches/model.hpp"

namespace pickcell::cli {

/// Where the template's centre ((w-1)/2, (h-1)/2) lies in a picture, by the pose convention of matches::Pose2d.
struct TruthPose {
  double x_px = 0;
  double y_px = 0;
  double angle_deg = 0;  ///< any turn, compared modulo the template's symmetry
  double scale = 1;
};

struct PictureSize {
  int width_px = 0;
  int height_px = 0;
};

struct DatasetTemplate {
  std::string id;
  std::filesystem::path file;  ///< starts at the set's folder
  std::optional<std::filesystem::path> mask;
  std::optional<PictureSize> size_px;  ///< as recorded; checked against the file
  std::string size;                    ///< class: small, medium, large; empty when not recorded
  std::string category;                ///< empty when not recorded
  std::vector<std::string> sources;    ///< names of the pictures it was cut from
  double symmetry_deg = 360;           ///< turning the part by this much changes nothing
};

struct DatasetImage {
  std::filesystem::path file;
  std::size_t template_index = 0;
  std::string kind;  ///< condition: clean, occl_clutter, ...; empty when not recorded
  std::optional<PictureSize> size_px;
  std::vector<TruthPose> truths;
  bool has_instances = false;         ///< the set states any number of poses (0: absent) instead of exactly one
  bool has_clutter = false;           ///< the set records what else lies in the picture
  std::vector<std::string> contents;  ///< ids and sources of background, occluder and clutter
};

struct Dataset {
  std::string name;
  std::filesystem::path folder;
  matches::Range scale{0.9, 1.1};
  std::vector<DatasetTemplate> templates;
  std::vector<DatasetImage> images;
};

/// Reads FOLDER/truth.json. Missing or contradictory keys are named with their place, as in `images[3].x`.
[[nodiscard]] core::Result<Dataset> load_dataset(const std::filesystem::path& folder);

/// The same from text; pictures are not opened. name is used in errors.
[[nodiscard]] core::Result<Dataset> parse_dataset(std::string_view text, const std::string& name,
                                                  const std::filesystem::path& folder);

}  // namespace pickcell::cli
