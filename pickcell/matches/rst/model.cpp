#include "pickcell/matches/rst/model.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>

#include "pickcell/matches/rst/smooth.hpp"
#include "pickcell/matches/similarity.hpp"

namespace pickcell::matches {
namespace {

constexpr std::size_t kLeastCircles = 3;

int middle(int size) { return (size - 1) / 2; }

/// The template at one scale, its anchor at (reach, reach), continued beyond its border.
image::Image scaled(image::ImageView t, int anchor_x, int anchor_y, double scale, int reach) {
  image::Image out(2 * reach + 1, 2 * reach + 1);
  for (int y = 0; y < out.height(); ++y)
    for (int x = 0; x < out.width(); ++x) {
      const double u = std::clamp(anchor_x + (x - reach) / scale, 0.0, t.width() - 1.0);
      const double v = std::clamp(anchor_y + (y - reach) / scale, 0.0, t.height() - 1.0);
      const int i = std::min(static_cast<int>(u), t.width() - 2), j = std::min(static_cast<int>(v), t.height() - 2);
      const double fx = u - i, fy = v - j;
      const double up = t.at(i, j) + fx * (t.at(i + 1, j) - t.at(i, j));
      const double down = t.at(i, j + 1) + fx * (t.at(i + 1, j + 1) - t.at(i, j + 1));
      out.at(x, y) = static_cast<std::uint8_t>(up + fy * (down - up) + 0.5);
    }
  return out;
}

/// Features of the lists about the middle of a picture.
std::vector<float> features(const image::Image& picture, int reach, const PixelLists& lists) {
  const OffsetLists offsets = offsets_for(lists, picture.stride());
  std::vector<float> block(static_cast<std::size_t>(lists.lists()) * kRstBlock);
  mean_lists(picture.row(reach) + reach, offsets, 1, block.data(), kRstBlock);
  std::vector<float> out;
  for (int k = 0; k < lists.lists(); ++k) out.push_back(block[static_cast<std::size_t>(k) * kRstBlock]);
  return out;
}

/// Centred, of length 1; empty when there is no contrast.
std::vector<float> normalised(std::vector<float> q) {
  const float mean = std::accumulate(q.begin(), q.end(), 0.f) / static_cast<float>(q.size());
  float square = 0;
  for (float& v : q) {
    v -= mean;
    square += v * v;
  }
  if (square < 1e-2f * static_cast<float>(q.size())) return {};
  for (float& v : q) v /= std::sqrt(square);
  return q;
}

core::Status refuse(const Model& model, const std::string& why, const std::string& remedy) {
  return core::failure(core::ErrorCode::usage, "model " + model.name, why, remedy);
}

class Training {
 public:
  Training(RstModel& m, const RstSettings& settings) : m_(m), settings_(settings) {
    image::Pyramid boxes;
    boxes.build(m.model->picture.view(), 4);
    m.coarse_grey = image::Image(CoarsePicture().make(boxes, m.level, settings));
    t_ = m.coarse_grey.view();
    cx_ = middle(t_.width());
    cy_ = middle(t_.height());
  }

  core::Status run() {
    set_anchor();
    const int side = std::min(t_.width(), t_.height());
    m_.margin = static_cast<int>(std::floor((side * m_.scales.back() - 1) / 2));
    m_.radii = circle_radii(m_.margin, settings_.circles);
    m_.circles = circle_lists(m_.radii);
    for (const double s : m_.scales) pictures_.push_back(scaled(t_, cx_, cy_, s, m_.margin));
    if (auto done = rings(side); !done) return done;
    radials(side);
    windows();
    return {};
  }

 private:
  void set_anchor() {
    const double block = std::ldexp(1.0, m_.level);
    m_.anchor_x = block * cx_ + (block - 1) / 2;
    m_.anchor_y = block * cy_ + (block - 1) / 2;
    m_.pixel_x = static_cast<int>(m_.anchor_x);
    m_.pixel_y = static_cast<int>(m_.anchor_y);
    m_.ref_dx = m_.model->ref_x_px - m_.anchor_x;
    m_.ref_dy = m_.model->ref_y_px - m_.anchor_y;
  }

  core::Status rings(int side) {
    m_.rings.negative = settings_.match_negative;
    for (std::size_t n = 0; n < m_.scales.size(); ++n) {
      std::vector<float> q = features(pictures_[n], m_.margin, m_.circles);
      const double fits = (side * m_.scales[n] - 1) / 2;
      q.resize(static_cast<std::size_t>(std::upper_bound(m_.radii.begin(), m_.radii.end(), fits) - m_.radii.begin()));
      if (q.size() < kLeastCircles)
        return refuse(*m_.model,
                      "at pyramid level " + std::to_string(m_.level) + " only " + std::to_string(q.size()) +
                          " circles fit into it",
                      "set NP lower, or use a larger template");
      m_.ring_means.push_back(q);
      m_.rings.q.push_back(normalised(std::move(q)));
      if (m_.rings.q.back().empty())
        return refuse(*m_.model, "all its circles have the same brightness: the circular filter sees nothing",
                      "use --engine best, or another part of the picture as template");
    }
    return {};
  }

