#include "pickcell/matches/fields/orientation_field.hpp"

#include <algorithm>
#include <cstddef>
#include <vector>

// clang-format off
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "pickcell/matches/fields/orientation_field.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>
// clang-format on

HWY_BEFORE_NAMESPACE();
namespace pickcell::matches::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

// At most 16 lanes: the promise of kTensorSlack.
using DF = hn::CappedTag<float, 16>;
using DI = hn::RebindToSigned<DF>;
using VF = hn::Vec<DF>;

HWY_INLINE VF load_grey(const std::uint8_t* p) {
  const hn::Rebind<std::uint8_t, DF> du8;
  return hn::ConvertTo(DF(), hn::PromoteTo(DI(), hn::LoadU(du8, p)));
}

struct Tensor {
  VF c2, s2, energy;
};

HWY_INLINE Tensor tensor_of(VF gx, VF gy) {
  const VF xx = hn::Mul(gx, gx);
  const VF yy = hn::Mul(gy, gy);
  const VF xy = hn::Mul(gx, gy);
  return {hn::Sub(xx, yy), hn::Add(xy, xy), hn::Add(xx, yy)};
}

/// Calls put(x, tensor) for x = 0, lanes, 2 lanes ...; the last call may go past the width. left and right are the rows
/// that x - 1 and x + 1 are read from: the caller gives a copy with its border repeated.
template <class Put>
HWY_INLINE void each_tensor(const std::uint8_t* up, const std::uint8_t* padded, const std::uint8_t* down, int width,
                            Put put) {
  const VF half = hn::Set(DF(), 0.5f);
  const int lanes = static_cast<int>(hn::Lanes(DF()));
  for (int x = 0; x < width; x += lanes) {
    const VF gx = hn::Mul(half, hn::Sub(load_grey(padded + x + 2), load_grey(padded + x)));
    const VF gy = hn::Mul(half, hn::Sub(load_grey(down + x), load_grey(up + x)));
    put(x, tensor_of(gx, gy));
  }
}

void tensor_row_impl(const std::uint8_t* up, const std::uint8_t* padded, const std::uint8_t* down, int width,
                     const TensorRow& out) {
  const DF d;
  each_tensor(up, padded, down, width, [&](int x, const Tensor& t) HWY_ATTR {
    hn::StoreU(t.c2, d, out.c2 + x);
    hn::StoreU(t.s2, d, out.s2 + x);
    hn::StoreU(t.energy, d, out.energy + x);
  });
}

/// Rows of a part, with one column on each side, smoothed 1-2-1 down the columns: 16 times the tensor's values (four by
/// the smoothing, four by differences that are not halved).
struct PartRows {
  static constexpr int kRoom = kFieldPartWidth + 2 + kTensorSlack;
  float values[kFieldPartHeight][3][kRoom];
};

/// The tensor of whole differences: four times that of central ones.
HWY_INLINE Tensor whole_tensor(const std::uint8_t* up, const std::uint8_t* left, const std::uint8_t* right,
                               const std::uint8_t* down) {
  const hn::Rebind<std::uint8_t, DF> du8;
  const auto difference = [&](const std::uint8_t* a, const std::uint8_t* b) HWY_ATTR {
    const DI di;
    return hn::ConvertTo(DF(), hn::Sub(hn::PromoteTo(di, hn::LoadU(du8, a)), hn::PromoteTo(di, hn::LoadU(du8, b))));
  };
  return tensor_of(difference(right, left), difference(down, up));
}

HWY_INLINE Tensor sum_of(const Tensor& a, const Tensor& b) {
  return {hn::Add(a.c2, b.c2), hn::Add(a.s2, b.s2), hn::Add(a.energy, b.energy)};
}

/// All columns but the first and the last: a block of columns at once, down all rows, in registers.
void sum_tensors_impl(image::ImageView picture, const RowShares& rows, const TensorRow& sums) {
  const DF d;
  const int lanes = static_cast<int>(hn::Lanes(d)), last = picture.height() - 1;
  for (int x = 1; x + 1 < picture.width(); x += lanes) {
    VF c2 = hn::Zero(d), s2 = c2, energy = c2;
    for (int y = rows.first; y <= rows.last; ++y) {
      const std::uint8_t* row = picture.row(y) + x;
      const Tensor t =
          whole_tensor(picture.row(std::max(0, y - 1)) + x, row - 1, row + 1, picture.row(std::min(last, y + 1)) + x);
      const VF share = hn::Set(d, 0.25f * rows.of(y));
      c2 = hn::MulAdd(share, t.c2, c2);
      s2 = hn::MulAdd(share, t.s2, s2);
      energy = hn::MulAdd(share, t.energy, energy);
    }
    hn::StoreU(c2, d, sums.c2 + x);
    hn::StoreU(s2, d, sums.s2 + x);
    hn::StoreU(energy, d, sums.energy + x);
  }
}

