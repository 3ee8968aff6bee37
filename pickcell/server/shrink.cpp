#include "pickcell/server/shrink.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <stdexcept>
#include <vector>

namespace pickcell::server {

namespace {

/// The source pixels under one result pixel.
struct Span {
  int first = 0;
  std::vector<std::uint32_t> weights;  ///< sum 65536, so that a column's sum stays below 2^24
};

std::vector<Span> spans(int from, int to) {
  constexpr double kOne = 65536;
  std::vector<Span> out(static_cast<std::size_t>(to));
  const double step = static_cast<double>(from) / to;
  for (int i = 0; i < to; ++i) {
    const double low = i * step;
    const double high = std::min<double>(from, (i + 1) * step);
    Span& span = out[static_cast<std::size_t>(i)];
    span.first = std::min(from - 1, static_cast<int>(low));
    std::uint32_t sum = 0;
    for (int x = span.first; x < from && x < high; ++x) {
      const double covered = std::min<double>(x + 1, high) - std::max<double>(x, low);
      span.weights.push_back(static_cast<std::uint32_t>(std::lround(covered / step * kOne)));
      sum += span.weights.back();
    }
    *std::max_element(span.weights.begin(), span.weights.end()) += 65536u - sum;  // rounding goes where it shows least
  }
  return out;
}

}  // namespace

image::Image shrink(image::ImageView picture, int width) {
  if (width < 1 || width > picture.width()) throw std::invalid_argument("shrink: width outside 1..picture width");
  if (width == picture.width()) return image::Image(picture);
  const double scale = static_cast<double>(width) / picture.width();
  const int height = std::max(1, static_cast<int>(std::lround(picture.height() * scale)));
  const auto columns = spans(picture.width(), width);
  const auto rows = spans(picture.height(), height);
  image::Image out(width, height);
  std::vector<std::uint32_t> sums(static_cast<std::size_t>(picture.width()));
  for (int y = 0; y < height; ++y) {
    const Span& span = rows[static_cast<std::size_t>(y)];
    std::fill(sums.begin(), sums.end(), 0u);
    for (std::size_t k = 0; k < span.weights.size(); ++k) {
      const std::uint8_t* source = picture.row(span.first + static_cast<int>(k));
      for (std::size_t x = 0; x < sums.size(); ++x) sums[x] += span.weights[k] * source[x];
    }
    for (int x = 0; x < width; ++x) {
      const Span& column = columns[static_cast<std::size_t>(x)];
      std::uint64_t sum = 0;
      for (std::size_t k = 0; k < column.weights.size(); ++k)
        sum += std::uint64_t{column.weights[k]} * sums[static_cast<std::size_t>(column.first) + k];
      out.at(x, y) = static_cast<std::uint8_t>((sum + (std::uint64_t{1} << 31)) >> 32);
    }
  }
  return out;
}

}  // namespace pickcell::server
