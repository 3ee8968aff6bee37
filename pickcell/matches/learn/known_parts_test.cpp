#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "pickcell/matches/learn/known_parts.hpp"
#include "pickcell/matches/learn/self_match.hpp"

namespace pickcell::matches::testing {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr int kSuper = 4;

/// Convolution with a Gaussian, first along rows, then along columns; the border value goes on.
void blur(image::Plane<float>& picture, double sigma) {
  if (sigma <= 0) return;
  const int reach = static_cast<int>(std::ceil(4 * sigma));
  std::vector<double> weights;
  double sum = 0;
  for (int i = -reach; i <= reach; ++i) {
    weights.push_back(std::exp(-i * i / (2 * sigma * sigma)));
    sum += weights.back();
  }
  const int w = picture.width(), h = picture.height();
  image::Plane<float> along(w, h);
  const auto pass = [&](const image::Plane<float>& from, image::Plane<float>& to, int dx, int dy) {
    for (int y = 0; y < h; ++y)
      for (int x = 0; x < w; ++x) {
        double v = 0;
        for (int i = -reach; i <= reach; ++i)
          v += weights[static_cast<std::size_t>(i + reach)] *
               static_cast<double>(from.at(std::clamp(x + i * dx, 0, w - 1), std::clamp(y + i * dy, 0, h - 1)));
        to.at(x, y) = static_cast<float>(v / sum);
      }
  };
  pass(picture, along, 1, 0);
  pass(along, picture, 0, 1);
}

std::uint8_t to_grey(double v) { return static_cast<std::uint8_t>(std::clamp(std::lround(v), 0L, 255L)); }

/// 255 where a pixel of the mask is within reach.
image::Image grown(const image::Image& mask, int reach) {
  image::Image out(mask.width(), mask.height());
  for (int y = 0; y < out.height(); ++y)
    for (int x = 0; x < out.width(); ++x) {
      bool on = false;
      for (int j = -reach; j <= reach && !on; ++j)
        for (int i = -reach; i <= reach && !on; ++i)
          if (i * i + j * j <= reach * reach && x + i >= 0 && y + j >= 0 && x + i < mask.width() &&
              y + j < mask.height())
            on = mask.at(x + i, y + j) != 0;
      out.at(x, y) = on ? 255 : 0;
    }
  return out;
}

}  // namespace

KnownPart polygon_part(int corners, double bore) {
  const double inner = std::cos(kPi / corners);
  return {"polygon" + std::to_string(corners),
          [=](double x, double y) {
            const double r = std::hypot(x, y), a = std::atan2(y, x), sector = 2 * kPi / corners;
            const double to_side = r * std::cos(std::remainder(a, sector));
            return to_side <= inner && r > bore ? 1.0 : 0.0;
          },
          corners, 2.5 * (1 - inner), corners};
}

KnownPart gear_part(int teeth, double depth, double bore) {
  return {"gear" + std::to_string(teeth),
          [=](double x, double y) {
            const double r = std::hypot(x, y), rim = std::cos(teeth * std::atan2(y, x)) > 0 ? 1 : 1 - depth;
            return r <= rim && r > bore ? 1.0 : 0.0;
          },
          teeth, 2 * kPi * (1 - depth / 2) / teeth, teeth};
}

KnownPart annulus_part(double bore) {
  return {bore > 0 ? "annulus" : "disc",
          [=](double x, double y) {
            const double r = std::hypot(x, y);
            return r <= 1 && r > bore ? 1.0 : 0.0;
          },
          kAnyAngle, 1, kAnyAngle};
}

KnownPart star_part(int points) {
  return {"star" + std::to_string(points),
          [=](double x, double y) {
            const double r = std::hypot(x, y), a = std::atan2(y, x);
            return r <= 0.7 + 0.3 * std::cos(points * a) ? 1.0 : 0.0;
          },
          points, 2 * kPi * 0.7 / points, points};
}

KnownPart rectangle_part(double aspect) {
  const double long_half = aspect / std::hypot(1, aspect), short_half = 1 / std::hypot(1, aspect);
  return {"rectangle",
          [=](double x, double y) { return std::abs(x) <= long_half && std::abs(y) <= short_half ? 1.0 : 0.0; }, 2,
          long_half - short_half, 2};
}

