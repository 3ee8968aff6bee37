#include "pickcell/matches/best/scene.hpp"

#include <algorithm>

namespace pickcell::matches {

void BestScene::start(const image::Pyramid& pyramid) {
  pyramid_ = &pyramid;
  const auto n = static_cast<std::size_t>(pyramid.levels());
  while (fields_.size() < n) fields_.push_back(std::make_unique<LazyField>());
  started_.assign(n, 0);
  coarse_used_ = 0;
}

SceneLevel BestScene::level(int l) {
  const auto i = static_cast<std::size_t>(l);
  if (!started_[i]) {
    fields_[i]->start(pyramid_->level(l));
    started_[i] = 1;
  }
  return {pyramid_->level(l), fields_[i].get(), l};
}

const CoarseScene* BestScene::coarse(double factor, int margin, WorkBudget& budget) {
  std::size_t i = 0;
  while (i < coarse_used_ && coarse_[i]->factor != factor) ++i;
  if (i < coarse_used_ && coarse_[i]->margin >= margin) return coarse_[i].get();
  if (i == coarse_used_) {
    if (i == coarse_.size()) coarse_.push_back(std::make_unique<CoarseScene>());
    ++coarse_used_;
  }
  if (build_coarse_scene(*pyramid_, factor, margin, budget, *coarse_[i])) return coarse_[i].get();
  coarse_[i]->factor = 0;  // half a field is none
  return nullptr;
}

}  // namespace pickcell::matches
