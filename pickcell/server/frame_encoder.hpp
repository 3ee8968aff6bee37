#pragma once
/// Pictures as messages, encoded once for all clients that want the same.

#include <cstddef>
#include <memory>
#include <vector>

#include "pickcell/server/client_queue.hpp"

namespace pickcell::server {

using SharedBytes = std::shared_ptr<const std::vector<std::byte>>;

/// Keeps what was made from the two pictures used last. One thread at a time.
class FrameEncoder {
 public:
  /// The whole binary message, at most max_width_px wide.
  [[nodiscard]] SharedBytes message(const ShownFramePtr& shown, int max_width_px, int quality);
  /// The JPEG alone. picture is not null and not empty.
  [[nodiscard]] SharedBytes jpeg(const std::shared_ptr<const image::Image>& picture, int max_width_px, int quality);
  [[nodiscard]] std::size_t jpegs_made() const { return jpegs_made_; }

 private:
  struct Jpeg {
    std::shared_ptr<const image::Image> picture;
    int width_px = 0, quality = 0;
    SharedBytes bytes;
  };
  struct Message {
    ShownFramePtr shown;
    int width_px = 0, quality = 0;
    SharedBytes bytes;
  };
  std::vector<Jpeg> jpegs_;
  std::vector<Message> messages_;
  std::size_t jpegs_made_ = 0;
};

}  // namespace pickcell::server
