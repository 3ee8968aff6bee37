#include "pickcell/cli/experiment/paper_pictures.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <numbers>

#include "pickcell/image/codec.hpp"
#include "pickcell/sim/flat_scene.hpp"
#include "pickcell/sim/layout.hpp"

namespace pickcell::cli {
namespace {

constexpr int kWidth = 640, kHeight = 480;
constexpr double kPxPerMm = 5;

struct SceneRecipe {
  std::vector<const char*> kinds;
  std::array<sim::Surface, 2> surfaces;
};

const SceneRecipe& recipe(std::size_t category) {
  using sim::Surface;
  static const std::array<SceneRecipe, 6> all{{
      {{"cam_disc", "washer_tab", "hook_plate", "gear_24"}, {Surface::wood, Surface::cloth}},
      {{"gear_18", "bracket_l", "bracket_u", "lever_arm"}, {Surface::belt, Surface::plastic}},
      {{"wrench_open", "gear_12", "washer_notch", "bracket_l"}, {Surface::metal, Surface::wood}},
      {{"plate_motor", "label_tag", "bracket_t"}, {Surface::plastic, Surface::metal}},
      {{"label_box", "label_tag"}, {Surface::cloth, Surface::belt}},
      {{"bracket_t", "washer_notch", "label_tag", "gear_24"}, {Surface::metal, Surface::cloth}},
  }};
  return all[category];
}

SourcePicture render(std::size_t category, std::size_t which, std::uint64_t seed) {
  const SceneRecipe& r = recipe(category);
  sim::Random random(seed);
  sim::LightPlane plane(kWidth, kHeight);
  const sim::SurfaceTexture surface(r.surfaces[which], seed, 280.0, 220.0);
  sim::lay_surface(plane, surface, kPxPerMm, random.uniform(0, 60), random.uniform(0, 60), random.uniform(-180, 180));
  const sim::Box2 frame{{-5, -kHeight / kPxPerMm - 5}, {kWidth / kPxPerMm + 5, 5}};
  std::vector<sim::LaidPart> laid;
  for (std::size_t i = 0; i < 3 * r.kinds.size(); ++i) {
    sim::LaidPart part{&sim::part_texture(r.kinds[i % r.kinds.size()]), sim::Point2::Zero(), 0, 1};
    if (!sim::lay_at_random(part, frame, laid, 1, random, 60)) continue;
    laid.push_back(part);
    const sim::FlatPose at{part.at_mm.x() * kPxPerMm, -part.at_mm.y() * kPxPerMm, part.angle_deg, kPxPerMm,
                           sim::Point2::Zero()};
    sim::lay_part(plane, *part.part, at, {.from_deg = 120, .strength = 0.15});
  }
  sim::blur(plane, 0.5);
  std::string name = kPaperCategories[category];
  name[0] = static_cast<char>(std::tolower(static_cast<unsigned char>(name[0])));
  return {name + std::to_string(which), category, sim::expose(plane, {.noise_grey = 1}, random.bits())};
}

/// Standard deviation of grey values in a rectangle.
double contrast(const image::Image& p, int x0, int y0, int w, int h) {
  double sum = 0, square = 0;
  for (int y = y0; y < y0 + h; ++y)
    for (int x = x0; x < x0 + w; ++x) {
      const double v = p.at(x, y);
      sum += v;
      square += v * v;
    }
  const double n = static_cast<double>(w) * h;
  return std::sqrt(std::max(0.0, square / n - sum * sum / n / n));
}

double sample(image::ImageView p, double x, double y) {
  const int i = std::clamp(static_cast<int>(std::floor(x)), 0, p.width() - 2);
  const int j = std::clamp(static_cast<int>(std::floor(y)), 0, p.height() - 2);
  const double fx = std::clamp(x - i, 0.0, 1.0), fy = std::clamp(y - j, 0.0, 1.0);
  const double up = p.at(i, j) + fx * (p.at(i + 1, j) - p.at(i, j));
  const double down = p.at(i, j + 1) + fx * (p.at(i + 1, j + 1) - p.at(i, j + 1));
  return up + fy * (down - up);
}

}  // namespace

std::vector<SourcePicture> rendered_sources(std::uint64_t seed) {
  std::vector<SourcePicture> out;
  for (std::size_t c = 0; c < kPaperCategories.size(); ++c)
    for (std::size_t which = 0; which < 2; ++which) out.push_back(render(c, which, seed * 100 + 2 * c + which));
  return out;
}

core::Result<std::vector<SourcePicture>> photo_sources(const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> files;
  std::error_code problem;
  for (const auto& entry : std::filesystem::directory_iterator(folder, problem)) {
    std::string ending = entry.path().extension().string();
    for (char& c : ending) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    for (const char* known : {".png", ".jpg", ".jpeg", ".bmp", ".pgm", ".ppm"})
      if (ending == known) files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  std::vector<SourcePicture> out;
  for (const auto& file : files) {
    auto picture = image::load_grey(file);
    if (!picture) return core::forward(picture);
    if (picture->width() < 320 || picture->height() < 240) continue;
    std::size_t category = out.size() % kPaperCategories.size();
    std::string stem = file.stem().string();
    for (char& c : stem) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    for (std::size_t c = 0; c < kPaperCategories.size(); ++c) {
      std::string name = kPaperCategories[c];
      for (char& letter : name) letter = static_cast<char>(std::tolower(static_cast<unsigned char>(letter)));
      if (stem.starts_with(name)) category = c;
    }
    out.push_back({file.stem().string(), category, std::move(*picture)});
  }
  if (out.empty())
    return core::failure(core::ErrorCode::usage, folder.string(), "holds no picture of at least 320 x 240 pixels",
                         "name a folder of PNG, JPEG, BMP or PGM pictures");
  return out;
}

core::Result<std::vector<SourcePicture>> paper_sources(const std::optional<std::filesystem::path>& photos,
                                                       std::uint64_t seed) {
  if (photos) return photo_sources(*photos);
  return rendered_sources(seed);
}

image::Image cut_template(const SourcePicture& source, int width, int height, sim::Random& random) {
  const image::Image& p = source.picture;
  int best_x = 0, best_y = 0;
  double best = -1;
  for (int i = 0; i < 24; ++i) {
    const int x = random.integer(0, p.width() - width), y = random.integer(0, p.height() - height);
    double least = 1e9;
    for (const auto& [dx, dy] : {std::pair{0, 0}, {1, 0}, {0, 1}, {1, 1}})
      least = std::min(least, contrast(p, x + dx * (width / 2), y + dy * (height / 2), width / 2, height / 2));
    const double score = least + 0.5 * contrast(p, x, y, width, height);
    if (score > best) best = score, best_x = x, best_y = y;
  }
  return image::Image(p.view().crop(best_x, best_y, width, height));
}

void lay_template(image::Image& scene, image::ImageView part, const TruthPose& pose) {
  constexpr int kSamples = 4;
  const double a = pose.angle_deg * std::numbers::pi / 180, c = std::cos(a) / pose.scale, s = std::sin(a) / pose.scale;
  const double cx = 0.5 * (part.width() - 1), cy = 0.5 * (part.height() - 1);
  for (int y = 0; y < scene.height(); ++y)
    for (int x = 0; x < scene.width(); ++x) {
      double sum = 0;
      int covered = 0;
      for (int k = 0; k < kSamples * kSamples; ++k) {
        const double dx = x + (k % kSamples + 0.5) / kSamples - 0.5 - pose.x_px;
        const double dy = y + (k / kSamples + 0.5) / kSamples - 0.5 - pose.y_px;
        const double u = cx + c * dx - s * dy, v = cy + s * dx + c * dy;
        if (u < -0.5 || v < -0.5 || u > part.width() - 0.5 || v > part.height() - 0.5) continue;
        sum += sample(part, u, v);
        ++covered;
      }
      if (covered == 0) continue;
      const double all = kSamples * kSamples;
      scene.at(x, y) = static_cast<std::uint8_t>((sum + (all - covered) * scene.at(x, y)) / all + 0.5);
    }
}

std::optional<TruthPose> pose_inside(int scene_w, int scene_h, int w, int h, double angle_deg, double scale,
                                     sim::Random& random) {
  const double a = angle_deg * std::numbers::pi / 180, c = std::abs(std::cos(a)), s = std::abs(std::sin(a));
  const double half_w = scale * (c * w + s * h) / 2 + 1, half_h = scale * (s * w + c * h) / 2 + 1;
  if (2 * half_w >= scene_w || 2 * half_h >= scene_h) return {};
  return TruthPose{random.uniform(half_w, scene_w - 1 - half_w), random.uniform(half_h, scene_h - 1 - half_h),
                   angle_deg, scale};
}

image::Image scene_of(const SourcePicture& source, int width, int height) {
  image::Image out(width, height);
  const auto mirrored = [](int v, int size) {
    const int m = v % (2 * size);
    return m < size ? m : 2 * size - 1 - m;
  };
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      out.at(x, y) = source.picture.at(mirrored(x, source.picture.width()), mirrored(y, source.picture.height()));
  return out;
}

}  // namespace pickcell::cli
