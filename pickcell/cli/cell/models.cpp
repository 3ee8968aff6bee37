#include "pickcell/cli/cell/models.hpp"

#include <utility>

#include "pickcell/core/units.hpp"
#include "pickcell/matches/model_file.hpp"

namespace pickcell::cli {

using core::ErrorCode;
using core::failure;

core::Result<std::vector<matches::Model>> load_models(const cell::CellConfig& config) {
  std::vector<matches::Model> models;
  for (const cell::PartConfig& part : config.parts) {
    auto model = matches::load_model(part.model);
    if (!model) return core::forward(model);
    if (part.height_mm) model->height_m = core::m_from_mm(*part.height_mm);
    if (model->grasps.empty())
      return failure(ErrorCode::unreadable, part.model.string(), "the model has no grasp",
                     "teach it again with --grasp x,y,deg");
    for (const matches::Model& other : models)
      if (other.name == model->name)
        return failure(ErrorCode::unreadable, part.model.string(), "another part is called '" + model->name + "' too",
                       "teach one of them under another name");
    models.push_back(std::move(*model));
  }
  return models;
}

}  // namespace pickcell::cli
