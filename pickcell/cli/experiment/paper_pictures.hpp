#pragma once
/// Pictures for the paper's experiments: photographs, or scenes rendered from the project's own parts, and templates
/// cut out of them and laid at known poses. Deterministic for a seed.

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "pickcell/cli/bench/dataset.hpp"
#include "pickcell/core/result.hpp"
#include "pickcell/image/image.hpp"
#include "pickcell/sim/random.hpp"

namespace pickcell::cli {

/// The paper's catalogue of templates.
constexpr std::array<const char*, 6> kPaperCategories = {"Food", "Manufacturing", "Metal", "PCB", "Printing", "Logo"};

struct SourcePicture {
  std::string name;
  std::size_t category = 0;  ///< place in kPaperCategories
  image::Image picture;
};

/// Two scenes per category, 640 x 480 at 5 px/mm, from parts and surfaces of the simulation: Food stands for matt
/// bodies on wood and cloth, Manufacturing for gears and brackets, Metal for brushed and turned parts on metal, PCB for
/// plates with print among labels, Printing for labels, Logo for lettered parts.
[[nodiscard]] std::vector<SourcePicture> rendered_sources(std::uint64_t seed);

/// The pictures of a folder in the order of their names; a name that begins with a category (food_, pcb_, ...) belongs
/// to it, others are dealt out in turn. Errors: no picture of at least 320 x 240, or one that cannot be read.
[[nodiscard]] core::Result<std::vector<SourcePicture>> photo_sources(const std::filesystem::path& folder);

[[nodiscard]] core::Result<std::vector<SourcePicture>> paper_sources(const std::optional<std::filesystem::path>& photos,
                                                                     std::uint64_t seed);

/// Of some crops by chance, the one with the most contrast between its quarters and inside them; kept off places
/// without features. The size must fit.
[[nodiscard]] image::Image cut_template(const SourcePicture& source, int width, int height, sim::Random& random);

/// Lays the template over the scene with its centre at the pose (4 x 4 samples per pixel); pixels outside stay.
void lay_template(image::Image& scene, image::ImageView part, const TruthPose& pose);

/// A pose at which the whole rectangle lies in the picture; empty when it does not fit.
[[nodiscard]] std::optional<TruthPose> pose_inside(int scene_w, int scene_h, int w, int h, double angle_deg,
                                                   double scale, sim::Random& random);

/// The source, mirrored at its borders to this size.
[[nodiscard]] image::Image scene_of(const SourcePicture& source, int width, int height);

}  // namespace pickcell::cli
