#pragma once
/// Which other template a picture is searched for to count false accepts (docs/interfaces.md, bench --absent).

#include <cstddef>
#include <optional>

#include "pickcell/cli/bench/dataset.hpp"

namespace pickcell::cli {

/// Index of the template that is searched for in image image_index of the set's list although it is not there: from the
/// image's own template forward 1 + (image_index mod (n-1)) places in the list, then on to the next one that is not
/// skipped. Skipped: same category, or same source (or id) as the own template, the background, the occluder or the
/// clutter. Empty when every other template is skipped, and for kinds occl_clutter and mixed without a record of their
/// clutter.
[[nodiscard]] std::optional<std::size_t> absent_template(const Dataset& set, std::size_t image_index);

}  // namespace pickcell::cli
