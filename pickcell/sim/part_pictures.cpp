#include "pickcell/sim/part_pictures.hpp"

#include <algorithm>
#include <functional>
#include <map>
#include <mutex>
#include <stdexcept>
#include <utility>

#include "pickcell/core/units.hpp"

namespace pickcell::sim {

namespace {

Mark print(Shape shape, double albedo = 0.08) { return {std::move(shape), albedo, 1, 0}; }
Mark engraving(Shape shape) { return {std::move(shape), 0.16, 0.75, -0.4}; }
Mark raised(Shape shape, double albedo, double opacity = 0) { return {std::move(shape), albedo, opacity, 1.0}; }
Mark sunk(Shape shape, double albedo, double opacity = 0.35) { return {std::move(shape), albedo, opacity, -1.0}; }

/// A ring of depth for a countersunk hole of radius r.
Mark countersink(double x, double y, double r) { return sunk(circle(r + 1.8).moved(x, y), 0.3); }

PartKind bracket_l() {
  const Shape legs = polygon({{-30, -24}, {30, -24}, {30, -6}, {-12, -6}, {-12, 24}, {-30, 24}}).grown(1);
  return {
      .name = "bracket_l",
      .family = "bracket",
      .outline = cut(legs, {circle(3.2).moved(-21, 16), circle(3.2).moved(-21, 2), capsule({8, -15}, {20, -15}, 3.0)}),
      .height_mm = 8,
      .finish = Finish::brushed,
      .albedo = 0.62,
      .bevel_mm = 0.9,
      .brush_deg = 20,
      .marks = {sunk(rectangle(31, 9, 3).moved(13, -15), 0.3, 0.5), countersink(-21, 16, 3.2), countersink(-21, 2, 3.2),
                engraving(lettering("L4", 6, 1.0).moved(-20, -15))},
      .grasps = {{-3, -15, 0, true}},
      .seed = 11};
}

PartKind bracket_t() {
  const Shape bar = join({rectangle(62, 16, 2).moved(0, 13), rectangle(17, 34, 2).moved(4, -8)});
  return {.name = "bracket_t",
          .family = "bracket",
          .outline = cut(bar, {circle(3.0).moved(-23, 13), circle(3.0).moved(22, 13), circle(4.2).moved(4, -15)}),
          .height_mm = 6,
          .finish = Finish::matt,
          .albedo = 0.22,
          .bevel_mm = 1.0,
          .brush_deg = 0,
          .marks = {raised(rectangle(30, 6, 1).moved(-4, 13), 0.3), print(lettering("T6", 5.5, 0.9).moved(4, 1), 0.75)},
          .grasps = {{2, 13, 90, true}},
          .seed = 12};
}

PartKind bracket_u() {
  const Shape body =
      polygon({{-26, -20}, {26, -20}, {26, 22}, {12, 22}, {12, -6}, {-14, -6}, {-14, 12}, {-26, 12}}).grown(1.2);
  return {.name = "bracket_u",
          .family = "bracket",
          .outline = cut(body, {circle(2.6).moved(-20, 6), circle(2.6).moved(19, 16), circle(2.6).moved(19, 4)}),
          .height_mm = 12,
          .finish = Finish::brushed,
          .albedo = 0.5,
          .bevel_mm = 1.1,
          .brush_deg = 80,
          .marks = {sunk(rectangle(24, 6, 3).moved(-4, -13), 0.25), countersink(-20, 6, 2.6)},
          .grasps = {{0, -13.5, 0, true}},
          .seed = 13};
}

PartKind gear_18() {
  const Shape keyed = join({circle(6), rectangle(4, 4).moved(0, 7)});
  return {
      .name = "gear_18",
      .family = "gear",
      .outline = cut(gear(18, 21.5, 26), {keyed, capsule({12.5, 6}, {13.8, -4}, 3.6), circle(3.4).moved(-6.5, -11.3)}),
      .height_mm = 10,
      .finish = Finish::turned,
      .albedo = 0.58,
      .bevel_mm = 0.6,
      .brush_deg = 0,
      .marks = {sunk(cut(circle(18.8), {circle(9.8)}), 0.42, 0.5), engraving(circle(1.6).moved(-9, 16.2))},
      .grasps = {{0, 0, 0, true}},
      .seed = 21};
}

PartKind gear_24() {
  const Shape keyed = join({circle(8), rectangle(5, 5).moved(-9, 0)});
  return {.name = "gear_24",
          .family = "gear",
          .outline = cut(gear(24, 28, 32.5), {keyed, capsule({10, 15}, {15, 10}, 4), capsule({-4, -18}, {6, -17.5}, 4),
                                              circle(3).moved(-14, 12)}),
          .height_mm = 12,
          .finish = Finish::matt,
          .albedo = 0.3,
          .bevel_mm = 0.9,
          .brush_deg = 0,
          .marks = {raised(circle(12.5), 0.36, 0.6), print(lettering("24", 5, 0.9).moved(19, -8, -60), 0.8)},
          .grasps = {{0, 0, 90, true}},
          .seed = 22};
}

PartKind gear_12() {
  const Shape bore = cut(circle(5), {rectangle(10, 4).moved(0, 5.2)});
  return {.name = "gear_12",
          .family = "gear",
          .outline = cut(gear(12, 15, 20), {bore}),
          .height_mm = 15,
          .finish = Finish::turned,
          .albedo = 0.72,
          .bevel_mm = 0.7,
          .brush_deg = 0,
          .marks = {raised(circle(9.5), 0.7, 0.2), engraving(lettering("12", 3.6, 0.7).moved(0, -11.8)),
                    engraving(capsule({10.5, 3}, {13.5, 4}, 0.8))},
          .grasps = {{0, 0, 0, true}},
          .seed = 23};
}

PartKind washer_notch() {
  return {.name = "washer_notch",
          .family = "washer",
          .outline = cut(circle(22), {circle(9), rectangle(8, 12, 1).moved(0, 20)}),
          .height_mm = 5,
          .finish = Finish::turned,
          .albedo = 0.66,
          .bevel_mm = 0.9,
          .brush_deg = 0,
          .marks = {engraving(lettering("M18", 4.4, 0.8).moved(0, -15.5)), engraving(circle(1.5).moved(-15, 2))},
          .grasps = {{0, 0, 0, true}},
          .seed = 31};
}

PartKind washer_tab() {
  const Shape body = join({circle(18), rectangle(11, 15, 2).moved(20, 0)});
  return {.name = "washer_tab",
          .family = "washer",
          .outline = cut(body, {circle(8), capsule({22, -1.6}, {22, 1.6}, 1.6)}),
          .height_mm = 5,
          .finish = Finish::matt,
          .albedo = 0.55,
          .bevel_mm = 0.8,
          .brush_deg = 0,
          .marks = {sunk(cut(circle(14.5), {circle(11.5)}), 0.3, 0.5),
                    print(lettering("UP", 3.6, 0.7).moved(0, 10.6 + 2.4), 0.1)},
          .grasps = {{0, 0, 90, true}},
          .seed = 32};
}

PartKind wrench_open() {
  const Shape jaw = cut(circle(12).moved(-28, 0), {rectangle(18, 10.5, 1).moved(-38, 2.6, 15)});
  const Shape ring = cut(circle(9).moved(29, 0), {circle(5).moved(29, 0)});
  const Shape shank = polygon({{-24, -5}, {24, -3.6}, {24, 3.6}, {-24, 5}});
  return {
      .name = "wrench_open",
      .family = "wrench",
      .outline = cut(join({jaw, ring, shank}), {circle(5).moved(29, 0), rectangle(18, 10.5, 1).moved(-38, 2.6, 15)}),
      .height_mm = 7,
      .finish = Finish::brushed,
      .albedo = 0.7,
      .bevel_mm = 0.9,
      .brush_deg = 0,
      .marks = {sunk(rectangle(32, 5.4, 2.6).moved(1, 0), 0.45, 0.4),
                engraving(lettering("13 CR-V", 3.2, 0.65).moved(1, 0))},
      .grasps = {{0, 0, 90, true}},
      .seed = 41};
}

PartKind lever_arm() {
  const Shape arm = join({circle(11).moved(-26, -6), capsule({-26, -6}, {4, 6}, 6), capsule({4, 6}, {32, 2}, 5),
                          circle(7.5).moved(32, 2)});
  return {.name = "lever_arm",
          .family = "wrench",
          .outline = cut(arm, {circle(5.5).moved(-26, -6), circle(3).moved(32, 2), capsule({0, 4.6}, {10, 5.2}, 1.7)}),
          .height_mm = 9,
          .finish = Finish::matt,
          .albedo = 0.16,
          .bevel_mm = 1.2,
          .brush_deg = 0,
          .marks = {raised(circle(8.6).moved(-26, -6), 0.24, 0.5), raised(circle(5.6).moved(32, 2), 0.24, 0.5),
                    print(lettering("A7", 4.6, 0.8).moved(-12, 0.2, 21.8), 0.7)},
          .grasps = {{-4, 2.9, 111.8, true}},
          .seed = 42};
}

/// Bars of pseudo-random widths that fill w x h, centred on the origin.
Shape barcode(double w, double h, std::uint64_t pattern) {
  std::vector<Shape> bars;
  double x = -w / 2;
  for (int bit = 0; x < w / 2; bit = (bit + 3) % 60) {
    const double bar = 0.5 + 0.45 * static_cast<double>((pattern >> bit) & 3);
    const double gap = 0.6 + 0.5 * static_cast<double>((pattern >> (bit + 2)) & 1);
    if (x + bar > w / 2) break;
    bars.push_back(rectangle(bar, h).moved(x + bar / 2, 0));
    x += bar + gap;
  }
  return join(std::move(bars));
}

PartKind label_box() {
  return {.name = "label_box",
          .family = "label",
          .outline = rectangle(64, 42, 2),
          .height_mm = 14,
          .finish = Finish::paper,
          .albedo = 0.86,
          .bevel_mm = 0.5,
          .brush_deg = 0,
          .marks = {print(barcode(50, 11, 0x5a3c96e1b27d4f8ULL).moved(0, -11)),
                    print(lettering("PICKCELL", 6, 1.0).moved(-2, 13)),
                    print(lettering("LOT 4711-B", 3.4, 0.6).moved(-6, 3.6)), print(rectangle(60, 0.8).moved(0, 8)),
                    print(cut(circle(4.6), {polygon({{-2.6, -2}, {2.6, -2}, {0, 2.8}})}).moved(24, 2), 0.2)},
          .grasps = {{0, 0, 90, true}},
          .seed = 51};
}

PartKind label_tag() {
  const Shape tag =
      cut(polygon({{-34, -13}, {26, -13}, {34, -6}, {34, 6}, {26, 13}, {-34, 13}}), {circle(2.8).moved(27, 0)});
  return {
      .name = "label_tag",
      .family = "label",
      .outline = tag,
      .height_mm = 6,
      .finish = Finish::paper,
      .albedo = 0.78,
      .bevel_mm = 0.5,
      .brush_deg = 0,
      .marks = {print(rectangle(18, 22, 1).moved(-23, 0), 0.28), print(lettering("K8", 8, 1.4).moved(-23, 0), 0.85),
                print(lettering("SENSOR", 4.4, 0.8).moved(4, 6)), print(lettering("10-30V", 3.6, 0.65).moved(1, -1)),
                print(barcode(26, 4, 0x93b1d5e77a2c64fULL).moved(1, -8))},
      .grasps = {{0, 0, 90, true}},
      .seed = 52};
}

PartKind plate_motor() {
  const Shape plate = cut(polygon({{-22, -20}, {14, -20}, {22, -12}, {22, 20}, {-22, 20}}).grown(2),
                          {circle(9).moved(-2, 2), circle(2.2).moved(-18, 16), circle(2.2).moved(18, 16),
                           circle(2.2).moved(-18, -16), capsule({12, -9}, {17, -4}, 1.8)});
  return {.name = "plate_motor",
          .family = "plate",
          .outline = plate,
          .height_mm = 8,
          .finish = Finish::brushed,
          .albedo = 0.46,
          .bevel_mm = 0.8,
          .brush_deg = -35,
          .marks = {raised(circle(13).moved(-2, 2), 0.5, 0.2), countersink(-18, 16, 2.2), countersink(18, 16, 2.2),
                    countersink(-18, -16, 2.2), engraving(lettering("P3", 4, 0.75).moved(0, -17))},
          .grasps = {{-2, 2, 0, true}},
          .seed = 61};
}

PartKind cam_disc() {
  std::vector<Point2> rim;
  for (int i = 0; i < 180; ++i) {
    const double a = 2 * core::kPi * i / 180;
    const double r = 17 + 5 * std::cos(a) + 2.2 * std::cos(2 * a + 0.7);
    rim.emplace_back(r * std::cos(a) - 3, r * std::sin(a));
  }
  return {.name = "cam_disc",
          .family = "cam",
          .outline = cut(polygon(std::move(rim)),
                         {circle(5.2).moved(-4, 0), rectangle(3, 3).moved(-4, 5.6), circle(2).moved(9, 2)}),
          .height_mm = 11,
          .finish = Finish::turned,
          .albedo = 0.54,
          .bevel_mm = 1.0,
          .brush_deg = 0,
          .marks = {raised(circle(9).moved(-4, 0), 0.6, 0.3), engraving(lettering("C2", 3.6, 0.7).moved(6, -8, 20))},
          .grasps = {{-4, 0, 90, true}},
          .seed = 71};
}

PartKind hook_plate() {
  const Shape hook = polygon(
      {{-21, -17}, {21, -17}, {21, -7}, {-9, -7}, {-9, 8}, {1, 8}, {4, 2}, {11, 4}, {8, 14}, {3, 17}, {-21, 17}});
  const Shape body = cut(hook.grown(2), {circle(3).moved(15, -12), circle(3).moved(-16, -12)});
  return {.name = "hook_plate",
          .family = "plate",
          .outline = body,
          .height_mm = 10,
          .finish = Finish::matt,
          .albedo = 0.4,
          .bevel_mm = 1.0,
          .brush_deg = 0,
          .marks = {sunk(rectangle(16, 5, 2).moved(0, -12), 0.2, 0.5), countersink(15, -12, 3)},
          .grasps = {{0, -12, 0, true}},
          .seed = 62};
}

std::vector<PartKind> build() {
  return {bracket_l(), gear_18(),     wrench_open(), washer_notch(), label_box(), bracket_t(), gear_24(),   lever_arm(),
          label_tag(), plate_motor(), washer_tab(),  bracket_u(),    gear_12(),   cam_disc(),  hook_plate()};
}

}  // namespace

const std::vector<PartKind>& part_catalogue() {
  static const std::vector<PartKind> kinds = build();
  return kinds;
}

namespace {

const PartKind* in_catalogue(std::string_view name) {
  const auto& all = part_catalogue();
  const auto found = std::find_if(all.begin(), all.end(), [&](const PartKind& k) { return k.name == name; });
  return found == all.end() ? nullptr : &*found;
}

struct Material {
  std::string_view prefix;
  Finish finish;
  double albedo, brush_deg;
};
constexpr Material kMaterials[] = {{"wooden_", Finish::wood, 0.5, 15}, {"metal_", Finish::brushed, 0.62, 35}};

/// The named part in another material; null when the name means none.
const PartKind* in_material(std::string_view name) {
  static std::mutex mutex;
  static std::map<std::string, PartKind, std::less<>> made;
  const std::lock_guard lock(mutex);
  if (const auto found = made.find(name); found != made.end()) return &found->second;
  for (const Material& material : kMaterials) {
    if (!name.starts_with(material.prefix)) continue;
    const PartKind* base = in_catalogue(name.substr(material.prefix.size()));
    if (!base) return nullptr;
    PartKind kind = *base;
    kind.name = name;
    kind.finish = material.finish;
    kind.albedo = material.albedo;
    kind.brush_deg = material.brush_deg;
    return &made.emplace(std::string(name), std::move(kind)).first->second;
  }
  return nullptr;
}

}  // namespace

bool is_part_kind(std::string_view name) { return in_catalogue(name) != nullptr || in_material(name) != nullptr; }

const PartKind& part_kind(std::string_view name) {
  const auto& all = part_catalogue();
  if (const PartKind* kind = in_catalogue(name)) return *kind;
  if (const PartKind* kind = in_material(name)) return *kind;
  std::string known;
  for (const PartKind& k : all) known += (known.empty() ? "" : ", ") + k.name;
  throw std::invalid_argument("no part kind called " + std::string(name) + "; there are " + known);
}

}  // namespace pickcell::sim
