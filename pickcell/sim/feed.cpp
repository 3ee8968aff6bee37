#include "pickcell/sim/feed.hpp"

#include <algorithm>
#include <stdexcept>
#include <utility>

namespace pickcell::sim {

Feed::Feed(FeedSettings settings, std::uint64_t seed) : settings_(std::move(settings)), random_(seed) {
  if (settings_.kinds.empty()) throw std::invalid_argument("a feed needs at least one kind of part");
  if (settings_.pitch_mm <= 0 || settings_.speed_mm_s <= 0 || settings_.relay_s <= 0 || settings_.parts_per_pitch < 0 ||
      (settings_.area_mm.size().array() <= 0).any())
    throw std::invalid_argument("area, pitch, speed and relay time of a feed must be positive");
  const Box2& area = settings_.area_mm;
  if (settings_.supply == Supply::table) {
    lay(area, 2 * settings_.parts_per_pitch);
    return;
  }
  for (double x = area.lo.x(); x + settings_.pitch_mm <= area.hi.x() + 1e-6; x += settings_.pitch_mm)
    lay({{x, area.lo.y()}, {x + settings_.pitch_mm, area.hi.y()}}, settings_.parts_per_pitch);
}

void Feed::lay(const Box2& region, int count) {
  std::vector<LaidPart> there;
  for (const FedPart& p : parts_) there.push_back(p.laid);
  const double offset = settings_.supply == Supply::belt ? base_mm_ : 0;
  const Box2 on_belt{region.lo - Point2(offset, 0), region.hi - Point2(offset, 0)};
  for (int i = 0; i < count; ++i) {
    const int kind = random_.integer(0, static_cast<int>(settings_.kinds.size()) - 1);
    LaidPart laid{&part_texture(settings_.kinds[static_cast<std::size_t>(kind)]), Point2::Zero(), 0, 1};
    if (!lay_at_random(laid, on_belt, there, settings_.gap_mm, random_)) continue;
    there.push_back(laid);
    parts_.push_back({next_id_++, laid, false});
  }
}

void Feed::advance(core::TimePoint t) {
  settle(t);
  if (moving(t)) return;
  base_mm_ = offset_mm(t);
  began_ = t;
  settled_ = false;
  if (settings_.supply == Supply::table) {
    missed_ += static_cast<int>(parts_.size());
    parts_.clear();
    ends_ = t + core::duration_s(settings_.relay_s);
    return;
  }
  ends_ = t + core::duration_s(settings_.pitch_mm / settings_.speed_mm_s);
  const Box2& area = settings_.area_mm;
  lay({{area.lo.x() - settings_.pitch_mm, area.lo.y()}, {area.lo.x(), area.hi.y()}}, settings_.parts_per_pitch);
}

double Feed::offset_mm(core::TimePoint t) const {
  if (settings_.supply == Supply::table || t < began_ || ends_ == began_) return base_mm_;
  const double done = core::seconds(t - began_) / core::seconds(ends_ - began_);
  return base_mm_ + settings_.pitch_mm * std::min(done, 1.0);
}

void Feed::settle(core::TimePoint t) {
  if (settled_ || t < ends_) return;
  settled_ = true;
  if (settings_.supply == Supply::table) return lay(settings_.area_mm, 2 * settings_.parts_per_pitch);
  leave_behind(settings_.area_mm.hi.x(), offset_mm(t));
}

void Feed::leave_behind(double beyond_x_mm, double offset) {
  for (FedPart& p : parts_) {
    if (p.missed || p.laid.at_mm.x() + offset <= beyond_x_mm) continue;
    p.missed = true;
    ++missed_;
  }
  // Still lying where a camera might see them; gone one pitch later.
  std::erase_if(parts_, [&](const FedPart& p) { return p.laid.at_mm.x() + offset > beyond_x_mm + settings_.pitch_mm; });
}

LaidPart Feed::on_plane(const FedPart& part, core::TimePoint t) const {
  LaidPart laid = part.laid;
  laid.at_mm.x() += offset_mm(t);
  return laid;
}

FedPart Feed::take(std::uint64_t id) {
  const auto found = std::find_if(parts_.begin(), parts_.end(), [&](const FedPart& p) { return p.id == id; });
  if (found == parts_.end()) throw std::invalid_argument("no such part on the feed");
  FedPart part = *found;
  parts_.erase(found);
  if (part.missed) --missed_;  // taken after all, beyond the area
  return part;
}

void Feed::put(std::uint64_t id, LaidPart on_plane, core::TimePoint t) {
  on_plane.at_mm.x() -= offset_mm(t);
  parts_.push_back({id, on_plane, false});
}

}  // namespace pickcell::sim
