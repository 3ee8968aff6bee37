/// experiment fig8: pictures that are hard in one way each; fig9: one template at five small angles.

#include <algorithm>
#include <array>
#include <cmath>
#include <ostream>

#include "pickcell/cli/bench/loss.hpp"
#include "pickcell/cli/bench/score.hpp"
#include "pickcell/cli/experiment/experiment.hpp"
#include "pickcell/cli/experiment/paper_pictures.hpp"
#include "pickcell/core/file.hpp"
#include "pickcell/core/json.hpp"
#include "pickcell/image/codec.hpp"
#include "pickcell/image/pyramid.hpp"
#include "pickcell/matches/engine.hpp"
#include "pickcell/matches/overlay.hpp"
#include "pickcell/matches/teach.hpp"
#include "pickcell/sim/sensor.hpp"

namespace pickcell::cli {
namespace {

using core::Json;
constexpr std::array<const char*, 3> kEngines = {"erst", "rst", "best"};

std::string text(const char* format, double a, double b = 0, double c = 0) {
  char out[128];
  std::snprintf(out, sizeof out, format, a, b, c);
  return out;
}

core::Result<matches::Model> taught(const std::string& name, const image::Image& part, matches::Range scale) {
  matches::TeachInput input;
  input.name = name;
  input.picture = part.view();
  input.scale = scale;
  auto out = matches::teach(input);
  if (!out) return core::forward(out);
  return std::move(out->model);
}

core::Result<matches::FindResult> search(const char* engine, const image::Image& picture, const matches::Model& model,
                                         int most) {
  auto made = matches::make_engine(engine, {});
  if (!made) return core::forward(made);
  image::Pyramid pyramid;
  pyramid.build(picture.view());
  const matches::Model* one[] = {&model};
  matches::SearchOptions how;
  how.max_matches = most;
  if (most == 1) how.min_score = 0;
  return (*made)->find(pyramid, one, how);
}

bool is_found(const matches::FindResult& found, const TruthPose& t, const image::Image& part) {
  return std::any_of(found.matches.begin(), found.matches.end(), [&](const matches::Match& m) {
    return is_loose(pose_error(m.pose, t), std::min(part.width(), part.height()));
  });
}

image::Image degraded(const image::Image& p, double blur_px, double noise_grey, sim::Random& random) {
  sim::LightPlane light(p.width(), p.height());
  for (int y = 0; y < p.height(); ++y)
    for (int x = 0; x < p.width(); ++x) light.at(x, y) = static_cast<float>(p.at(x, y) / 255.0);
  sim::blur(light, blur_px);
  return sim::expose(light, {.noise_grey = noise_grey}, random.bits());
}

/// One picture of Fig. 8; sizes are those of the paper's captions.
struct Case {
  const char* name;
  const char* file;
  int scene_w, scene_h, w, h;
  int targets;
  std::size_t category;
  double blur_px, noise_grey;
  bool confusing;  ///< look-alikes: other crops of the same source, and the template mirrored
};
constexpr std::array<Case, 6> kCases = {{
    {"small targets", "fig8a_small", 646, 492, 44, 42, 6, 1, 0, 1, false},
    {"large target", "fig8b_large", 646, 492, 363, 170, 1, 4, 0, 1, false},
    {"easily confused targets", "fig8c_confused", 640, 480, 120, 120, 2, 3, 0, 1, true},
    {"several rotated targets", "fig8d_rotated", 768, 576, 71, 73, 8, 2, 0, 1, false},
    {"blurred picture", "fig8e_blurred", 640, 512, 142, 170, 2, 0, 1.8, 1, false},
    {"noisy picture", "fig8f_noisy", 768, 576, 92, 87, 4, 5, 0, 20, false},
}};

/// Poses whose bounding circles do not meet.
std::vector<TruthPose> lay_out(const Case& c, int count, sim::Random& random) {
  std::vector<TruthPose> out;
  const double apart = 1.1 * std::hypot(c.w, c.h);
  for (int i = 0; i < 4000 && static_cast<int>(out.size()) < count; ++i) {
    const double reach = c.targets == 1 && c.w > 300 ? 15 : 180;
    const auto pose =
        pose_inside(c.scene_w, c.scene_h, c.w, c.h, random.uniform(-reach, reach), random.uniform(0.92, 1.08), random);
    if (pose && std::none_of(out.begin(), out.end(), [&](const TruthPose& o) {
          return std::hypot(o.x_px - pose->x_px, o.y_px - pose->y_px) < apart;
        }))
      out.push_back(*pose);
  }
  return out;
}

image::Image mirrored(const image::Image& p) {
  image::Image out(p.width(), p.height());
  for (int y = 0; y < p.height(); ++y)
    for (int x = 0; x < p.width(); ++x) out.at(x, y) = p.at(p.width() - 1 - x, y);
  return out;
}

const SourcePicture& source_for(const std::vector<SourcePicture>& sources, std::size_t category, std::size_t other) {
  std::vector<const SourcePicture*> fitting;
  for (const SourcePicture& s : sources)
    if (s.category == category) fitting.push_back(&s);
  return fitting.empty() ? sources[(category + other) % sources.size()] : *fitting[other % fitting.size()];
}

core::Result<Loss> lost_at(const char* engine, const image::Image& picture, const matches::Model& model,
                           const TruthPose& truth) {
  auto made = matches::make_engine(engine, {});
  if (!made) return core::forward(made);
  image::Pyramid pyramid;
  pyramid.build(picture.view());
  return explain_loss(**made, pyramid, model, truth, 360, {});
}

/// A line for each target that one of the paper's engines did not find: the stage that lost it.
core::Result<std::string> lost_words(const char* name, const char* engine, const image::Image& picture,
                                     const matches::Model& model, const matches::FindResult& found,
                                     const std::vector<TruthPose>& poses, const image::Image& part) {
  std::string out;
  if (std::string_view(engine) == "best") return out;
  for (const TruthPose& p : poses) {
    if (is_found(found, p, part)) continue;
    auto loss = lost_at(engine, picture, model, p);
    if (!loss) return core::forward(loss);
    out += "- " + std::string(name) + ", " + engine +
           text(", target at %.0f, %.0f turned by %.1f degrees: ", p.x_px, p.y_px, p.angle_deg) + "lost at stage " +
           loss->stage + " (" + loss->why + ")\n";
  }
  return out;
}

core::Result<int> run_fig8(const ExperimentOptions& options, Io& io) {
  auto sources = paper_sources(options.photos, options.seed);
  if (!sources) return core::forward(sources);
  std::string report =
      "| case | picture | template | targets | e-RST found, false | RST found, false | best found, false |\n"
      "|---|---|---|---|---|---|---|\n";
  std::string lost;
  Json json = Json::array();
  const std::size_t cases = static_cast<std::size_t>(std::min(options.n.value_or(6), 6));
  for (std::size_t i = 0; i < cases; ++i) {
    const Case& c = kCases[i];
    sim::Random random(options.seed * 1000 + i);
    const SourcePicture& source = source_for(*sources, c.category, 0);
    const int w = std::min(c.w, source.picture.width()), h = std::min(c.h, source.picture.height());
    const image::Image part = cut_template(source, w, h, random);
    image::Image picture = scene_of(source_for(*sources, (c.category + 2) % 6, 1), c.scene_w, c.scene_h);
    std::vector<TruthPose> poses = lay_out(c, c.targets + (c.confusing ? 2 : 0), random);
    for (std::size_t k = 0; k < poses.size(); ++k)
      lay_template(picture,
                   c.confusing && k >= static_cast<std::size_t>(c.targets) ? mirrored(part).view() : part.view(),
                   poses[k]);
    if (c.confusing && poses.size() > static_cast<std::size_t>(c.targets))
      poses.resize(static_cast<std::size_t>(c.targets));
    picture = degraded(picture, c.blur_px, c.noise_grey, random);
    auto model = taught(c.file, part, {0.9, 1.1});
    if (!model) return core::forward(model);
    report += "| " + std::string(c.name) + text(" | %.0fx%.0f", c.scene_w, c.scene_h) + text(" | %.0fx%.0f", w, h) +
              " | " + std::to_string(poses.size());
    Json row = Json::object().set("case", c.name).set("targets", poses.size());
    for (const char* engine : kEngines) {
      auto found = search(engine, picture, *model, std::max<int>(2, 3 * static_cast<int>(poses.size())));
      if (!found) return core::forward(found);
      std::size_t hits = 0, wrong = 0;
      for (const TruthPose& p : poses) hits += is_found(*found, p, part) ? 1 : 0;
      for (const matches::Match& m : found->matches)
        wrong += std::none_of(poses.begin(), poses.end(),
                              [&](const TruthPose& p) { return is_loose(pose_error(m.pose, p), std::min(w, h)); });
      report += text(" | %.0f, %.0f", static_cast<double>(hits), static_cast<double>(wrong));
      if (auto why = lost_words(c.name, engine, picture, *model, *found, poses, part); why)
        lost += *why;
      else
        return core::forward(why);
      row.set(engine, Json::object().set("found", hits).set("false", wrong));
      const matches::Model* one[] = {&*model};
      const std::string file = std::string(c.file) + "_" + engine + ".png";
      if (auto done = image::save_png(options.out / file, matches::draw_overlay(picture.view(), *found, one)); !done)
        return core::forward(done);
    }
    report += " |\n";
    json.push(std::move(row));
  }
  report += "\n" + (lost.empty() ? std::string("Nothing was lost by e-RST or RST.\n") : "Lost targets:\n\n" + lost);
  if (auto done = core::write_file_atomically(options.out / "fig8.md", report); !done) return core::forward(done);
  io.out << (options.json ? json.dump() + "\n" : report);
  return 0;
}

core::Result<int> run_fig9(const ExperimentOptions& options, Io& io) {
  constexpr std::array<int, 5> kAngles = {2, 1, 0, 359, 358};
  auto sources = paper_sources(options.photos, options.seed);
  if (!sources) return core::forward(sources);
  sim::Random random(options.seed);
  const SourcePicture& source = source_for(*sources, 2, 0);
  const int side_w = std::min(331, source.picture.width()), side_h = std::min(330, source.picture.height());
  const image::Image part = cut_template(source, side_w, side_h, random);
  auto model = taught("fig9", part, {0.9, 1.1});
  if (!model) return core::forward(model);
  std::string report = text("Template %.0f x %.0f; found angles, degrees.\n\n", side_w, side_h) +
                       "| true | e-RST | RST | best |\n|---|---|---|---|\n";
  Json json = Json::array();
  const std::size_t count = static_cast<std::size_t>(std::min(options.n.value_or(5), 5));
  for (std::size_t i = 0; i < count; ++i) {
    image::Image picture = scene_of(source_for(*sources, 4, 1), 640, 480);
    const auto pose = pose_inside(640, 480, side_w, side_h, kAngles[i], 1, random);
    lay_template(picture, part.view(), *pose);
    picture = degraded(picture, 0, 1, random);
    report += "| " + std::to_string(kAngles[i]);
    Json row = Json::object().set("true_deg", kAngles[i]);
    for (const char* engine : kEngines) {
      auto found = search(engine, picture, *model, 1);
      if (!found) return core::forward(found);
      report += " | ";
      if (found->matches.empty()) {
        auto loss = lost_at(engine, picture, *model, *pose);
        if (!loss) return core::forward(loss);
        report += "none, lost at stage " + loss->stage + " (" + loss->why + ")";
        row.set(engine, Json());
      } else {
        // Hundredths of a whole turn, so that a hair below 360 is printed as 0.
        const double angle = std::fmod(std::round(100 * found->matches[0].pose.angle_deg) + 36000, 36000) / 100;
        report += text("%.2f", angle);
        row.set(engine, angle);
      }
      const matches::Model* one[] = {&*model};
      const std::string file = "fig9_" + std::to_string(kAngles[i]) + "_" + engine + ".png";
      if (auto done = image::save_png(options.out / file, matches::draw_overlay(picture.view(), *found, one)); !done)
        return core::forward(done);
    }
    report += " |\n";
    json.push(std::move(row));
  }
  if (auto done = core::write_file_atomically(options.out / "fig9.md", report); !done) return core::forward(done);
  io.out << (options.json ? json.dump() + "\n" : report);
  return 0;
}

const ExperimentRegistration fig8({"fig8", "six hard pictures, what each engine finds; --n: pictures (6)", true,
                                   run_fig8});
const ExperimentRegistration fig9({"fig9", "one template at 2, 1, 0, 359 and 358 degrees; --n: angles (5)", true,
                                   run_fig9});

}  // namespace
}  // namespace pickcell::cli
