#pragma once
/// Everything that engine best derives from a picture, shared by all models that are searched for in it.

#include <memory>
#include <vector>

#include "pickcell/image/pyramid.hpp"
#include "pickcell/matches/coarse/scene.hpp"
#include "pickcell/matches/fields/lazy_field.hpp"
#include "pickcell/matches/fit/refine.hpp"

namespace pickcell::matches {

/// Keeps its memory from picture to picture. Not thread-safe; a SceneLevel may be read by many threads.
class BestScene {
 public:
  /// The pyramid must outlive the use of this scene.
  void start(const image::Pyramid& pyramid);
  [[nodiscard]] int levels() const { return pyramid_->levels(); }
  [[nodiscard]] int width() const { return pyramid_->level(0).width(); }
  [[nodiscard]] int height() const { return pyramid_->level(0).height(); }

  /// Its orientation field is computed where it is looked at.
  [[nodiscard]] SceneLevel level(int l);
  /// The top level for a factor, with at least this margin; computed when first asked for. Null: the budget was spent
  /// before it was done.
  [[nodiscard]] const CoarseScene* coarse(double factor, int margin, WorkBudget& budget);

 private:
  const image::Pyramid* pyramid_ = nullptr;
  std::vector<std::unique_ptr<LazyField>> fields_;
  std::vector<char> started_;
  std::vector<std::unique_ptr<CoarseScene>> coarse_;  ///< the first coarse_used_ belong to this picture
  std::size_t coarse_used_ = 0;
};

}  // namespace pickcell::matches