KnownPart ellipse_part(double aspect) {
  return {"ellipse", [=](double x, double y) { return std::hypot(x, y * aspect) <= 1 ? 1.0 : 0.0; }, 2, 1 - 1 / aspect,
          2};
}

KnownPart s_part() {
  return {"s",
          [](double x, double y) {
            const bool bar = std::abs(y) < 0.15 && std::abs(x) < 0.8;
            const bool arm = std::abs(x - 0.65) < 0.15 && y > -0.15 && y < 0.55;
            const bool other = std::abs(x + 0.65) < 0.15 && y < 0.15 && y > -0.55;
            return bar || arm || other ? 1.0 : 0.0;
          },
          2, 0.4, 2};
}

KnownPart l_part() {
  return {"l",
          [](double x, double y) {
            const bool one = std::abs(x + 0.4) < 0.2 && std::abs(y) < 0.7;
            const bool two = std::abs(y - 0.5) < 0.2 && x > -0.6 && x < 0.6;
            return (one || two) && std::hypot(x + 0.4, y + 0.45) > 0.1 ? 1.0 : 0.0;
          },
          1, 0.3, 1};
}

KnownPart spoked_part(int spokes) {
  return {"wheel" + std::to_string(spokes),
          [=](double x, double y) {
            const double r = std::hypot(x, y), a = std::atan2(y, x);
            if (r > 1) return 0.0;
            const double off = r * std::abs(std::sin(std::remainder(a, 2 * kPi / spokes)));
            return r > 0.82 || r < 0.25 || off < 0.07 ? 1.0 : 0.25;
          },
          spokes, 2 * kPi * 0.5 / spokes, spokes};
}

KnownPart with_keyway(KnownPart part, double bore, double width, double depth) {
  part.name += "+keyway";
  part.grey = [whole = part.grey, bore, width, depth](double x, double y) {
    return x > 0 && x < bore + depth && std::abs(y) < width / 2 ? 0.0 : whole(x, y);
  };
  part.order = 1;
  part.finest = std::min(width, depth);
  return part;
}

KnownPart with_notch(KnownPart part, double width, double depth) {
  part.name += "+notch";
  part.grey = [whole = part.grey, width, depth](double x, double y) {
    return x > 1 - depth && std::abs(y) < width / 2 ? 0.0 : whole(x, y);
  };
  part.order = 1;
  part.finest = std::min(width, depth);
  return part;
}

KnownPart with_dot(KnownPart part, double at_radius, double radius, double grey) {
  part.name += "+dot";
  part.grey = [whole = part.grey, at_radius, radius, grey](double x, double y) {
    return std::hypot(x - at_radius, y) < radius ? grey : whole(x, y);
  };
  part.order = 1;
  part.finest = 2 * radius;
  return part;
}

Photo photograph(const KnownPart& part, const Shot& shot) {
  const int side =
      static_cast<int>(2 * (shot.radius_px + std::max(std::abs(shot.off_x_px), std::abs(shot.off_y_px))) + 9);
  image::Plane<float> exact(side, side);
  image::Image outline(side, side);
  const double middle = (side - 1) / 2.0, a = shot.turn_deg * kPi / 180, c = std::cos(a), s = std::sin(a);
  for (int y = 0; y < side; ++y)
    for (int x = 0; x < side; ++x) {
      double sum = 0, on = 0;
      for (int k = 0; k < kSuper * kSuper; ++k) {
        const double u = (x + (k % kSuper + 0.5) / kSuper - 0.5 - middle - shot.off_x_px) / shot.radius_px;
        const double v = (y + (k / kSuper + 0.5) / kSuper - 0.5 - middle - shot.off_y_px) / shot.radius_px;
        const double grey = part.grey(c * u - s * v, s * u + c * v);
        sum += grey;
        on += grey > 0 ? 1 : 0;
      }
      const double share = sum / (kSuper * kSuper);
      const double light = 1 + shot.light * (x - middle) / middle;
      exact.at(x, y) = static_cast<float>(light * (shot.ground_grey + share * (shot.part_grey - shot.ground_grey)));
      outline.at(x, y) = on >= kSuper * kSuper / 2.0 ? 255 : 0;
    }
  blur(exact, shot.blur_px);
  std::mt19937 random(shot.seed);
  std::normal_distribution<double> noise(0, 1);
  Photo photo;
  photo.picture.resize(side, side);
  for (int y = 0; y < side; ++y)
    for (int x = 0; x < side; ++x)
      photo.picture.at(x, y) = to_grey(static_cast<double>(exact.at(x, y)) + shot.noise_grey * noise(random));
  if (shot.mask == MaskKind::outline) photo.mask = std::move(outline);
  if (shot.mask == MaskKind::generous) photo.mask = grown(outline, 3);
  return photo;
}

