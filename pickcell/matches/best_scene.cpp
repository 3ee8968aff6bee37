#include "pickcell/matches/best_scene.hpp"

#include <algorithm>

namespace pickcell::matches {

void BestScene::start(const image::Pyramid& pyramid) {
  pyramid_ = &pyramid;
  const auto n = static_cast<std::size_t>(pyramid.levels());
  if (fields_.size() < n) fields_.resize(n);
  have_field_.assign(n, false);
  coarse_used_ = 0;
}

SceneLevel BestScene::level(int l) {
  const auto i = static_cast<std::size_t>(l);
  if (!have_field_[i]) {
    orientation_field(pyramid_->level(l), fields_[i]);
    have_field_[i] = true;
  }
  return {pyramid_->level(l), &fields_[i], l};
}

const CoarseScene& BestScene::coarse(double factor, int margin) {
  std::size_t i = 0;
  while (i < coarse_used_ && coarse_[i]->factor != factor) ++i;
  if (i < coarse_used_ && coarse_[i]->margin >= margin) return *coarse_[i];
  if (i == coarse_used_) {
    if (i == coarse_.size()) coarse_.push_back(std::make_unique<CoarseScene>());
    ++coarse_used_;
  }
  build_coarse_scene(*pyramid_, factor, margin, *coarse_[i]);
  return *coarse_[i];
}

}  // namespace pickcell::matches
