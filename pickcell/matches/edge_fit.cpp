#include "pickcell/matches/edge_fit.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>

#include "pickcell/matches/sampling.hpp"

namespace pickcell::matches {
namespace {

constexpr std::size_t kFewestObservations = 12;
constexpr float kLeastStep = 5.f;   // grey values over two samples
constexpr float kSample_px = 0.5f;  // spacing along the normal
constexpr int kMostSamples = 40;
using Observation = ContourScratch::Observation;

/// Grey values along the normal, every kSample_px, centred on the point.
struct Profile {
  std::array<float, kMostSamples> grey;
  int n;
  [[nodiscard]] float at_px(float i) const { return (i - static_cast<float>(n / 2)) * kSample_px; }
};

void read_profile(image::ImageView image, float x, float y, float nx, float ny, bool smooth, Profile& out) {
  for (int i = 0; i < out.n; ++i) {
    const float t = out.at_px(static_cast<float>(i));
    const float u = x + nx * t;
    const float v = y + ny * t;
    float g = bilinear(image, u, v);
    if (smooth) g = 0.5f * g + 0.25f * (bilinear(image, u - ny, v + nx) + bilinear(image, u + ny, v - nx));
    out.grey[static_cast<std::size_t>(i)] = g;
  }
}

/// Where the profile is steepest, preferring near places; none when it is flat or the edge lies beyond reach_px.
std::optional<float> steepest(const Profile& p, float reach_px) {
  std::array<float, kMostSamples> slope{};
  const auto g = [&](int i) { return p.grey[static_cast<std::size_t>(i)]; };
  for (int i = 2; i < p.n - 2; ++i)
    slope[static_cast<std::size_t>(i)] = std::abs(g(i + 1) - g(i - 1) + 0.5f * (g(i + 2) - g(i - 2)));
  const auto s = [&](int i) { return slope[static_cast<std::size_t>(i)]; };
  int best = -1;
  float best_value = 0;
  for (int i = 3; i < p.n - 3; ++i) {
    if (s(i) < s(i - 1) || s(i) < s(i + 1)) continue;
    const float value = s(i) * (1 - 0.5f * std::abs(p.at_px(static_cast<float>(i))) / (reach_px + 0.5f));
    if (value > best_value) {
      best = i;
      best_value = value;
    }
  }
  if (best < 0 || s(best) < kLeastStep) return {};
  const float bend = s(best - 1) + s(best + 1) - 2 * s(best);
  const float shift = bend < 0 ? 0.5f * (s(best - 1) - s(best + 1)) / bend : 0.f;
  const float t = p.at_px(static_cast<float>(best) + shift);
  if (std::abs(t) > reach_px) return {};
  return t;
}

void observe(image::ImageView image, const std::vector<ContourPoint>& points, const LevelMap& m, float scale,
             float reach_px, bool smooth, std::vector<Observation>& seen) {
  seen.clear();
  Profile profile{};
  profile.n = std::min(kMostSamples, 2 * static_cast<int>(std::ceil(reach_px / kSample_px)) + 7);
  const float far = static_cast<float>(profile.n / 2 + 1) * kSample_px + (smooth ? 1.f : 0.f);
  for (const ContourPoint& c : points) {
    const float rx = m.a * c.x + m.b * c.y;
    const float ry = -m.b * c.x + m.a * c.y;
    const float x = m.x + rx;
    const float y = m.y + ry;
    if (!inside(image, x - far, y - far) || !inside(image, x + far, y + far)) continue;
    const float nx = (m.a * c.nx + m.b * c.ny) / scale;
    const float ny = (-m.b * c.nx + m.a * c.ny) / scale;
    read_profile(image, x, y, nx, ny, smooth, profile);
    if (const auto t = steepest(profile, reach_px)) seen.push_back({*t, 1.f, nx, ny, rx, ry});
  }
}

/// Movement in the scene: shift (dx, dy), turn (radians, counter-clockwise on the screen), growth.
using Movement = Eigen::Vector4d;

/// Distance along the normal that a movement explains: derivatives.
Movement derivative(const Observation& o) { return {o.nx, o.ny, o.nx * o.ry - o.ny * o.rx, o.nx * o.rx + o.ny * o.ry}; }

std::optional<Movement> solve(const std::vector<Observation>& seen) {
  Eigen::Matrix4d A = Eigen::Matrix4d::Zero();
  Movement right = Movement::Zero();
  for (const Observation& o : seen) {
    const Movement row = derivative(o);
    A.selfadjointView<Eigen::Lower>().rankUpdate(row, o.weight);
    right += static_cast<double>(o.weight) * static_cast<double>(o.distance) * row;
  }
  A.diagonal() *= 1.0005;  // round contours do not know their angle
  const Eigen::LDLT<Eigen::Matrix4d, Eigen::Lower> ldlt(A);
  if (ldlt.info() != Eigen::Success || !ldlt.isPositive()) return {};
  const Movement m = ldlt.solve(right);
  if (!m.allFinite()) return {};
  return m;
}

std::optional<Movement> solve_robust(ContourScratch& scratch) {
  constexpr int kRounds = 4;
  for (int round = 0;; ++round) {
    const auto m = solve(scratch.seen);
    if (!m || round + 1 == kRounds) return m;
    scratch.absolute.clear();
    for (const Observation& o : scratch.seen)
      scratch.absolute.push_back(std::abs(o.distance - static_cast<float>(derivative(o).dot(*m))));
    std::vector<float> sorted = scratch.absolute;
    const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2);
    std::nth_element(sorted.begin(), middle, sorted.end());
    const float cut = 3 * std::max(0.08f, 1.4826f * *middle);
    for (std::size_t i = 0; i < scratch.seen.size(); ++i) {
      const float u = 1 - scratch.absolute[i] / cut * (scratch.absolute[i] / cut);
      scratch.seen[i].weight = u > 0 ? u * u : 0.f;
    }
  }
}

}  // namespace

double edge_score(const OrientationField& scene, const EdgePoints& e, const LevelMap& m) {
  if (scene.width() < 4 || scene.height() < 2 || e.count == 0) return 0;
  return static_cast<double>(sum_edges(scene.view(), e.columns(), m) * e.norm / 127.f);
}

std::optional<Similarity> fit_contours(image::ImageView image, int level, const std::vector<ContourPoint>& points,
                                       const Similarity& start, const ContourSearch& search, ContourScratch& scratch) {
  const double k = std::ldexp(1.0, level);
  Similarity s = start;
  float reach = search.radius_px;
  for (int i = 0; i < search.iterations; ++i, reach *= 0.7f) {
    observe(image, points, at_level(s, level), static_cast<float>(s.scale), std::max(1.5f, reach), search.smooth,
            scratch.seen);
    if (scratch.seen.size() < kFewestObservations) return {};
    const auto m = solve_robust(scratch);
    if (!m) return {};
    s.x_px += k * (*m)[0];
    s.y_px += k * (*m)[1];
    s.angle_rad = wrap_rad(s.angle_rad + (*m)[2]);
    s.scale *= 1 + (*m)[3];
    const bool ran_away =
        std::hypot(s.x_px - start.x_px, s.y_px - start.y_px) > 4 * k + 4 || std::abs(s.scale / start.scale - 1) > 0.12;
    if (ran_away) return {};
  }
  return s;
}

}  // namespace pickcell::matches