/// Pixels of a row's neighbours to the left; those to the right are two further on. Beyond the picture its border is
/// repeated, in the copy.
HWY_INLINE const std::uint8_t* beside(image::ImageView picture, int y, int from, int to, std::uint8_t* copy) {
  const std::uint8_t* row = picture.row(y);
  if (from > 0 && to < picture.width()) return row + from - 1;
  copy[0] = row[std::max(0, from - 1)];
  std::copy(row + from, row + to, copy + 1);
  copy[to - from + 1] = row[std::min(picture.width() - 1, to)];
  return copy;
}

void smooth_down(image::ImageView picture, const FieldPart& part, PartRows& out) {
  const DF d;
  const int lanes = static_cast<int>(hn::Lanes(d)), last = picture.height() - 1;
  const int from = std::max(0, part.x0 - 1), to = std::min(picture.width(), part.x1 + 1);
  const int first = from - (part.x0 - 1);
  alignas(64) std::uint8_t copy[kFieldPartWidth + 4 + 4 * kTensorSlack] = {};
  for (int x = 0; x < to - from; x += lanes) {
    const auto tensor = [&](int y) __attribute__((always_inline)) HWY_ATTR {
      const std::uint8_t* left = beside(picture, y, from, to, copy) + x;
      return whole_tensor(picture.row(std::max(0, y - 1)) + from + x, left, left + 2,
                          picture.row(std::min(last, y + 1)) + from + x);
    };
    Tensor here = tensor(part.y0);
    Tensor before = sum_of(part.y0 > 0 ? tensor(part.y0 - 1) : here, here);
    for (int y = part.y0; y < part.y1; ++y) {
      const Tensor below = y < last ? tensor(y + 1) : here;
      const Tensor after = sum_of(here, below);
      const Tensor sum = sum_of(before, after);
      float(&rows)[3][PartRows::kRoom] = out.values[y - part.y0];
      hn::StoreU(sum.c2, d, rows[0] + first + x);
      hn::StoreU(sum.s2, d, rows[1] + first + x);
      hn::StoreU(sum.energy, d, rows[2] + first + x);
      before = after;
      here = below;
    }
  }
}

/// The first and the last column of the picture stand for those beyond.
void repeat_border(image::ImageView picture, const FieldPart& part, PartRows& rows) {
  const int width = part.x1 - part.x0;
  for (int y = 0; y < part.y1 - part.y0; ++y)
    for (float* row : rows.values[y]) {
      if (part.x0 == 0) row[0] = row[1];
      if (part.x1 == picture.width()) row[width + 1] = row[width];
    }
}

/// The field of one block of pixels, c2 and s2 as the bytes of one value each.
HWY_INLINE auto field_block(const float (&rows)[3][PartRows::kRoom], int x) {
  const DF d;
  const DI di;
  const hn::Rebind<std::uint16_t, DF> d16;
  const auto smooth = [&](int q) HWY_ATTR {
    const VF mid = hn::LoadU(d, rows[q] + x + 1);
    return hn::Add(hn::Add(hn::LoadU(d, rows[q] + x), hn::LoadU(d, rows[q] + x + 2)), hn::Add(mid, mid));
  };
  const VF k = hn::Div(hn::Set(d, 127.f), hn::Add(smooth(2), hn::Set(d, 64 * kEdgeGrey * kEdgeGrey)));
  const auto low_byte = hn::Set(di, 0xff);
  const auto c2 = hn::NearestInt(hn::Mul(k, smooth(0)));
  const auto s2 = hn::NearestInt(hn::Mul(k, smooth(1)));
  return hn::DemoteTo(d16, hn::Or(hn::And(c2, low_byte), hn::ShiftLeft<8>(hn::And(s2, low_byte))));
}