KnownPart random_part(std::mt19937& random) {
  const auto u = [&](double lo, double hi) { return std::uniform_real_distribution<double>(lo, hi)(random); };
  const auto pick = [&](int lo, int hi) { return std::uniform_int_distribution<int>(lo, hi)(random); };
  const double bore = u(0.2, 0.4);
  const auto base = [&]() -> KnownPart {
    constexpr int kCorners[] = {3, 4, 5, 6, 8};
    switch (pick(0, 9)) {
      case 0:
        return polygon_part(kCorners[pick(0, 4)], bore);
      case 1:
      case 2:
      case 3:
        return gear_part(pick(5, 48), u(0.1, 0.2), bore);
      case 4:
        return annulus_part(pick(0, 3) == 0 ? 0 : bore);
      case 5:
        return star_part(pick(3, 12));
      case 6:
        return pick(0, 1) ? rectangle_part(u(1.3, 4)) : ellipse_part(u(1.3, 3));
      case 7:
        return s_part();
      case 8:
        return l_part();
      default:
        return spoked_part(7);
    }
  };
  KnownPart part = base();
  const bool bored = part.name.starts_with("polygon") || part.name.starts_with("gear") || part.name == "annulus";
  switch (pick(0, 5)) {
    case 0:
      return bored ? with_keyway(part, bore, u(0.08, 0.2), u(0.08, 0.2)) : part;
    case 1:
      return part.order > 1 ? with_dot(part, u(0.45, 0.6), u(0.05, 0.1), u(0.2, 0.7)) : part;
    case 2:
      return part.order >= 5 ? with_notch(part, u(0.1, 0.25), u(0.25, 0.35)) : part;
    default:
      return part;
  }
}

std::string words(const KnownPart& part, const Shot& shot) {
  return part.name + ", radius " + std::to_string(shot.radius_px) + ", turned " + std::to_string(shot.turn_deg) +
         ", noise " + std::to_string(shot.noise_grey) + ", blur " + std::to_string(shot.blur_px) + ", mask " +
         std::to_string(static_cast<int>(shot.mask));
}

bool resolvable(const KnownPart& part, const Shot& shot) {
  return part.finest * shot.radius_px >= 5 + 2 * std::max(0.0, shot.blur_px - 0.5);
}

Shot random_shot(std::mt19937& random, double least_radius_px, double most_radius_px) {
  const auto u = [&](double lo, double hi) { return std::uniform_real_distribution<double>(lo, hi)(random); };
  Shot shot;
  shot.radius_px = u(least_radius_px, most_radius_px);
  shot.off_x_px = u(-3, 3);
  shot.off_y_px = u(-3, 3);
  shot.turn_deg = u(-180, 180);
  shot.noise_grey = std::max(0.0, u(-1.5, 4));
  shot.blur_px = std::max(0.0, u(-0.5, 1.5));
  shot.ground_grey = u(20, 200);
  do shot.part_grey = u(20, 235);
  while (std::abs(shot.part_grey - shot.ground_grey) < 50);
  shot.light = std::max(0.0, u(-0.2, 0.2));
  constexpr MaskKind kMasks[] = {MaskKind::none, MaskKind::outline, MaskKind::generous};
  shot.mask = kMasks[std::uniform_int_distribution<int>(0, 2)(random)];
  shot.seed = static_cast<unsigned>(random());
  return shot;
}

}  // namespace pickcell::matches::testing