  void radials(int side) {
    m_.lines = 360 / settings_.angle_step_deg;
    const bool matched = settings_.radial_length == RadialLength::matched;
    for (std::size_t n = matched ? 0 : m_.scales.size() - 1; n < m_.scales.size(); ++n) {
      const int length = static_cast<int>(std::floor((side * m_.scales[n] - 1) / 2));
      RstRadial r;
      r.lines = line_lists(m_.lines, length);
      r.query = make_radial_query(features(pictures_[n], m_.margin, r.lines));
      m_.radials.push_back(std::move(r));
    }
  }

  [[nodiscard]] WindowSource source(int level, image::ImageView grey, double anchor_x, double anchor_y) const {
    const TemplateLevel& l = m_.pyramid.levels[static_cast<std::size_t>(level)];
    return {grey, m_.pyramid.masked ? l.coverage.view() : image::View<float>(), anchor_x, anchor_y, settings_.mask};
  }

  void windows() {
    for (const double s : m_.scales)
      for (int shift = 0; shift < m_.lines; ++shift)
        m_.coarse.push_back(make_window(source(m_.level, t_, cx_, cy_), shift * settings_.angle_step_deg, s));
    m_.fine = std::make_unique<WindowCache>(source(0, m_.pyramid.levels.front().grey.view(), m_.pixel_x, m_.pixel_y),
                                            m_.scales);
  }

  RstModel& m_;
  const RstSettings& settings_;
  image::ImageView t_;
  int cx_ = 0, cy_ = 0;
  std::vector<image::Image> pictures_;
};

}  // namespace

WindowCache::WindowCache(WindowSource source, std::vector<double> scales)
    : source_(source), scales_(std::move(scales)), slot_(360 * scales_.size()) {}

const Window& WindowCache::get(int angle_deg, int scale) {
  std::atomic<const Window*>& slot = slot_[static_cast<std::size_t>(scale * 360 + angle_deg)];
  if (const Window* made = slot.load(std::memory_order_acquire)) return *made;
  Window fresh = make_window(source_, angle_deg, scales_[static_cast<std::size_t>(scale)]);
  const std::lock_guard lock(guard_);
  if (const Window* made = slot.load(std::memory_order_relaxed)) return *made;
  bytes_ += fresh.bytes();
  made_.push_back(std::move(fresh));
  slot.store(&made_.back(), std::memory_order_release);
  return made_.back();
}

void WindowCache::drop() {
  for (auto& slot : slot_) slot.store(nullptr, std::memory_order_relaxed);
  made_.clear();
  bytes_ = 0;
}

Pose2d RstModel::pose(double x, double y, double angle_deg, double scale_factor) const {
  return pose_of({x, y, angle_deg / kDegPerRad, scale_factor}, ref_dx, ref_dy);
}

Pose2d RstModel::window_pose(int x, int y, double angle_deg, double scale_factor) const {
  const double dx = model->ref_x_px - pixel_x, dy = model->ref_y_px - pixel_y;
  return pose_of({static_cast<double>(x), static_cast<double>(y), angle_deg / kDegPerRad, scale_factor}, dx, dy);
}

RotatedRect RstModel::outline(const Pose2d& pose) const {
  const Similarity s = similarity_of(pose, ref_dx, ref_dy);
  const double left = -0.5 - anchor_x, right = pyramid.width() - 0.5 - anchor_x;
  const double top = -0.5 - anchor_y, bottom = pyramid.height() - 0.5 - anchor_y;
  const auto at = [&](double x, double y) {
    const Pose2d p = pose_of(s, x, y);
    return std::array<double, 2>{p.x_px, p.y_px};
  };
  return {{at(left, top), at(right, top), at(right, bottom), at(left, bottom)}};
}

core::Result<std::unique_ptr<RstModel>> prepare_rst_model(const Model& model, Range scale,
                                                          const RstSettings& settings) {
  auto m = std::make_unique<RstModel>();
  m->model = &model;
  m->scale = scale;
  m->scales = settings.scales.value_or(scales_for(scale, settings.scale_count));
  m->level = settings.pyramid_level.value_or(pyramid_level_for(model.picture.width(), model.picture.height()));
  m->pyramid = build_template_pyramid(model);
  if (m->level >= static_cast<int>(m->pyramid.levels.size())) {
    auto too_small = refuse(model, "it is too small for pyramid level " + std::to_string(m->level),
                            "set NP lower, or use a larger template");
    return core::forward(too_small);
  }
  if (auto done = Training(*m, settings).run(); !done) return core::forward(done);
  return m;
}

}  // namespace pickcell::matches
