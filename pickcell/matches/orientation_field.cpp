#include "pickcell/matches/orientation_field.hpp"

#include <algorithm>
#include <array>
#include <vector>

// clang-format off
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "pickcell/matches/orientation_field.cpp"
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

void add_tensor_row_impl(const std::uint8_t* up, const std::uint8_t* padded, const std::uint8_t* down, int width,
                         float share, const TensorRow& sums) {
  const DF d;
  const VF s = hn::Set(d, share);
  each_tensor(up, padded, down, width, [&](int x, const Tensor& t) HWY_ATTR {
    hn::StoreU(hn::MulAdd(s, t.c2, hn::LoadU(d, sums.c2 + x)), d, sums.c2 + x);
    hn::StoreU(hn::MulAdd(s, t.s2, hn::LoadU(d, sums.s2 + x)), d, sums.s2 + x);
    hn::StoreU(hn::MulAdd(s, t.energy, hn::LoadU(d, sums.energy + x)), d, sums.energy + x);
  });
}

/// in has one value before and one after the row; out = 1-2-1.
void smooth_row_impl(const float* in, int width, float* out) {
  const DF d;
  const int lanes = static_cast<int>(hn::Lanes(d));
  for (int x = 0; x < width; x += lanes) {
    const VF mid = hn::LoadU(d, in + x);
    hn::StoreU(hn::Add(hn::Add(hn::LoadU(d, in + x - 1), hn::LoadU(d, in + x + 1)), hn::Add(mid, mid)), d, out + x);
  }
}

/// Rows of c2, s2, energy above, here and below, smoothed along x: nine arrays.
void normalise_row_impl(const float* const* rows, int width, std::int8_t* out) {
  const DF d;
  const DI di;
  const hn::Rebind<std::uint16_t, DF> d16;
  const int lanes = static_cast<int>(hn::Lanes(d));
  const VF full = hn::Set(d, 127.f);
  const VF floor = hn::Set(d, 16 * kEdgeGrey * kEdgeGrey);
  const auto low_byte = hn::Set(di, 0xff);
  const auto column = [&](int q, int x) HWY_ATTR {
    const VF mid = hn::LoadU(d, rows[3 + q] + x);
    return hn::Add(hn::Add(hn::LoadU(d, rows[q] + x), hn::LoadU(d, rows[6 + q] + x)), hn::Add(mid, mid));
  };
  for (int x = 0; x < width; x += lanes) {
    const VF k = hn::Div(full, hn::Add(column(2, x), floor));
    const auto c2 = hn::NearestInt(hn::Mul(k, column(0, x)));
    const auto s2 = hn::NearestInt(hn::Mul(k, column(1, x)));
    const auto pair = hn::Or(hn::And(c2, low_byte), hn::ShiftLeft<8>(hn::And(s2, low_byte)));
    hn::StoreU(hn::DemoteTo(d16, pair), d16, reinterpret_cast<std::uint16_t*>(out + 2 * x));
  }
}

}  // namespace pickcell::matches::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace pickcell::matches {

HWY_EXPORT(tensor_row_impl);
HWY_EXPORT(add_tensor_row_impl);
HWY_EXPORT(smooth_row_impl);
HWY_EXPORT(normalise_row_impl);

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

/// Tensor rows of one part, smoothed along x, three at a time. Beyond the picture its border is repeated.
class SmoothRows {
 public:
  SmoothRows(image::ImageView picture, int x0, int x1) : picture_(picture), x0_(x0), x1_(x1) {}

  void compute(int y) {
    const int w = picture_.width();
    const int from = std::max(0, x0_ - 1), to = std::min(w, x1_ + 1);  // what the smoothing reads
    const std::uint8_t* row = picture_.row(y);
    grey_[0] = row[std::max(0, from - 1)];
    std::copy(row + from, row + to, grey_.begin() + 1);
    grey_[static_cast<std::size_t>(to - from) + 1] = row[std::min(w - 1, to)];
    const std::uint8_t* up = picture_.row(std::max(0, y - 1)) + from;
    const std::uint8_t* down = picture_.row(std::min(picture_.height() - 1, y + 1)) + from;
    const std::size_t first = from < x0_ ? 0 : 1;
    const std::size_t end = first + static_cast<std::size_t>(to - from);
    HWY_DYNAMIC_DISPATCH(tensor_row_impl)
    (up, grey_.data(), down, to - from, {raw_[0].data() + first, raw_[1].data() + first, raw_[2].data() + first});
    for (std::size_t q = 0; q < 3; ++q) {
      if (first == 1) raw_[q][0] = raw_[q][1];
      if (to == x1_) raw_[q][end] = raw_[q][end - 1];
      HWY_DYNAMIC_DISPATCH(smooth_row_impl)(raw_[q].data() + 1, x1_ - x0_, slot(y)[q].data());
    }
  }
  using Row = std::array<float, kFieldPartWidth + 2 + 2 * kTensorSlack>;
  [[nodiscard]] std::array<Row, 3>& slot(int y) { return smooth_[static_cast<std::size_t>(y % 3)]; }

 private:
  image::ImageView picture_;
  int x0_;
  int x1_;
  std::array<std::uint8_t, kFieldPartWidth + 4 + kReadAhead> grey_{};
  std::array<Row, 3> raw_{};
  std::array<std::array<Row, 3>, 3> smooth_{};
};

}  // namespace

void orientation_tensor_row(image::ImageView picture, int y, const TensorRow& out) {
  const Neighbours n = neighbours(picture, y);
  HWY_DYNAMIC_DISPATCH(tensor_row_impl)(n.up, n.padded, n.down, picture.width(), out);
}

void add_tensor_row(image::ImageView picture, int y, float share, const TensorRow& sums) {
  const Neighbours n = neighbours(picture, y);
  HWY_DYNAMIC_DISPATCH(add_tensor_row_impl)(n.up, n.padded, n.down, picture.width(), share, sums);
}

void orientation_field_part(image::ImageView picture, int x0, int y0, int x1, int y1, OrientationField& out) {
  const int last = picture.height() - 1;
  SmoothRows rows(picture, x0, x1);
  rows.compute(std::max(0, y0 - 1));
  if (y0 > 0) rows.compute(y0);
  for (int y = y0; y < y1; ++y) {
    if (y < last) rows.compute(y + 1);
    std::array<const float*, 9> nine{};
    const int ys[3] = {std::max(0, y - 1), y, std::min(last, y + 1)};
    for (std::size_t k = 0; k < 3; ++k)
      for (std::size_t q = 0; q < 3; ++q) nine[3 * k + q] = rows.slot(ys[k])[q].data();
    std::array<std::int8_t, 2 * (kFieldPartWidth + kTensorSlack)> line;
    HWY_DYNAMIC_DISPATCH(normalise_row_impl)(nine.data(), x1 - x0, line.data());
    std::copy(line.begin(), line.begin() + 2 * (x1 - x0), out.row(y) + 2 * x0);
  }
}

void orientation_field(image::ImageView picture, OrientationField& out) {
  out.resize(2 * picture.width(), picture.height());
  for (int x = 0; x < picture.width(); x += kFieldPartWidth)
    orientation_field_part(picture, x, 0, std::min(picture.width(), x + kFieldPartWidth), picture.height(), out);
}

}  // namespace pickcell::matches
#endif
