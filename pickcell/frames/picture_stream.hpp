#pragma once
/// Pictures one after the other in a stream of bytes: YUV4MPEG2 (.y4m, 8 bit, its luma), JPEG files in a row (.mjpeg),
/// or binary PGM/PPM files in a row. Which it is, its first bytes tell.

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "pickcell/core/result.hpp"
#include "pickcell/image/image.hpp"

namespace pickcell::frames {

/// Not thread-safe. Holds at most one picture and what of the next has come.
class PictureStream {
 public:
  /// name: in errors.
  explicit PictureStream(std::string name) : name_(std::move(name)) {}

  /// The next bytes of the stream.
  void feed(std::span<const std::byte> bytes);
  /// Nothing more will come.
  void end() { ended_ = true; }

  /// The next picture; empty: more bytes are needed, or after end() that there is none. Errors: unreadable (neither of
  /// the three formats, a size that no picture has, a stream that ends within a picture); the stream is then over.
  [[nodiscard]] core::Result<std::optional<image::Image>> next();

  /// Frames per second that a Y4M stream names; 0: none.
  [[nodiscard]] double fps() const { return fps_; }

 private:
  enum class Kind { unknown, y4m, jpeg, pnm };
  using Next = core::Result<std::optional<image::Image>>;
  [[nodiscard]] Next fail(std::string why);
  /// More is needed: an error when nothing more can come and something is left.
  [[nodiscard]] Next want_more();
  [[nodiscard]] std::optional<std::string> line(std::size_t from) const;
  [[nodiscard]] Next next_y4m();
  [[nodiscard]] Next next_jpeg();
  [[nodiscard]] Next next_pnm();
  [[nodiscard]] bool read_y4m_header(const std::string& header);
  void drop(std::size_t n);

  std::string name_;
  std::vector<std::byte> bytes_;
  std::size_t begin_ = 0;  ///< of what is not used yet
  std::size_t seen_ = 0;   ///< from begin_, already searched for an end
  Kind kind_ = Kind::unknown;
  bool ended_ = false, failed_ = false;
  int width_px_ = 0, height_px_ = 0;
  std::size_t chroma_bytes_ = 0;
  double fps_ = 0;
};

}  // namespace pickcell::frames
