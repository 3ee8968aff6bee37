#include "pickcell/matches/rst/robust.hpp"

namespace pickcell::matches {
namespace {

int turned(int angle_deg, int by_deg) { return ((angle_deg + by_deg) % 360 + 360) % 360; }

class Robust {
 public:
  Robust(const RobustSearch& how, const PlaceScore& score) : how_(how), score_(score) {}

  RobustResult everywhere(const RobustPlace& start) {
    const int side = 1 << how_.level;
    const int from = -(how_.alpha_deg / 2);
    for (int d = from; d < from + how_.alpha_deg; ++d) {
      RobustPlace p = start;
      p.angle_deg = turned(start.angle_deg, d);
      if (!allowed(p)) continue;
      for (p.scale = 0; p.scale < how_.scales; ++p.scale)
        for (p.y = start.y; p.y < start.y + side; ++p.y)
          for (p.x = start.x; p.x < start.x + side; ++p.x) consider(p);
    }
    return best_;
  }

  RobustResult in_sequence(const RobustPlace& start) {
    switch (how_.location) {
      case LocationSearch::halving:
        halving(start);
        break;
      case LocationSearch::quadrant:
        quadrant(start);
        break;
      case LocationSearch::symmetric:
        symmetric(start);
        break;
    }
    angle();
    scale();
    return best_;
  }

 private:
  void consider(const RobustPlace& p) {
    const WindowScore s = score_(p);
    ++best_.ncc_count;
    if (s.ncc > best_.ncc) {
      best_.place = p;
      best_.ncc = s.ncc;
      best_.inside = s.inside;
    }
  }

  [[nodiscard]] bool allowed(const RobustPlace& p) const {
    return how_.allowed_deg == nullptr || (*how_.allowed_deg)[static_cast<std::size_t>(p.angle_deg)];
  }

  /// The block is halved along x and y at once. A half is looked at in one place, and the places of both halves lie
  /// alike about the line between them: the nearer one's half holds the true place. That place serves the half in
  /// turn, so that each halving but the first costs three correlations. Places along one side of a block of 8: 2 and
  /// 5, then 1 and 2 or 5 and 6, then the pixel beside the better one.
  void halving(const RobustPlace& start) {
    int side = 1 << how_.level;
    RobustPlace corner = start;
    RobustPlace at = start;
    at.x += first_place(side);
    at.y += first_place(side);
    consider(at);
    for (; side > 1; side /= 2) {
      at = best_.place;
      const int other_x = 2 * corner.x + side - 1 - at.x;
      const int other_y = 2 * corner.y + side - 1 - at.y;
      consider({other_x, at.y, at.angle_deg, at.scale});
      consider({at.x, other_y, at.angle_deg, at.scale});
      consider({other_x, other_y, at.angle_deg, at.scale});
      if (best_.place.x >= corner.x + side / 2) corner.x += side / 2;
      if (best_.place.y >= corner.y + side / 2) corner.y += side / 2;
    }
  }

  /// The place that stands for the lower half of `side` pixels: of the two that serve that half in turn, the inner one.
  static int first_place(int side) { return side <= 2 ? 0 : side / 2 - 1 - first_place(side / 2); }

  void quadrant(const RobustPlace& start) {
    consider(start);
    for (int step = (1 << how_.level) / 2; step >= 1; step /= 2) {
      const RobustPlace from = best_.place;
      for (const auto& [dx, dy] : {std::pair{step, 0}, std::pair{0, step}, std::pair{step, step}})
        consider({from.x + dx, from.y + dy, from.angle_deg, from.scale});
    }
  }

  void symmetric(const RobustPlace& start) {
    const int half = (1 << how_.level) / 2;
    consider({start.x + half, start.y + half, start.angle_deg, start.scale});
    for (int step = half; step >= 1; step /= 2) {
      const RobustPlace from = best_.place;
      for (int dy = -step; dy <= step; dy += step)
        for (int dx = -step; dx <= step; dx += step)
          if (dx != 0 || dy != 0) consider({from.x + dx, from.y + dy, from.angle_deg, from.scale});
    }
  }

  /// The winner so far is measured again, as in the paper's count.
  void angle() {
    consider(best_.place);
    for (int d = first_angle_offset_deg(how_.alpha_deg); d >= 1; --d) {
      const RobustPlace from = best_.place;
      for (const int by : {-d, d}) {
        RobustPlace p = from;
        p.angle_deg = turned(from.angle_deg, by);
        if (allowed(p)) consider(p);
      }
    }
  }

  void scale() {
    RobustPlace p = best_.place;
    for (p.scale = 0; p.scale < how_.scales; ++p.scale) consider(p);
  }

  const RobustSearch& how_;
  const PlaceScore& score_;
  RobustResult best_;
};

}  // namespace

int first_angle_offset_deg(int alpha_deg) {
  int k = 1;
  while (k * (k + 1) < alpha_deg) ++k;
  return k;
}

RobustResult search_robustly(const RobustSearch& how, const RobustPlace& start, const PlaceScore& score) {
  Robust search(how, score);
  return how.variant == RstVariant::erst ? search.everywhere(start) : search.in_sequence(start);
}

}  // namespace pickcell::matches
