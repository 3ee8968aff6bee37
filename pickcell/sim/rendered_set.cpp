#include "pickcell/sim/rendered_set.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include "pickcell/core/file.hpp"
#include "pickcell/core/json.hpp"
#include "pickcell/core/units.hpp"
#include "pickcell/image/codec.hpp"
#include "pickcell/sim/flat_scene.hpp"
#include "pickcell/sim/layout.hpp"

namespace pickcell::sim {

namespace {

constexpr double kMarginPx = 4;  ///< of a template around the part
constexpr double kMinScale = 0.9, kMaxScale = 1.1;

/// A part as it was taught: its picture and where on the part the picture's centre lies.
struct Template {
  const PartTexture* part = nullptr;
  double px_per_mm = 1;
  int w = 0, h = 0;
  Point2 center_mm = Point2::Zero();
  FlatPose pose;  ///< of the part in the picture
};

/// How one picture is taken.
struct Conditions {
  std::string kind;
  SensorSettings sensor;
  Light light{.from_deg = 120, .strength = 0.1};
  double blur_sigma_px = 0.35;  ///< of the lens alone
  bool cluttered = false;
};

struct Scene {
  LaidPart target;  ///< part null: absent
  std::vector<LaidPart> instances;
  std::vector<LaidPart> clutter;
  std::vector<LaidPart> occluders;
};

constexpr std::array<const char*, 5> kKinds = {"clean", "light_noise", "blur_noise", "occl_clutter", "mixed"};

Conditions conditions(int kind, Random& random) {
  const bool mixed = kind == 4;
  Conditions c;
  c.kind = kKinds[static_cast<std::size_t>(kind)];
  c.light.from_deg = 120 + random.uniform(-15, 15);
  c.sensor.noise_grey = random.uniform(0.7, 1.3);
  if (kind == 1 || mixed) {
    const double part = mixed ? 0.6 : 1.0;
    c.light = {.from_deg = random.uniform(-180, 180), .strength = random.uniform(0.08, 0.25)};
    c.sensor.gain = 1 + part * random.uniform(-0.3, 0.3);
    c.sensor.offset_grey = part * random.uniform(-25, 25);
    c.sensor.gradient = part * random.uniform(0.05, 0.3);
    c.sensor.gradient_deg = random.uniform(-180, 180);
    c.sensor.noise_grey = random.uniform(2, 6);
  }
  if (kind == 2 || mixed) {
    c.blur_sigma_px = random.uniform(0.6, 1.5);
    c.sensor.noise_grey = random.uniform(2, 6);
  }
  c.cluttered = kind >= 3;
  return c;
}

std::vector<SurfaceTexture> make_surfaces(std::uint64_t seed) {
  std::vector<SurfaceTexture> surfaces;
  for (int i = 0; i < kSurfaces; ++i)
    surfaces.emplace_back(static_cast<Surface>(i), seed + static_cast<std::uint64_t>(i), 280.0, 220.0);
  return surfaces;
}

FlatPose flat(const LaidPart& laid, double px_per_mm) {
  return {laid.at_mm.x() * px_per_mm, -laid.at_mm.y() * px_per_mm, laid.angle_deg, px_per_mm * laid.scale,
          Point2::Zero()};
}

/// longest_px: of the part in the template.
Template make_template(const PartKind& kind, double longest_px, Random& random) {
  Template t;
  t.part = &part_texture(kind.name);
  const Box2& box = kind.outline.bounds();
  t.px_per_mm = std::min(longest_px / box.size().maxCoeff(), 4.5);
  t.w = static_cast<int>(std::ceil(box.size().x() * t.px_per_mm + 2 * kMarginPx));
  t.h = static_cast<int>(std::ceil(box.size().y() * t.px_per_mm + 2 * kMarginPx));
  t.center_mm = box.center() + Point2(random.uniform(-0.5, 0.5), random.uniform(-0.5, 0.5)) / t.px_per_mm;
  t.pose = {0.5 * (t.w - 1), 0.5 * (t.h - 1), 0, t.px_per_mm, t.center_mm};
  return t;
}

image::Image picture_of(const Template& t, const SurfaceTexture& cloth, Random& random) {
  LightPlane plane(t.w, t.h);
  lay_surface(plane, cloth, t.px_per_mm, random.uniform(0, 200), random.uniform(0, 200), 0);
  lay_part(plane, *t.part, t.pose, {.from_deg = 120, .strength = 0.1});
  blur(plane, 0.35);
  return expose(plane, {.noise_grey = 1}, random.bits());
}

image::Image mask_of(const Template& t) {
  const LightPlane covered = coverage(t.w, t.h, *t.part, t.pose);
  image::Image mask(t.w, t.h);
  for (int y = 0; y < t.h; ++y)
    for (int x = 0; x < t.w; ++x) mask.at(x, y) = covered.at(x, y) >= 0.5F ? 255 : 0;
  return mask;
}

const char* size_class(const Template& t) {
  const int longest = std::max(t.w, t.h);
  return longest < 110 ? "small" : longest < 180 ? "medium" : "large";
}

core::Json template_json(const Template& t) {
  const PartKind& kind = t.part->kind();
  return core::Json::object()
      .set("id", kind.name)
      .set("file", "templates/" + kind.name + ".png")
      .set("mask", "templates/" + kind.name + "_mask.png")
      .set("category", kind.family)
      .set("size", size_class(t))
      .set("w", t.w)
      .set("h", t.h)
      .set("px_per_mm", t.px_per_mm);
}

core::Json pose_json(const Template& t, const LaidPart& laid) {
  const Point2 center = laid.to_plane(t.center_mm) * t.px_per_mm;
  const double angle = laid.angle_deg < 0 ? laid.angle_deg + 360 : laid.angle_deg;
  return core::Json::object().set("x", center.x()).set("y", -center.y()).set("angle", angle).set("scale", laid.scale);
}

/// A part of another family than the template's.
const PartTexture& other_part(const Template& t, Random& random) {
  const auto& all = part_catalogue();
  while (true) {
    const PartKind& kind = all[static_cast<std::size_t>(random.integer(0, static_cast<int>(all.size()) - 1))];
    if (kind.family != t.part->kind().family) return part_texture(kind.name);
  }
}

/// The picture in mm, y up: its top-left pixel is the origin.
Box2 frame_mm(int width, int height, double px_per_mm, double margin_px) {
  return {Point2(margin_px, margin_px - height) / px_per_mm, Point2(width - margin_px, -margin_px) / px_per_mm};
}

/// Lays another part so that it hides 8..22 % of the target.
void occlude(Scene& scene, const Template& t, Random& random) {
  const double reach = scene.target.part->radius_mm() * 1.6;
  for (int i = 0; i < 300; ++i) {
    LaidPart over{&other_part(t, random),
                  scene.target.at_mm + Point2(random.uniform(-reach, reach), random.uniform(-reach, reach)),
                  random.uniform(-180, 180), random.uniform(kMinScale, kMaxScale)};
    const double hidden = covered_fraction(scene.target, over);
    if (hidden < 0.08 || hidden > 0.22) continue;
    scene.occluders.push_back(over);
    return;
  }
}

void add_clutter(Scene& scene, const Template& t, const Box2& frame, int count, Random& random) {
  std::vector<LaidPart> there = scene.instances;
  there.insert(there.end(), scene.occluders.begin(), scene.occluders.end());
  Box2 wide = frame;
  wide.lo.array() -= 25, wide.hi.array() += 25;
  for (int i = 0; i < count; ++i) {
    LaidPart laid{&other_part(t, random), Point2::Zero(), 0, random.uniform(kMinScale, kMaxScale)};
    if (!lay_at_random(laid, wide, there, 2, random, 40)) continue;
    there.push_back(laid);
    scene.clutter.push_back(laid);
  }
}

image::Image render(const Scene& scene, const Template& t, const Conditions& c, const SurfaceTexture& surface,
                    int width, int height, Random& random) {
  LightPlane plane(width, height);
  lay_surface(plane, surface, t.px_per_mm, random.uniform(0, 500), random.uniform(0, 500), random.uniform(-180, 180));
  for (const auto* group : {&scene.clutter, &scene.instances, &scene.occluders})
    for (const LaidPart& laid : *group) lay_part(plane, *laid.part, flat(laid, t.px_per_mm), c.light);
  blur(plane, c.blur_sigma_px);
  return expose(plane, c.sensor, random.bits());
}

core::Json names(const std::vector<LaidPart>& parts) {
  core::Json out = core::Json::array();
  for (const LaidPart& p : parts) out.push(p.part->kind().name);
  return out;
}

core::Json image_json(const std::string& file, const Scene& scene, const Template& t, const Conditions& c,
                      Surface surface, int width, int height) {
  double hidden = 0;
  for (const LaidPart& o : scene.occluders) hidden += covered_fraction(scene.target, o);
  return core::Json::object()
      .set("file", file)
      .set("template", t.part->kind().name)
      .set("kind", c.kind)
      .set("width", width)
      .set("height", height)
      .set("occlusion", hidden)
      .set("clutter", names(scene.clutter))
      .set("occluder", scene.occluders.empty() ? core::Json() : core::Json(scene.occluders[0].part->kind().name))
      .set("background", name(surface))
      .set("gain", c.sensor.gain)
      .set("offset", c.sensor.offset_grey)
      .set("blur_sigma", c.blur_sigma_px)
      .set("noise_sigma", c.sensor.noise_grey);
}

core::Status save(const std::filesystem::path& folder, const std::vector<Template>& templates,
                  const std::vector<SurfaceTexture>& surfaces, std::uint64_t seed) {
  std::error_code failed;
  for (const char* sub : {"templates", "images"}) std::filesystem::create_directories(folder / sub, failed);
  if (failed)
    return core::failure(core::ErrorCode::unreadable, folder.string(), failed.message(),
                         "choose a folder that can be written");
  Random random(seed + 1);
  for (const Template& t : templates) {
    const std::string stem = t.part->kind().name;
    const auto& teach_surface = surfaces[static_cast<std::size_t>(random.integer(0, kSurfaces - 1))];
    for (auto done :
         {image::save_png(folder / "templates" / (stem + ".png"), picture_of(t, teach_surface, random).view()),
          image::save_png(folder / "templates" / (stem + "_mask.png"), mask_of(t).view())})
      if (!done) return core::forward(done);
  }
  return {};
}

core::Json head(const char* set_name, std::uint64_t seed, const std::vector<Template>& templates) {
  core::Json list = core::Json::array();
  for (const Template& t : templates) list.push(template_json(t));
  return core::Json::object()
      .set("name", set_name)
      .set("seed", static_cast<std::int64_t>(seed))
      .set("convention",
           "pixel centres at integers, x right, y down; scene = c + s*R(a)*(t - tc), tc = ((w-1)/2, (h-1)/2), "
           "R(a) = [[cos, sin], [-sin, cos]]; a > 0 counter-clockwise on the screen")
      .set("templates", std::move(list));
}

std::string image_name(int index, const Template& t, const Conditions& c) {
  char number[16];
  std::snprintf(number, sizeof number, "%03d_", index);
  return std::string("images/") + number + t.part->kind().name + "_" + c.kind + ".png";
}

}  // namespace

core::Status write_rendered_set(const std::filesystem::path& folder, std::uint64_t seed, int pictures) {
  constexpr int kWidth = 640, kHeight = 480;
  Random random(seed);
  const auto surfaces = make_surfaces(seed);
  std::vector<Template> templates;
  const int n = static_cast<int>(part_catalogue().size());
  for (int i = 0; i < n; ++i)  // sizes in geometric steps over 60..250 px, dealt out so that families are mixed
    templates.push_back(make_template(part_catalogue()[static_cast<std::size_t>(i)],
                                      60 * std::pow(230.0 / 60, static_cast<double>(i * 4 % n) / (n - 1)), random));
  if (auto done = save(folder, templates, surfaces, seed); !done) return done;
  core::Json truth = head("rendered", seed, templates), images = core::Json::array();
  for (int i = 0; i < std::min(n * 5, pictures); ++i) {
    const Template& t = templates[static_cast<std::size_t>(i / 5)];
    const Conditions c = conditions(i % 5, random);
    Scene scene;
    scene.target = {t.part, Point2::Zero(), 0, random.uniform(kMinScale, kMaxScale)};
    const Box2 frame = frame_mm(kWidth, kHeight, t.px_per_mm, 4);
    lay_at_random(scene.target, frame, {}, 0, random, 1000);
    scene.instances = {scene.target};
    if (c.cluttered) occlude(scene, t, random);
    add_clutter(scene, t, frame, c.cluttered ? random.integer(4, 8) : random.integer(0, 2), random);
    const int surface = random.integer(0, kSurfaces - 1);
    const std::string file = image_name(i, t, c);
    const image::Image picture =
        render(scene, t, c, surfaces[static_cast<std::size_t>(surface)], kWidth, kHeight, random);
    if (auto done = image::save_png(folder / file, picture.view()); !done) return done;
    core::Json entry = image_json(file, scene, t, c, static_cast<Surface>(surface), kWidth, kHeight);
    const core::Json pose = pose_json(t, scene.target);
    for (const auto& [key, value] : pose.members()) entry.set(key, value);
    images.push(std::move(entry));
  }
  return core::write_file_atomically(folder / "truth.json", truth.set("images", std::move(images)).dump(1));
}

core::Status write_rendered_multi_set(const std::filesystem::path& folder, std::uint64_t seed, int pictures) {
  constexpr int kWidth = 768, kHeight = 576, kImages = 25;
  Random random(seed);
  const auto surfaces = make_surfaces(seed);
  std::vector<Template> templates;
  for (const PartKind& kind : part_catalogue())
    templates.push_back(make_template(kind, kind.outline.bounds().size().maxCoeff() * 2.2, random));
  if (auto done = save(folder, templates, surfaces, seed); !done) return done;
  core::Json truth = head("rendered_multi", seed, templates), images = core::Json::array();
  for (int i = 0; i < std::min(kImages, pictures); ++i) {
    const Template& t = templates[static_cast<std::size_t>(i) % templates.size()];
    const Conditions c = conditions(i % 5, random);
    const Box2 frame = frame_mm(kWidth, kHeight, t.px_per_mm, 4);
    Scene scene;
    const int wanted = i % 5 == i / 5 ? 0 : random.integer(2, 7);  // each condition is absent once
    for (int k = 0; k < wanted; ++k) {
      LaidPart laid{t.part, Point2::Zero(), 0, random.uniform(kMinScale, kMaxScale)};
      if (lay_at_random(laid, frame, scene.instances, 2, random)) scene.instances.push_back(laid);
    }
    add_clutter(scene, t, frame, random.integer(2, 6), random);
    const int surface = random.integer(0, kSurfaces - 1);
    const std::string file = image_name(i, t, c);
    const image::Image picture =
        render(scene, t, c, surfaces[static_cast<std::size_t>(surface)], kWidth, kHeight, random);
    if (auto done = image::save_png(folder / file, picture.view()); !done) return done;
    core::Json instances = core::Json::array();
    for (const LaidPart& laid : scene.instances) instances.push(pose_json(t, laid));
    images.push(image_json(file, scene, t, c, static_cast<Surface>(surface), kWidth, kHeight)
                    .set("instances", std::move(instances)));
  }
  return core::write_file_atomically(folder / "truth.json", truth.set("images", std::move(images)).dump(1));
}

}  // namespace pickcell::sim
