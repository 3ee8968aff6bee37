#include "pickcell/matches/fit/edge_fit.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "pickcell/matches/fit/histogram_median.hpp"

namespace pickcell::matches {
namespace {

constexpr int kFewestObservations = 12;
constexpr float kLeastSpread_px = 0.08f;
constexpr float kBinsPerPixel = 64;    // residuals are at most some 3.5 pixels
constexpr float kAtRest_px = 1.5f;     // how far a settled contour looks
constexpr double kPointsPerSight = 2;  // neighbours see the same pixels: so many are one observation
constexpr double kRidge = 1.0005;
constexpr double kFewestClusters = 8;
constexpr double kAddedClusters = 10;
constexpr double kLeastFollowed = 0.3;
constexpr double kArrived_px = 0.02;  // of the rim: what a further iteration would change less than noise does

/// Looks for edges from one place; the number found.
int observe(image::ImageView image, const ContourPoints& points, const LevelMap& m, float reach_px, EdgeReading reading,
            ContourScratch& s) {
  const std::size_t room = points.x.size();
  for (auto* column : {&s.distance, &s.found, &s.weight, &s.nx, &s.ny, &s.turn, &s.growth, &s.residual})
    column->resize(room);
  find_edges(image, points.columns(), m, reach_px, reading, s.distance.data());
  const int n =
      make_lines(points.columns(), m,
                 {s.nx.data(), s.ny.data(), s.turn.data(), s.growth.data(), s.distance.data(), s.found.data()});
  s.weight = s.found;
  return n;
}

/// Movement in the scene: shift (dx, dy), turn (radians, counter-clockwise on the screen), growth.
using Movement = Eigen::Vector4d;

Eigen::Matrix4d normal_of(const LineColumns& lines, Movement& right) {
  float sums[14];
  sum_lines(lines, sums);
  Eigen::Matrix4d A;
  int k = 0;
  for (int a = 0; a < 4; ++a) {
    for (int b = a; b < 4; ++b) A(a, b) = A(b, a) = static_cast<double>(sums[k++]);
    right[a] = static_cast<double>(sums[10 + a]);
  }
  return A;
}

std::optional<Movement> solve(const LineColumns& lines) {
  Movement right;
  Eigen::Matrix4d A = normal_of(lines, right);
  A.diagonal() *= kRidge;  // round contours do not know their angle
  const Eigen::LDLT<Eigen::Matrix4d, Eigen::Lower> ldlt(A);
  if (ldlt.info() != Eigen::Success || !ldlt.isPositive()) return {};
  const Movement m = ldlt.solve(right);
  if (!m.allFinite()) return {};
  return m;
}

/// Tukey's biweight with its cut at three robust standard deviations of what was found.
void reweigh(const LineColumns& lines, const Movement& m, ContourScratch& s) {
  const float movement[4] = {static_cast<float>(m[0]), static_cast<float>(m[1]), static_cast<float>(m[2]),
                             static_cast<float>(m[3])};
  line_residuals(lines, movement, s.residual.data());
  HistogramMedian<256> sizes(kBinsPerPixel);
  for (std::size_t i = 0; i < static_cast<std::size_t>(lines.count); ++i)
    if (s.found[i] > 0) sizes.add(s.residual[i]);
  if (sizes.count() == 0) return;
  const float cut = 3 * std::max(kLeastSpread_px, 1.4826f * sizes.median());
  weigh_lines(s.residual.data(), s.found.data(), cut, lines.count, s.weight.data());
}

LineColumns lines_of(const ContourPoints& points, const ContourScratch& s) {
  return {s.nx.data(), s.ny.data(), s.turn.data(), s.growth.data(), s.distance.data(), s.weight.data(), points.count};
}

std::optional<Movement> solve_robust(const ContourPoints& points, ContourScratch& s) {
  constexpr int kRounds = 4;
  const LineColumns lines = lines_of(points, s);
  for (int round = 0;; ++round) {
    const auto m = solve(lines);
    if (!m || round + 1 == kRounds) return m;
    reweigh(lines, *m, s);
  }
}

/// What pulls at a fit that is at rest, cluster by cluster.
struct Scores {
  Eigen::Matrix4d scatter = Eigen::Matrix4d::Zero();  ///< sum of the clusters' scores squared
  double clusters = 0;
  double followed = 1;  ///< how much of a shift of all distances the weighted fit would follow: Tukey's weights fall
};

Scores scores_of(const RimPoints& rim, const Movement& rest, const ContourScratch& s) {
  Scores out;
  double weights = 0, follows = 0;
  for (std::size_t c = 0; c + 1 < rim.cluster_begin.size(); ++c) {
    Movement score = Movement::Zero();
    const auto end = static_cast<std::size_t>(rim.cluster_begin[c + 1]);
    for (auto i = static_cast<std::size_t>(rim.cluster_begin[c]); i < end; ++i) {
      const double w = static_cast<double>(s.weight[i]);
      const double near = std::sqrt(w);  // 1 - (residual / cut)^2
      const Movement row(static_cast<double>(s.nx[i]), static_cast<double>(s.ny[i]), static_cast<double>(s.turn[i]),
                         static_cast<double>(s.growth[i]));
      score += w * (static_cast<double>(s.distance[i]) - row.dot(rest)) * row;
      weights += w;
      follows += near * (5 * near - 4);
    }
    if (score.isZero(0)) continue;
    out.scatter += score * score.transpose();
    out.clusters += 1;
  }
  if (weights > 0) out.followed = std::max(kLeastFollowed, follows / weights);
  return out;
}

}  // namespace

void need_under(LazyField& scene, const EdgePoints& e, const LevelMap& m) {
  const PixelBox box = box_under(e.x_lo, e.x_hi, e.y_lo, e.y_hi, m);
  scene.need(box.x0, box.y0, box.x1, box.y1);
}

double edge_score(LazyField& scene, const EdgePoints& e, const LevelMap& m) {
  const image::View<std::int8_t> field = scene.view();
  if (field.width() < 4 || field.height() < 2 || e.count == 0) return 0;
  need_under(scene, e, m);
  return static_cast<double>(sum_edges(field, e.columns(), m) * e.norm / 127.f);
}

std::optional<Similarity> fit_contours(image::ImageView image, int level, const ContourPoints& points,
                                       const Similarity& start, const ContourSearch& search, ContourScratch& scratch) {
  const double k = std::ldexp(1.0, level);
  Similarity s = start;
  float reach = search.radius_px;
  for (int i = 0; i < search.iterations; ++i, reach *= 0.7f) {
    const int seen = observe(image, points, at_level(s, level), std::max(1.5f, reach),
                             i >= search.sharp ? EdgeReading::smooth : EdgeReading::plain, scratch);
    if (seen < kFewestObservations) return {};
    const auto m = solve_robust(points, scratch);
    if (!m) return {};
    s.x_px += k * (*m)[0];
    s.y_px += k * (*m)[1];
    s.angle_rad = wrap_rad(s.angle_rad + (*m)[2]);
    s.scale *= 1 + (*m)[3];
    const bool ran_away =
        std::hypot(s.x_px - start.x_px, s.y_px - start.y_px) > 4 * k + 4 || std::abs(s.scale / start.scale - 1) > 0.12;
    if (ran_away) return {};
    const double rim_px = static_cast<double>(points.radius) * std::hypot((*m)[2], (*m)[3]);
    const double moved_px = std::hypot((*m)[0], (*m)[1]) + rim_px;
    if (i == 0 && moved_px < search.least_px) return {};
    if (moved_px < kArrived_px) break;
  }
  return s;
}

std::optional<Eigen::Matrix4d> contour_covariance(image::ImageView picture, const ContourPoints& points,
                                                  const Similarity& place, ContourScratch& scratch) {
  if (observe(picture, points, at_level(place, 0), kAtRest_px, EdgeReading::plain, scratch) < kFewestObservations)
    return {};
  const auto rest = solve_robust(points, scratch);
  if (!rest) return {};
  const LineColumns lines = lines_of(points, scratch);
  const float movement[4] = {static_cast<float>((*rest)[0]), static_cast<float>((*rest)[1]),
                             static_cast<float>((*rest)[2]), static_cast<float>((*rest)[3])};
  line_residuals(lines, movement, scratch.residual.data());
  double weight = 0, square = 0;
  for (std::size_t i = 0; i < static_cast<std::size_t>(points.count); ++i) {
    const double w = static_cast<double>(scratch.weight[i]), r = static_cast<double>(scratch.residual[i]);
    weight += w;
    square += w * r * r;
  }
  if (weight <= kFewestObservations) return {};
  Movement unused;
  const Eigen::FullPivLU<Eigen::Matrix4d> lu(normal_of(lines, unused));
  if (!lu.isInvertible()) return {};
  const Eigen::Matrix4d covariance = lu.inverse() * (kPointsPerSight * square / (weight - 4));
  if (!covariance.allFinite() || (covariance.diagonal().array() <= 0).any()) return {};
  return covariance;
}

std::optional<Evidence> contour_evidence(image::ImageView picture, const RimPoints& rim, const Similarity& place,
                                         ContourScratch& scratch) {
  const ContourPoints& points = rim.points;
  if (observe(picture, points, at_level(place, 0), kAtRest_px, EdgeReading::exact, scratch) < kFewestObservations)
    return {};
  const auto movement = solve_robust(points, scratch);
  if (!movement) return {};
  Movement unused;
  const Eigen::Matrix4d normal = normal_of(lines_of(points, scratch), unused);
  Eigen::Matrix4d ridged = normal;
  ridged.diagonal() *= kRidge;
  const Eigen::LDLT<Eigen::Matrix4d> ldlt(ridged);
  const Scores scores = scores_of(rim, *movement, scratch);
  if (scores.clusters < kFewestClusters || ldlt.info() != Eigen::Success || !ldlt.isPositive()) return {};
  // Few clusters tell the scatter badly: some that scatter as much as they in the mean, alike in all directions, are
  // added.
  const Eigen::Matrix4d own = scores.scatter * (scores.clusters / (scores.clusters - 4));
  const double spread = ldlt.solve(own).trace() / 4;
  const Eigen::Matrix4d scatter =
      (scores.clusters * own + kAddedClusters * spread * ridged) / (scores.clusters + kAddedClusters);
  const Eigen::LDLT<Eigen::Matrix4d> of_scatter(scatter);
  if (of_scatter.info() != Eigen::Success || !of_scatter.isPositive()) return {};
  Evidence e;
  e.movement = *movement;
  e.information = normal * of_scatter.solve(normal) * (scores.followed * scores.followed);
  if (!e.information.allFinite()) return {};
  return e;
}

}  // namespace pickcell::matches
