#include "pickcell/matches/learn/symmetry.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <span>
#include <vector>

#include "pickcell/image/pyramid.hpp"
#include "pickcell/matches/learn/period_share.hpp"
#include "pickcell/matches/learn/turned_rest.hpp"

namespace pickcell::matches {

namespace {

constexpr double kMaxRadius_px = 200;    ///< of the working level
constexpr double kCentreRadius_px = 40;  ///< of the level where the centre is looked for
constexpr int kMostOrder = 60;
constexpr double kSame = 0.05;  ///< of the variance, may differ
constexpr double kNearlySame = 0.1;
constexpr double kMark_px = 8;      ///< area
constexpr double kHopeless = 0.3;   ///< seen small already, where no fine detail tells turns apart
constexpr double kCompared = 0.72;  ///< of a picture without ground, as its disc is pi/4
constexpr double kCentred_px = 0.03;
constexpr int kLeastSide_px = 8;
constexpr double kMargin_px = 3;
constexpr int kAround_px = 16;
constexpr double kExplained = 0.6;  ///< of what changes with the angle, by the period and not by chance
constexpr int kRounds = 6;          ///< of finding the centre, small
constexpr int kFineRounds = 2;      ///< and at the working level
constexpr int kAny = 0;
constexpr int kCentring[] = {kAny, 2, 3, 5, 7};  ///< periods that tell the centre of nearly all

/// The template at halved sizes.
class Levels {
 public:
  Levels(image::ImageView picture, image::ImageView mask) : masked_(!mask.empty()) {
    pictures_.build(picture, kLeastSide_px / 2);
    if (masked_) masks_.build(mask, kLeastSide_px / 2);
  }
  [[nodiscard]] PartPicture at(int level) const {
    return make_part_picture(pictures_.level(level), masked_ ? masks_.level(level) : image::ImageView());
  }
  /// The finest from `first` on at which so large a radius is at most so long, if there is one.
  [[nodiscard]] int where(double radius_px, double most_px, int first) const {
    int level = std::min(first, pictures_.levels() - 1);
    while (level + 1 < pictures_.levels() && std::ldexp(radius_px, -level) > most_px) ++level;
    return level;
  }

 private:
  bool masked_;
  image::Pyramid pictures_, masks_;
};

PartPicture::Point moved(PartPicture::Point p, int from_level, int to_level) {
  const double scale = std::ldexp(1.0, from_level - to_level);
  return {(p.x + 0.5) * scale - 0.5, (p.y + 0.5) * scale - 0.5};
}

/// Leaves of a masked picture the part and a margin.
void cut_to_part(image::ImageView& picture, image::ImageView& mask) {
  int left = mask.width(), top = mask.height(), right = -1, bottom = -1;
  for (int y = 0; y < mask.height(); ++y)
    for (int x = 0; x < mask.width(); ++x)
      if (mask.at(x, y) >= 128) {
        left = std::min(left, x);
        right = std::max(right, x);
        top = std::min(top, y);
        bottom = y;
      }
  left = std::max(0, left - kAround_px);
  top = std::max(0, top - kAround_px);
  const int width = std::max(0, std::min(mask.width(), right + 1 + kAround_px) - left);
  const int height = std::max(0, std::min(mask.height(), bottom + 1 + kAround_px) - top);
  picture = picture.crop(left, top, width, height);
  mask = mask.crop(left, top, width, height);
}

struct Centred {
  PartPicture::Point centre;
  double unlike = 1;  ///< of the turns that agree best
  double off_px = 0;  ///< what was left to go
  int period = kAny;  ///< of those turns
};

Rings rings_of(const PartPicture& part, PartPicture::Point centre) {
  return Rings(part, centre.x, centre.y, part.radius(centre) + kMargin_px);
}

/// The centre about which one of some turns agrees best, from a start.
Centred centred(const PartPicture& part, PartPicture::Point start, int rounds, std::span<const int> periods) {
  Centred out{start};
  for (int i = 0;; ++i) {
    const Rings rings = rings_of(part, out.centre);
    double dx = 0, dy = 0;
    out.unlike = 2;
    for (const int period : periods) {
      const TurnedRest turned = compare_turns(rings, part, period);
      const double unlike = turned.compared < kCompared ? 1 : turned.unlike + turned.uncovered;
      if (unlike >= out.unlike) continue;
      out.unlike = unlike;
      out.period = period;
      dx = turned.dx;
      dy = turned.dy;
    }
    out.off_px = std::hypot(dx, dy);
    if (i == rounds || out.off_px < kCentred_px || !(out.off_px < 0.5 * rings.rings())) return out;
    const double by = std::min(1.0, std::max(2.0, 0.1 * rings.rings()) / out.off_px);
    out.centre = {out.centre.x + by * dx, out.centre.y + by * dy};
  }
}

/// What is known of each period about one centre, found when it is asked for.
class Judge {
 public:
  Judge(const Rings& rings, const PartPicture& part) : rings_(rings), part_(part) {}

