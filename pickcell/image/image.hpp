#pragma once
/// Grey pictures. Pixel centres at integers, (0,0) is the centre of the top-left pixel, x right, y down.

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <new>
#include <utility>

namespace pickcell::image {

/// A picture that somebody else owns: width x height values, rows stride apart (in values). Cheap to copy.
template <class T>
class View {
 public:
  View() = default;
  View(const T* data, int width, int height, std::ptrdiff_t stride)
      : data_(data), width_(width), height_(height), stride_(stride) {}

  [[nodiscard]] int width() const { return width_; }
  [[nodiscard]] int height() const { return height_; }
  [[nodiscard]] std::ptrdiff_t stride() const { return stride_; }
  [[nodiscard]] bool empty() const { return width_ == 0 || height_ == 0; }
  [[nodiscard]] const T* row(int y) const { return data_ + y * stride_; }
  [[nodiscard]] T at(int x, int y) const { return row(y)[x]; }
  /// The part x, y, w, h; must lie inside.
  [[nodiscard]] View crop(int x, int y, int w, int h) const { return View(row(y) + x, w, h, stride_); }

 private:
  const T* data_ = nullptr;
  int width_ = 0;
  int height_ = 0;
  std::ptrdiff_t stride_ = 0;
};

using ImageView = View<std::uint8_t>;

/// A picture that owns its pixels. Rows start at 64-byte boundaries and are padded to whole 64-byte blocks, so kernels
/// may read up to 64 bytes past the last pixel of any row, the last one included; padding is zero at construction.
/// resize() keeps the memory when it suffices.
template <class T>
class Plane {
 public:
  Plane() = default;
  Plane(int width, int height) { resize(width, height); }
  explicit Plane(View<T> view) : Plane(view.width(), view.height()) {
    for (int y = 0; y < view.height(); ++y)
      std::memcpy(row(y), view.row(y), sizeof(T) * static_cast<std::size_t>(view.width()));
  }
  Plane(const Plane& other) : Plane(other.view()) {}
  Plane(Plane&& other) noexcept { swap(other); }
  Plane& operator=(Plane other) noexcept {
    swap(other);
    return *this;
  }
  ~Plane() { ::operator delete(data_, std::align_val_t{64}); }

  void swap(Plane& other) noexcept {
    std::swap(data_, other.data_);
    std::swap(capacity_, other.capacity_);
    std::swap(width_, other.width_);
    std::swap(height_, other.height_);
    std::swap(stride_, other.stride_);
  }

  /// Content is undefined afterwards unless the size is unchanged.
  void resize(int width, int height) {
    constexpr std::ptrdiff_t kBlock = 64 / sizeof(T);
    const std::ptrdiff_t stride = (width + kBlock - 1) / kBlock * kBlock;
    const std::size_t need = static_cast<std::size_t>(stride) * static_cast<std::size_t>(height) * sizeof(T) + 64;
    if (need > capacity_) {
      ::operator delete(std::exchange(data_, nullptr), std::align_val_t{64});
      capacity_ = 0;
      data_ = static_cast<T*>(::operator new(need, std::align_val_t{64}));
      capacity_ = need;
      std::memset(static_cast<void*>(data_), 0, need);
    }
    width_ = width;
    height_ = height;
    stride_ = stride;
  }

  void fill(T value) {
    for (int y = 0; y < height_; ++y)
      for (int x = 0; x < width_; ++x) row(y)[x] = value;
  }

  [[nodiscard]] int width() const { return width_; }
  [[nodiscard]] int height() const { return height_; }
  [[nodiscard]] std::ptrdiff_t stride() const { return stride_; }
  [[nodiscard]] bool empty() const { return width_ == 0 || height_ == 0; }
  [[nodiscard]] T* row(int y) { return data_ + y * stride_; }
  [[nodiscard]] const T* row(int y) const { return data_ + y * stride_; }
  [[nodiscard]] T& at(int x, int y) { return row(y)[x]; }
  [[nodiscard]] T at(int x, int y) const { return row(y)[x]; }
  [[nodiscard]] View<T> view() const { return View<T>(data_, width_, height_, stride_); }

 private:
  T* data_ = nullptr;
  std::size_t capacity_ = 0;
  int width_ = 0;
  int height_ = 0;
  std::ptrdiff_t stride_ = 0;
};

using Image = Plane<std::uint8_t>;

}  // namespace pickcell::image
