#include "pickcell/matches/coarse/scene.hpp"

#include <algorithm>
#include <cmath>

#include "pickcell/matches/coarse/kernel.hpp"
#include "pickcell/matches/fields/orientation_field.hpp"

namespace pickcell::matches {
namespace {

using Share = CoarseScene::Share;

constexpr int kLookEach = 8;  // rows of cells between two looks at the clock

void share_out(int source, double ratio, int n, std::vector<Share>& out) {
  out.clear();
  for (int i = 0; i < n; ++i) {
    const double lo = i * ratio;
    const double hi = std::min((i + 1) * ratio, static_cast<double>(source));
    Share c{static_cast<int>(lo), std::min(static_cast<int>(hi), source - 1), 0, 0};
    c.first_share = static_cast<float>(std::min(c.first + 1.0, hi) - lo);
    c.last_share = c.last > c.first ? static_cast<float>(hi - c.last) : 0.f;
    out.push_back(c);
  }
}

/// Rows of c2, s2 and energy in one buffer.
class Sums {
 public:
  Sums(std::vector<float>& values, int n) : stride_(static_cast<std::size_t>(n) + kTensorSlack), values_(values) {
    values_.resize(3 * stride_);
  }
  [[nodiscard]] float* part(std::size_t q) { return values_.data() + q * stride_; }
  [[nodiscard]] TensorRow row() { return {part(0), part(1), part(2)}; }

 private:
  std::size_t stride_;
  std::vector<float>& values_;
};

float pooled(const float* source, const Share& c) {
  float v = source[c.first] * c.first_share + source[c.last] * c.last_share;
  for (int x = c.first + 1; x < c.last; ++x) v += source[x];
  return v;
}

constexpr std::uint32_t kZeroCell = 0x80808080;

/// sums: over the cells' rows, per source pixel. out[-1] is the cell before the first.
void store_row(Sums& sums, const std::vector<Share>& columns, float per_area, std::uint32_t* out) {
  const auto byte = [](float v) { return static_cast<std::uint32_t>(128 + std::lrintf(v)); };
  for (std::size_t i = 0; i < columns.size(); ++i) {
    const Share& c = columns[i];
    const float k = 127.f * per_area / (pooled(sums.part(2), c) * per_area + kEdgeGrey * kEdgeGrey);
    const std::uint32_t own = byte(k * pooled(sums.part(0), c)) | byte(k * pooled(sums.part(1), c)) << 8;
    std::uint32_t* const cell = out + i;
    cell[0] = own | (kZeroCell & 0xffff0000U);
    cell[-1] = (cell[-1] & 0xffffU) | own << 16;
  }
}

}  // namespace

int field_level(double factor) { return std::max(0, std::ilogb(factor) - 1); }

bool build_coarse_scene(const image::Pyramid& scene, double factor, int margin, WorkBudget& budget, CoarseScene& out) {
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

  share_out(source.width(), ratio, out.width, out.columns);
  share_out(source.height(), ratio, out.height, out.rows);
  Sums sums(out.sums, source.width());
  for (int y = 0; y < out.height; ++y) {
    if (y % kLookEach == 0 && budget.spent()) return false;
    const Share& c = out.rows[static_cast<std::size_t>(y)];
    sum_tensors(source, {c.first, c.last, c.first_share, c.last_share}, sums.row());
    store_row(sums, out.columns, static_cast<float>(1 / (ratio * ratio)), out.cells.row(y + margin) + margin);
  }
  return true;
}

}  // namespace pickcell::matches
