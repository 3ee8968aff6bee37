#pragma once
/// Pictures that are used again: a frame's pixels go back to the pool when the last reader drops it, so that a running
/// camera allocates nothing per frame.

#include <cstddef>
#include <memory>

#include "pickcell/image/image.hpp"

namespace pickcell::frames {

/// Thread-safe. Pictures that are still held outlive the pool.
class PicturePool {
 public:
  /// Keeps at most this many unused pictures.
  explicit PicturePool(std::size_t kept = 8);

  /// A picture that nobody else holds, of any earlier content and size; new when all are held. Fill it, then hand it
  /// out as const.
  [[nodiscard]] std::shared_ptr<image::Image> take();
  /// Pictures made so far that still exist, held or not.
  [[nodiscard]] std::size_t made() const;

 private:
  struct State;
  std::shared_ptr<State> state_;
};

}  // namespace pickcell::frames
