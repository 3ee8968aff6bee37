#pragma once
/// Data sets for `pickcell bench`, rendered from the project's own parts with exact truth (docs/interfaces.md, bench).

#include <cstdint>
#include <filesystem>

#include "pickcell/core/result.hpp"

namespace pickcell::sim {

/// One part per picture among others: every kind of the catalogue as template (60..250 px, with mask) under the five
/// conditions clean, light_noise, blur_noise, occl_clutter, mixed; any angle, scale 0.9..1.1; 75 pictures of 640x480.
/// Writes truth.json, templates/ and images/ below folder. Same seed, same bytes; pictures < 75 writes only the first
/// ones. Errors: unreadable (cannot write).
[[nodiscard]] core::Status write_rendered_set(const std::filesystem::path& folder, std::uint64_t seed,
                                              int pictures = 75);

/// 2..7 instances of one part among others (`instances`), every fifth picture without any (`"instances": []`); 25
/// pictures of 768x576 under the same conditions.
[[nodiscard]] core::Status write_rendered_multi_set(const std::filesystem::path& folder, std::uint64_t seed,
                                                    int pictures = 25);

}  // namespace pickcell::sim
