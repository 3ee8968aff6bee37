#include "pickcell/matches/orientation_field.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

namespace pickcell::matches {
namespace {

std::int8_t to_byte(float v) { return static_cast<std::int8_t>(std::lrintf(v)); }

}  // namespace

void orientation_tensor_row(image::ImageView picture, int y, const TensorRow& out) {
  const int w = picture.width();
  const int h = picture.height();
  const std::uint8_t* up = picture.row(std::max(0, y - 1));
  const std::uint8_t* here = picture.row(y);
  const std::uint8_t* down = picture.row(std::min(h - 1, y + 1));
  const auto put = [&](int x, int left, int right) {
    const float gx = 0.5f * static_cast<float>(here[right] - here[left]);
    const float gy = 0.5f * static_cast<float>(down[x] - up[x]);
    out.c2[x] = gx * gx - gy * gy;
    out.s2[x] = 2 * gx * gy;
    out.energy[x] = gx * gx + gy * gy;
  };
  put(0, 0, std::min(1, w - 1));
  for (int x = 1; x + 1 < w; ++x) put(x, x - 1, x + 1);
  if (w > 1) put(w - 1, w - 2, w - 1);
}

void orientation_tensor(image::ImageView picture, OrientationTensor& out) {
  for (image::Plane<float>* p : {&out.c2, &out.s2, &out.energy}) p->resize(picture.width(), picture.height());
  for (int y = 0; y < picture.height(); ++y)
    orientation_tensor_row(picture, y, {out.c2.row(y), out.s2.row(y), out.energy.row(y)});
}

void orientation_field(image::ImageView picture, OrientationField& out) {
  const int w = picture.width();
  const int h = picture.height();
  OrientationTensor t;
  orientation_tensor(picture, t);
  out.resize(2 * w, h);
  const auto blur = [&](const image::Plane<float>& p, int x, int y) {
    const int l = std::max(0, x - 1);
    const int r = std::min(w - 1, x + 1);
    const float* a = p.row(std::max(0, y - 1));
    const float* b = p.row(y);
    const float* c = p.row(std::min(h - 1, y + 1));
    return (a[l] + 2 * a[x] + a[r] + 2 * (b[l] + 2 * b[x] + b[r]) + c[l] + 2 * c[x] + c[r]) * (1.f / 16);
  };
  for (int y = 0; y < h; ++y) {
    std::int8_t* o = out.row(y);
    for (int x = 0; x < w; ++x) {
      const float k = 127.f / (blur(t.energy, x, y) + kEdgeGrey * kEdgeGrey);
      o[2 * x] = to_byte(k * blur(t.c2, x, y));
      o[2 * x + 1] = to_byte(k * blur(t.s2, x, y));
    }
  }
}

}  // namespace pickcell::matches
