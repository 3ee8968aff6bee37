#pragma once
/// The paper's set of pictures, made anew: templates of its categories and sizes, each laid into five pictures with
/// exact truth.

#include <array>
#include <cstdint>
#include <filesystem>
#include <vector>

#include "pickcell/cli/experiment/paper_pictures.hpp"
#include "pickcell/core/result.hpp"

namespace pickcell::cli {

constexpr std::array<const char*, 3> kPaperSizes = {"small", "medium", "large"};
/// Templates of each size: Table I sums to 30; its text says 40, in the same proportion 8, 23 and 9.
constexpr std::array<int, 3> kTableOne = {6, 17, 7}, kFortyTemplates = {8, 23, 9};

/// Writes FOLDER/truth.json, templates/ and images/ as bench reads them: so many templates, the sizes in the proportion
/// of kFortyTemplates, categories in turn; five 640 x 480 pictures each, one target at any angle, scale 0.9 .. 1.1,
/// noise of 1 grey value. Deterministic for sources and seed.
[[nodiscard]] core::Status write_paper_set(const std::filesystem::path& folder, std::vector<SourcePicture> sources,
                                           int templates, std::uint64_t seed);

}  // namespace pickcell::cli
