#include "pickcell/matches/coarse_scene.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "pickcell/matches/coarse_kernel.hpp"
#include "pickcell/matches/orientation_field.hpp"

namespace pickcell::matches {
namespace {

/// Which source pixels make a cell along one axis: whole ones between two partial ones.
struct Cell {
  int first;
  int last;
  float first_share;
  float last_share;
};

std::vector<Cell> cells(int source, double ratio, int n) {
  std::vector<Cell> out;
  for (int i = 0; i < n; ++i) {
    const double lo = i * ratio;
    const double hi = std::min((i + 1) * ratio, static_cast<double>(source));
    Cell c{static_cast<int>(lo), std::min(static_cast<int>(hi), source - 1), 0, 0};
    c.first_share = static_cast<float>(std::min(c.first + 1.0, hi) - lo);
    c.last_share = c.last > c.first ? static_cast<float>(hi - c.last) : 0.f;
    out.push_back(c);
  }
  return out;
}

/// Rows of c2, s2 and energy.
struct Sums {
  std::size_t stride;
  std::vector<float> values;
  explicit Sums(int n) : stride(static_cast<std::size_t>(n) + kTensorSlack), values(3 * stride) {}
  [[nodiscard]] float* part(std::size_t q) { return values.data() + q * stride; }
  [[nodiscard]] TensorRow row() { return {part(0), part(1), part(2)}; }
};

float pooled(const float* source, const Cell& c) {
  float v = source[c.first] * c.first_share + source[c.last] * c.last_share;
  for (int x = c.first + 1; x < c.last; ++x) v += source[x];
  return v;
}

constexpr std::uint32_t kZeroCell = 0x80808080;

/// sums: over the cells' rows, per source pixel. out[-1] is the cell before the first.
void store_row(Sums& sums, const std::vector<Cell>& columns, float per_area, std::uint32_t* out) {
  const auto byte = [](float v) { return static_cast<std::uint32_t>(128 + std::lrintf(v)); };
  for (std::size_t i = 0; i < columns.size(); ++i) {
    const Cell& c = columns[i];
    const float k = 127.f * per_area / (pooled(sums.part(2), c) * per_area + kEdgeGrey * kEdgeGrey);
    const std::uint32_t own = byte(k * pooled(sums.part(0), c)) | byte(k * pooled(sums.part(1), c)) << 8;
    std::uint32_t* const cell = out + i;
    cell[0] = own | (kZeroCell & 0xffff0000U);
    cell[-1] = (cell[-1] & 0xffffU) | own << 16;
  }
}

}  // namespace

int field_level(double factor) { return std::max(0, std::ilogb(factor) - 1); }

void build_coarse_scene(const image::Pyramid& scene, double factor, int margin, CoarseScene& out) {
  const int level = std::min(field_level(factor), scene.levels() - 1);
  const image::ImageView source = scene.level(level);
  const double ratio = std::ldexp(factor, -level);
  out.factor = factor;
  out.width = static_cast<int>(source.width() / ratio);
  out.height = static_cast<int>(source.height() / ratio);
  out.margin = margin;
  // One row and one block more than needed: the kernel rounds runs of positions up.
  out.cells.resize(out.width + 2 * margin + kKernelBlock, out.height + 2 * margin + 1);
  out.cells.fill(kZeroCell);

  const std::vector<Cell> columns = cells(source.width(), ratio, out.width);
  const std::vector<Cell> rows = cells(source.height(), ratio, out.height);
  Sums sums(source.width());
  for (int y = 0; y < out.height; ++y) {
    const Cell& c = rows[static_cast<std::size_t>(y)];
    std::fill(sums.values.begin(), sums.values.end(), 0.f);
    for (int v = c.first; v <= c.last; ++v)
      add_tensor_row(source, v, v == c.first ? c.first_share : v == c.last ? c.last_share : 1.f, sums.row());
    store_row(sums, columns, static_cast<float>(1 / (ratio * ratio)), out.cells.row(y + margin) + margin);
  }
}

}  // namespace pickcell::matches
