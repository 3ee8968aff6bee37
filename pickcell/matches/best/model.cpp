#include "pickcell/matches/best/model.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace pickcell::matches {
namespace {

constexpr int kGreyPoints[] = {4096, 512, 256};  // level 0, between, coarsest
constexpr int kFewGreyPoints = 1024;             // level 0, to come near with
constexpr int kEdgePoints[] = {600, 400, 400};
constexpr int kContourPoints[] = {500, 200, 100};

LevelModel make_level(const TemplatePyramid& t, int level, int coarsest) {
  const int kind = level == 0 ? 0 : level == coarsest ? 2 : 1;
  GreyPoints grey = choose_grey_points(t, level, kGreyPoints[kind]);
  GreyPoints few;
  if (grey.size() >= 2 * kFewGreyPoints && !grey.flat()) few = choose_grey_points(t, level, kFewGreyPoints);
  return {std::move(grey), std::move(few), choose_edge_points(t, level, kEdgePoints[kind]),
          choose_contour_points(t, level, kContourPoints[kind])};
}

void set_box(BestModel& m) {
  const image::Plane<float>& c = m.pyramid.levels.front().coverage;
  int x0 = c.width(), x1 = -1, y0 = c.height(), y1 = -1;
  for (int y = 0; y < c.height(); ++y)
    for (int x = 0; x < c.width(); ++x) {
      if (c.at(x, y) < 0.5f) continue;
      x0 = std::min(x0, x);
      x1 = std::max(x1, x);
      y0 = std::min(y0, y);
      y1 = std::max(y1, y);
    }
  m.x_lo = x0 - 0.5 - m.pyramid.anchor_x_px;
  m.x_hi = x1 + 0.5 - m.pyramid.anchor_x_px;
  m.y_lo = y0 - 0.5 - m.pyramid.anchor_y_px;
  m.y_hi = y1 + 0.5 - m.pyramid.anchor_y_px;
}

}  // namespace

RotatedRect BestModel::outline(const Similarity& place) const {
  const auto at = [&](double x, double y) {
    const Pose2d p = pose_of(place, x, y);
    return std::array<double, 2>{p.x_px, p.y_px};
  };
  return {{at(x_lo, y_lo), at(x_hi, y_lo), at(x_hi, y_hi), at(x_lo, y_hi)}};
}

int start_level(const CoarseTemplates& t) { return std::max(0, std::ilogb(t.factor)); }

BestModel prepare_model(const Model& model, Range scale, const BestSettings& settings) {
  BestModel m;
  m.model = &model;
  m.scale = scale;
  m.pyramid = build_template_pyramid(model);
  m.quick = build_coarse_bands(m.pyramid, settings.quick.detail, scale);
  const int coarsest = std::min(start_level(m.quick.back()), static_cast<int>(m.pyramid.levels.size()) - 1);
  for (int l = 0; l <= coarsest; ++l) m.levels.push_back(make_level(m.pyramid, l, coarsest));
  m.final_points = choose_final_points(m.pyramid);
  m.side_px = std::sqrt(m.pyramid.area_px);
  m.ref_dx = model.ref_x_px - m.pyramid.anchor_x_px;
  m.ref_dy = model.ref_y_px - m.pyramid.anchor_y_px;
  set_box(m);
  return m;
}

}  // namespace pickcell::matches
