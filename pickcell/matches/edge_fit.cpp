#include "pickcell/matches/edge_fit.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <algorithm>
#include <cmath>

namespace pickcell::matches {
namespace {

constexpr std::size_t kFewestObservations = 12;
using Observation = ContourScratch::Observation;

void observe(image::ImageView image, const ContourPoints& points, const LevelMap& m, float reach_px, bool smooth,
             ContourScratch& scratch) {
  scratch.distance.resize(points.x.size());
  find_edges(image, points.columns(), m, reach_px, smooth, scratch.distance.data());
  scratch.seen.clear();
  const float unit = 1 / std::hypot(m.a, m.b);
  for (std::size_t i = 0; i < static_cast<std::size_t>(points.count); ++i) {
    if (scratch.distance[i] == kNoEdge) continue;
    scratch.seen.push_back({scratch.distance[i], 1.f, unit * (m.a * points.nx[i] + m.b * points.ny[i]),
                            unit * (m.a * points.ny[i] - m.b * points.nx[i]), m.a * points.x[i] + m.b * points.y[i],
                            m.a * points.y[i] - m.b * points.x[i]});
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
    for (int a = 0; a < 4; ++a)
      for (int b = 0; b <= a; ++b) A(a, b) += static_cast<double>(o.weight) * row[a] * row[b];
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

std::optional<Similarity> fit_contours(image::ImageView image, int level, const ContourPoints& points,
                                       const Similarity& start, const ContourSearch& search, ContourScratch& scratch) {
  const double k = std::ldexp(1.0, level);
  Similarity s = start;
  float reach = search.radius_px;
  for (int i = 0; i < search.iterations; ++i, reach *= 0.7f) {
    observe(image, points, at_level(s, level), std::max(1.5f, reach), search.smooth, scratch);
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
