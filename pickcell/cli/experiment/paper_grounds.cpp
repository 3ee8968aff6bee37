#include "pickcell/cli/experiment/paper_grounds.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <string_view>
#include <utility>

#include "pickcell/core/statistics.hpp"
#include "pickcell/image/pyramid.hpp"
#include "pickcell/matches/teach.hpp"
#include "pickcell/matches/work.hpp"
#include "pickcell/sim/flat_scene.hpp"
#include "pickcell/sim/random.hpp"

namespace pickcell::cli {
namespace {

constexpr int kWidth = 752, kHeight = 580, kPictures = 3;
constexpr std::size_t kLongSample = 5;  // SP6
constexpr std::array<const char*, 3> kSteps = {"radial", "template", "robust"};
constexpr double kSurface_mm = 900;  // wide enough that no two pictures show the same piece of it

/// A picture of the ground with the part's outline centred at a pose.
class Stage {
 public:
  Stage(const Sample& sample, sim::Surface ground, std::uint64_t seed)
      : part_(sim::part_texture(sample.kind)), surface_(ground, seed, kSurface_mm, kSurface_mm), random_(seed) {
    const sim::Box2 box = part_.kind().outline.bounds();
    px_per_mm_ = 0.9 * std::min(sample.w / box.size().x(), sample.h / box.size().y());
    middle_ = (box.lo + box.hi) / 2;
  }

  image::Image picture(double x_px, double y_px, double angle_deg) {
    sim::LightPlane plane(kWidth, kHeight);
    sim::lay_surface(plane, surface_, px_per_mm_, random_.uniform(0, kSurface_mm), random_.uniform(0, kSurface_mm), 0);
    sim::lay_part(plane, part_, {x_px, y_px, angle_deg, px_per_mm_, middle_}, {.from_deg = 120, .strength = 0.15});
    return sim::expose(plane, {.noise_grey = 1}, random_.bits());
  }
  [[nodiscard]] sim::Random& random() { return random_; }

 private:
  const sim::PartTexture& part_;
  sim::SurfaceTexture surface_;
  sim::Random random_;
  double px_per_mm_ = 1;
  sim::Point2 middle_ = sim::Point2::Zero();
};

core::Result<matches::Model> taught(const Sample& sample, Stage& stage) {
  const image::Image picture = stage.picture(kWidth / 2.0, kHeight / 2.0, 0);
  matches::TeachInput input;
  input.name = sample.name;
  input.picture = picture.view();
  input.roi = matches::SearchOptions::Roi{(kWidth - sample.w) / 2, (kHeight - sample.h) / 2, sample.w, sample.h};
  auto out = matches::teach(input);
  if (!out) return core::forward(out);
  return std::move(out->model);
}

core::Result<GroundOutcome> search(std::size_t which, sim::Surface ground, std::uint64_t seed) {
  const Sample& sample = kSamples[which];
  Stage stage(sample, ground, seed);
  auto model = taught(sample, stage);
  if (!model) return core::forward(model);
  auto engine = matches::make_engine("rst", {{"scales", "0.9,1,1.1"}});
  if (!engine) return core::forward(engine);
  GroundOutcome out{ground, which, 0, std::vector<double>(kSteps.size()), 0, kPictures};
  const matches::Model* one[] = {&*model};
  std::vector<double> ms;
  for (int i = 0; i < kPictures; ++i) {
    const double half = 0.75 * std::max(sample.w, sample.h);
    const double x = stage.random().uniform(half, kWidth - half), y = stage.random().uniform(half, kHeight - half);
    const image::Image picture = stage.picture(x, y, stage.random().uniform(-180, 180));
    image::Pyramid pyramid;
    core::Result<matches::FindResult> found;
    for (int again = 0; again < 2; ++again) {  // first to prepare it, then for the figures
      const double start_ms = matches::thread_cpu_ms();
      pyramid.build(picture.view());
      found = (*engine)->find(pyramid, one, {});
      if (!found) return core::forward(found);
      if (again == 1) ms.push_back(matches::thread_cpu_ms() - start_ms);
    }
    for (const auto& s : found->stages)
      for (std::size_t k = 0; k < kSteps.size(); ++k)
        if (s.stage == kSteps[k]) out.candidates[k] += static_cast<double>(s.population) / kPictures;
    if (found->matches.empty()) continue;
    const auto& p = found->matches.front().pose;
    out.found += std::hypot(p.x_px - x, p.y_px - y) <= 0.1 * std::min(sample.w, sample.h) ? 1 : 0;
  }
  out.search_ms = core::median(ms).value_or(0);
  return out;
}

}  // namespace

core::Result<std::vector<GroundOutcome>> search_on_grounds(std::size_t samples, std::uint64_t seed) {
  std::vector<GroundOutcome> out;
  for (int g = 0; g < sim::kSurfaces; ++g)
    for (std::size_t i = 0; i < samples; ++i) {
      auto one = search(i, static_cast<sim::Surface>(g), seed + i);
      if (!one) return core::forward(one);
      out.push_back(std::move(*one));
    }
  return out;
}

std::string ground_table(const std::vector<GroundOutcome>& all) {
  std::string out =
      "| ground | SP6: RST ms | time / mean of the samples | candidates of SP6 into steps 2, 3, 4 | mean of the "
      "samples | "
      "found: SP6 | all |\n|---|---|---|---|---|---|---|\n";
  for (int g = 0; g < sim::kSurfaces; ++g) {
    const GroundOutcome* sp6 = nullptr;
    GroundOutcome mean{static_cast<sim::Surface>(g), 0, 0, std::vector<double>(kSteps.size()), 0, 0};
    double n = 0;
    for (const GroundOutcome& o : all) {
      if (o.ground != mean.ground) continue;
      if (o.sample == kLongSample) sp6 = &o;
      ++n;
      mean.search_ms += o.search_ms;
      for (std::size_t k = 0; k < kSteps.size(); ++k) mean.candidates[k] += o.candidates[k];
      mean.found += o.found;
      mean.pictures += o.pictures;
    }
    if (sp6 == nullptr || mean.search_ms <= 0) continue;
    char row[240];
    std::snprintf(row, sizeof row, "| %s | %.2f | %.2f | %.0f, %.0f, %.0f | %.0f, %.0f, %.0f | %d of %d | %d of %d |\n",
                  sim::name(mean.ground), sp6->search_ms, n * sp6->search_ms / mean.search_ms, sp6->candidates[0],
                  sp6->candidates[1], sp6->candidates[2], mean.candidates[0] / n, mean.candidates[1] / n,
                  mean.candidates[2] / n, sp6->found, sp6->pictures, mean.found, mean.pictures);
    out += row;
  }
  return out + "\n";
}

}  // namespace pickcell::cli
