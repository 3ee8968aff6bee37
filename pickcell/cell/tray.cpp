#include "pickcell/cell/tray.hpp"

namespace pickcell::cell {

namespace {

/// A failed grasp may push the part a little; neighbours are further apart.
constexpr double kSamePlaceM = 0.008;
constexpr double kSamePlacePx = 15;

}  // namespace

int StandingParts::attempts(const std::string& model, const Eigen::Vector2d& p_m) const {
  const auto places = attempts_.find(model);
  if (places == attempts_.end()) return 0;
  for (const Place& place : places->second)
    if ((place.p - p_m).norm() <= kSamePlaceM) return place.count;
  return 0;
}

void StandingParts::note_attempt(const std::string& model, const Eigen::Vector2d& p_m) {
  ++find(attempts_[model], p_m, kSamePlaceM).count;
}

bool StandingParts::first_rejection(const std::string& model, const std::string& code, const Eigen::Vector2d& p_px) {
  return ++find(rejected_[model + "/" + code], p_px, kSamePlacePx).count == 1;
}

StandingParts::Place& StandingParts::find(std::vector<Place>& places, const Eigen::Vector2d& p, double radius) {
  for (Place& place : places)
    if ((place.p - p).norm() <= radius) return place;
  return places.emplace_back(Place{p, 0});
}

}  // namespace pickcell::cell