  const TurnedRest& at(int period) {
    auto& slot = known_[static_cast<std::size_t>(period)];
    if (!slot) {
      slot = compare_turns(rings_, part_, period);
      if (period != kAny) slot->rest.clear();
    }
    return *slot;
  }
  bool same(int period) { return nearly_same(period, kSame) && at(period).mark_px < kMark_px; }
  bool nearly_same(int period, double unlike) {
    return at(period).compared >= kCompared && likeness(period) >= 1 - unlike;
  }
  double likeness(int period) { return (1 - at(period).unlike) * (1 - at(period).uncovered); }

  /// Periods under which the part passes, kAny among them as 0.
  template <class Passes>
  std::vector<int> passing(Passes passes) {
    std::vector<int> out;
    if (passes(kAny)) {
      out.push_back(kAny);
      for (int k = 2; k <= kMostOrder; ++k) out.push_back(k);
      return out;
    }
    std::array<bool, kMostOrder + 1> failed{};
    for (int k = 2; k <= kMostOrder; ++k) {
      for (int d = 2; d < k && !failed[static_cast<std::size_t>(k)]; ++d)
        if (k % d == 0) failed[static_cast<std::size_t>(k)] = failed[static_cast<std::size_t>(d)];
      if (failed[static_cast<std::size_t>(k)]) continue;
      if (passes(k))
        out.push_back(k);
      else
        failed[static_cast<std::size_t>(k)] = true;
    }
    return out;
  }

  std::vector<double> explained() { return period_shares(rings_, part_, at(kAny).rest, kMostOrder); }

 private:
  const Rings& rings_;
  const PartPicture& part_;
  std::array<std::optional<TurnedRest>, kMostOrder + 1> known_;
};

/// A single mark has all harmonics alike, and so 1/k of its changes any period k.
double least_explained(int k) { return 1.0 / k + kExplained * (1 - 1.0 / k); }

/// Of the periods that pass, the longest that is seen in what changes with the angle; any angle, where it passes and
/// no period is seen.
int chosen(const std::vector<int>& passing, const std::vector<double>& explained) {
  if (passing.empty()) return 1;
  int best = 1;
  for (const int k : passing)
    if (k != kAny && explained[static_cast<std::size_t>(k)] >= least_explained(k)) best = std::max(best, k);
  if (best > 1) return best;
  return passing.front() == kAny ? kAnyAngle : passing.back();
}

/// Of the likely centres that about which the part agrees best.
Centred first_centre(const PartPicture& part, const std::array<PartPicture::Point, 2>& starts) {
  Centred found = centred(part, starts[0], kRounds, kCentring);
  if (part.masked) return found;
  const Centred other = centred(part, starts[1], kRounds, kCentring);
  return other.unlike + other.off_px < found.unlike + found.off_px ? other : found;
}

Symmetry judged(const Rings& rings, const PartPicture& part, const std::vector<int>& likely) {
  Judge judge(rings, part);
  const auto hopeful = [&](int k) { return std::find(likely.begin(), likely.end(), k) != likely.end(); };
  const auto same = judge.passing([&](int k) { return hopeful(k) && judge.same(k); });
  const auto nearly = judge.passing([&](int k) { return hopeful(k) && judge.nearly_same(k, kNearlySame); });
  if (nearly.empty()) return {};
  const auto explained = judge.explained();
  Symmetry out;
  out.order = chosen(same, explained);
  out.nearly = chosen(nearly, explained);
  if (out.nearly > 1) out.nearly_likeness = judge.likeness(out.nearly == kAnyAngle ? kAny : out.nearly);
  return out;
}

}  // namespace

Symmetry find_symmetry(image::ImageView picture, image::ImageView mask) {
  if (!mask.empty()) cut_to_part(picture, mask);
  if (picture.width() < kLeastSide_px || picture.height() < kLeastSide_px) return {};
  const Levels levels(picture, mask);
  const int first = levels.where(std::hypot(picture.width(), picture.height()) / 2, 4 * kMaxRadius_px, 0);
  const PartPicture whole = levels.at(first);
  auto starts = whole.likely_centres();
  const double radius = std::ldexp(whole.radius(starts[0]), first);
  const int level = levels.where(radius, kMaxRadius_px, first), coarse = levels.where(radius, kCentreRadius_px, first);
  for (PartPicture::Point& start : starts) start = moved(start, first, coarse);

  const PartPicture small = coarse > first ? levels.at(coarse) : whole;
  const Centred found = first_centre(small, starts);
  const Rings small_rings = rings_of(small, found.centre);
  Judge small_judge(small_rings, small);
  const auto likely = small_judge.passing([&](int k) { return small_judge.nearly_same(k, kHopeless); });
  if (likely.empty()) return {};

  const PartPicture part = level > first ? levels.at(level) : whole;
  const int period[] = {found.period};
  const PartPicture::Point centre = centred(part, moved(found.centre, coarse, level), kFineRounds, period).centre;
  return judged(rings_of(part, centre), part, likely);
}

}  // namespace pickcell::matches
