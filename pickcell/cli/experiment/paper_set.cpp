#include "pickcell/cli/experiment/paper_set.hpp"

#include <algorithm>
#include <optional>
#include <string>
#include <utility>

#include "pickcell/core/file.hpp"
#include "pickcell/core/json.hpp"
#include "pickcell/image/codec.hpp"
#include "pickcell/sim/random.hpp"

namespace pickcell::cli {
namespace {

namespace fs = std::filesystem;
using core::Json;

constexpr int kTemplates = kFortyTemplates[0] + kFortyTemplates[1] + kFortyTemplates[2], kImagesEach = 5;

/// Which size the i-th of n templates has, in the proportion of 8, 23 and 9.
std::size_t size_of(int i, int n) {
  const double at = (i + 0.5) * kTemplates / n;
  return at < kFortyTemplates[0] ? 0 : at < kFortyTemplates[0] + kFortyTemplates[1] ? 1 : 2;
}

class Generator {
 public:
  Generator(const fs::path& folder, std::vector<SourcePicture> sources, int templates, std::uint64_t seed)
      : sources_(std::move(sources)), folder_(folder), random_(seed), count_(templates) {}

  core::Status write() {
    std::error_code problem;
    for (const char* sub : {"templates", "images"}) fs::create_directories(folder_ / sub, problem);
    if (problem)
      return core::failure(core::ErrorCode::unreadable, folder_.string(), problem.message(),
                           "name a folder that can be written");
    for (int i = 0; i < count_; ++i)
      if (auto done = one(i); !done) return done;
    Json truth = Json::object().set("name", "table2").set("templates", std::move(templates_));
    truth.set("images", std::move(images_));
    return core::write_file_atomically(folder_ / "truth.json", truth.dump(1));
  }

 private:
  static constexpr int kWidth = 640, kHeight = 480;

  core::Status one(int i) {
    static constexpr std::array<std::pair<int, int>, 3> kRange = {{{40, 99}, {100, 199}, {200, 260}}};
    const std::size_t size = size_of(i, count_);
    const SourcePicture& source = of_category(static_cast<std::size_t>(i) % kPaperCategories.size());
    const int w = std::min(random_.integer(kRange[size].first, kRange[size].second), source.picture.width());
    const int h = std::min(random_.integer(kRange[size].first, kRange[size].second), source.picture.height());
    const image::Image part = cut_template(source, w, h, random_);
    const std::string id = std::string(kPaperSizes[size]) + "_" + std::to_string(i);
    const std::string file = "templates/" + id + ".png";
    if (auto done = image::save_png(folder_ / file, part.view()); !done) return done;
    templates_.push(Json::object()
                        .set("id", id)
                        .set("file", file)
                        .set("category", kPaperCategories[source.category])
                        .set("source", source.name)
                        .set("size", kPaperSizes[size])
                        .set("w", w)
                        .set("h", h));
    for (int k = 0; k < kImagesEach; ++k)
      if (auto done = scene(id, part, k); !done) return done;
    return {};
  }

  core::Status scene(const std::string& id, const image::Image& part, int k) {
    const SourcePicture& ground =
        sources_[static_cast<std::size_t>(random_.integer(0, static_cast<int>(sources_.size()) - 1))];
    image::Image picture = scene_of(ground, kWidth, kHeight);
    std::optional<TruthPose> pose;
    while (!pose)
      pose = pose_inside(kWidth, kHeight, part.width(), part.height(), random_.uniform(0, 360),
                         random_.uniform(0.9, 1.1), random_);
    lay_template(picture, part.view(), *pose);
    for (int y = 0; y < kHeight; ++y)
      for (int x = 0; x < kWidth; ++x)
        picture.at(x, y) = static_cast<std::uint8_t>(std::clamp(picture.at(x, y) + random_.normal() + 0.5, 0.0, 255.0));
    const std::string file = "images/" + id + "_" + std::to_string(k) + ".png";
    images_.push(Json::object()
                     .set("file", file)
                     .set("template", id)
                     .set("kind", "clean")
                     .set("width", kWidth)
                     .set("height", kHeight)
                     .set("x", pose->x_px)
                     .set("y", pose->y_px)
                     .set("angle", pose->angle_deg)
                     .set("scale", pose->scale));
    return image::save_png(folder_ / file, picture.view());
  }

  const SourcePicture& of_category(std::size_t category) {
    std::vector<const SourcePicture*> fitting;
    for (const SourcePicture& s : sources_)
      if (s.category == category) fitting.push_back(&s);
    if (fitting.empty()) return sources_[category % sources_.size()];
    return *fitting[static_cast<std::size_t>(random_.integer(0, static_cast<int>(fitting.size()) - 1))];
  }

  std::vector<SourcePicture> sources_;
  fs::path folder_;
  sim::Random random_;
  int count_;
  Json templates_ = Json::array(), images_ = Json::array();
};

}  // namespace

core::Status write_paper_set(const fs::path& folder, std::vector<SourcePicture> sources, int templates,
                             std::uint64_t seed) {
  return Generator(folder, std::move(sources), templates, seed).write();
}

}  // namespace pickcell::cli