void field_part_impl(image::ImageView picture, const FieldPart& part, OrientationField& out) {
  const hn::Rebind<std::uint16_t, DF> d16;
  const int lanes = static_cast<int>(hn::Lanes(DF())), width = part.x1 - part.x0;
  PartRows rows;
  for (int y = part.y0; y < part.y1; ++y) {
    __builtin_prefetch(out.row(y) + 2 * part.x0, 1);
    __builtin_prefetch(out.row(y) + 2 * part.x1 - 1, 1);
  }
  smooth_down(picture, part, rows);
  if (part.x0 == 0 || part.x1 == picture.width()) repeat_border(picture, part, rows);
  for (int y = 0; y < part.y1 - part.y0; ++y) {
    auto* const to = reinterpret_cast<std::uint16_t*>(out.row(part.y0 + y) + std::ptrdiff_t{2} * part.x0);
    if (width < lanes) {  // nothing outside the part may be touched: others may be at work there
      std::uint16_t line[kTensorSlack];
      hn::StoreU(field_block(rows.values[y], 0), d16, line);
      std::copy(line, line + width, to);
      continue;
    }
    for (int x = 0; x < width; x += lanes) {
      const int at = std::min(x, width - lanes);
      hn::StoreU(field_block(rows.values[y], at), d16, to + at);
    }
  }
}

}  // namespace pickcell::matches::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace pickcell::matches {

HWY_EXPORT(tensor_row_impl);
HWY_EXPORT(sum_tensors_impl);
HWY_EXPORT(field_part_impl);

namespace {

constexpr int kReadAhead = 64;

/// The three rows that a row's differences need.
struct Neighbours {
  const std::uint8_t* up;
  const std::uint8_t* padded;  ///< the row itself with its first and last pixel repeated
  const std::uint8_t* down;
};

Neighbours neighbours(image::ImageView picture, int y) {
  static thread_local std::vector<std::uint8_t> copy;
  const auto w = static_cast<std::size_t>(picture.width());
  if (copy.size() < w + kReadAhead) copy.resize(w + kReadAhead);
  const std::uint8_t* row = picture.row(y);
  copy[0] = row[0];
  std::copy(row, row + w, copy.begin() + 1);
  copy[w + 1] = row[w - 1];
  return {picture.row(std::max(0, y - 1)), copy.data(), picture.row(std::min(picture.height() - 1, y + 1))};
}

}  // namespace

void orientation_tensor_row(image::ImageView picture, int y, const TensorRow& out) {
  const Neighbours n = neighbours(picture, y);
  HWY_DYNAMIC_DISPATCH(tensor_row_impl)(n.up, n.padded, n.down, picture.width(), out);
}

void sum_tensors(image::ImageView picture, const RowShares& rows, const TensorRow& sums) {
  HWY_DYNAMIC_DISPATCH(sum_tensors_impl)(picture, rows, sums);
  const int last_x = picture.width() - 1, last_y = picture.height() - 1;
  for (const int x : {0, last_x}) {
    float c2 = 0, s2 = 0, energy = 0;
    for (int y = rows.first; y <= rows.last; ++y) {
      const auto gx =
          0.5f * static_cast<float>(picture.at(std::min(last_x, x + 1), y) - picture.at(std::max(0, x - 1), y));
      const auto gy =
          0.5f * static_cast<float>(picture.at(x, std::min(last_y, y + 1)) - picture.at(x, std::max(0, y - 1)));
      c2 += rows.of(y) * (gx * gx - gy * gy);
      s2 += rows.of(y) * 2 * gx * gy;
      energy += rows.of(y) * (gx * gx + gy * gy);
    }
    sums.c2[x] = c2, sums.s2[x] = s2, sums.energy[x] = energy;
  }
}

void orientation_field_part(image::ImageView picture, const FieldPart& part, OrientationField& out) {
  HWY_DYNAMIC_DISPATCH(field_part_impl)(picture, part, out);
}

void orientation_field(image::ImageView picture, OrientationField& out) {
  const int w = picture.width(), h = picture.height();
  out.resize(2 * w, h);
  for (int y = 0; y < h; y += kFieldPartHeight)
    for (int x = 0; x < w; x += kFieldPartWidth)
      orientation_field_part(picture, {x, y, std::min(w, x + kFieldPartWidth), std::min(h, y + kFieldPartHeight)}, out);
}

}  // namespace pickcell::matches
#endif
