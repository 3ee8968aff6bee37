#pragma once
/// The models that a cell file names, loaded.

#include <vector>

#include "pickcell/cell/cell_config.hpp"
#include "pickcell/core/result.hpp"
#include "pickcell/matches/model.hpp"

namespace pickcell::cli {

/// In the order of the file's parts, with the heights that it gives. Errors: unreadable: a file that is no model, a
/// model without a grasp, two of one name.
[[nodiscard]] core::Result<std::vector<matches::Model>> load_models(const cell::CellConfig& config);

}  // namespace pickcell::cli
