#include "pickcell/cell/gate.hpp"

#include <cmath>
#include <cstdio>

namespace pickcell::cell {

namespace {

/// Angles of a symmetry that differ less are the same one.
constexpr double kSameAngleDeg = 3;

bool own_symmetry(double offset_deg, int order) {
  return order > 1 && std::abs(std::remainder(offset_deg, 360.0 / order)) <= kSameAngleDeg;
}

}  // namespace

std::optional<Rejection> judge(const matches::Match& match, const matches::Model& model) {
  if (!(match.score >= model.learnt.suggested_min_score)) {
    char why[96];
    std::snprintf(why, sizeof why, "score %.2f is below the threshold %.2f", match.score,
                  model.learnt.suggested_min_score);
    return Rejection{"score", why};
  }
  if (!match.covariance.allFinite() || !(match.covariance.diagonal().head<3>().minCoeff() > 0))
    return Rejection{"uncertain", "nothing is known about how certain its place is"};
  return std::nullopt;
}

std::vector<double> open_ambiguities_deg(const matches::Match& match, const matches::Model& model) {
  std::vector<double> open;
  for (double offset_deg : match.ambiguous_deg)
    if (!own_symmetry(offset_deg, model.learnt.symmetry_order)) open.push_back(offset_deg);
  return open;
}

}  // namespace pickcell::cell
