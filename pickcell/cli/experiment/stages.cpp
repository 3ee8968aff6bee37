/// pickcell experiment stages: one picture per stage of engine best, for docs/matching.md. The scene is rendered from
/// the project's own parts; what is drawn comes from the engine's own rooms, not from a copy of them.

#include <algorithm>
#include <cmath>
#include <memory>
#include <memory_resource>
#include <numbers>
#include <ostream>

#include "pickcell/cli/bench/dataset.hpp"
#include "pickcell/cli/experiment/experiment.hpp"
#include "pickcell/cli/model_input.hpp"
#include "pickcell/image/codec.hpp"
#include "pickcell/image/draw.hpp"
#include "pickcell/matches/best/model.hpp"
#include "pickcell/matches/best/scene.hpp"
#include "pickcell/matches/coarse/search.hpp"
#include "pickcell/matches/fit/edge_points.hpp"
#include "pickcell/matches/overlay.hpp"
#include "pickcell/sim/rendered_set.hpp"

namespace pickcell::cli {

namespace {

using image::Rgb;
using image::RgbImage;

constexpr Rgb kFound{90, 230, 120}, kStart{255, 170, 60};

Rgb mixed(const double (&rgb)[3], double strength) {
  const auto byte = [&](double v) {
    return static_cast<std::uint8_t>(std::lround(255 * std::clamp(v * strength, 0., 1.)));
  };
  return {byte(rgb[0]), byte(rgb[1]), byte(rgb[2])};
}

/// Edge direction as a colour of the circle (the doubled angle makes both polarities one), strength as brightness.
Rgb direction_colour(double c2, double s2) {
  const double hue = std::atan2(s2, c2);
  const auto wave = [&](double phase) { return 0.5 + 0.5 * std::cos(hue - phase * 2 * std::numbers::pi / 3); };
  return mixed({wave(0), wave(1), wave(2)}, std::min(1.0, 1.6 * std::hypot(c2, s2)));
}

/// Black, violet, orange, white.
Rgb heat_colour(double v) {
  return mixed(
      {std::clamp(2.2 * v, 0., 1.), std::clamp(2.2 * v - 0.8, 0., 1.), v < 0.5 ? v : std::clamp(3 * v - 2, 0.3, 1.)},
      1);
}

template <class Colour>
RgbImage enlarged(int width, int height, int times, const Colour& colour) {
  RgbImage out(width * times, height * times, {0, 0, 0});
  for (int y = 0; y < out.height; ++y)
    for (int x = 0; x < out.width; ++x) out.at(x, y) = colour(x / times, y / times);
  return out;
}

RgbImage halved(const RgbImage& in) {
  RgbImage out(in.width / 2, in.height / 2, {0, 0, 0});
  for (int y = 0; y < out.height; ++y)
    for (int x = 0; x < out.width; ++x)
      for (std::size_t k = 0; k < 3; ++k)
        out.at(x, y)[k] = static_cast<std::uint8_t>((in.at(2 * x, 2 * y)[k] + in.at(2 * x + 1, 2 * y)[k] +
                                                     in.at(2 * x, 2 * y + 1)[k] + in.at(2 * x + 1, 2 * y + 1)[k] + 2) /
                                                    4);
  return out;
}

/// The engine's rooms for one part and one picture.
class Stages {
 public:
  Stages(const matches::Model& model, image::ImageView picture)
      : model_(model), best_(matches::prepare_model(model, model.scale, settings_)) {
    pyramid_.build(picture);
    scene_.start(pyramid_);
    matches::WorkBudget no_limit;
    coarse_ = scene_.coarse(band().factor, band().reach, no_limit);
    auto engine = matches::make_engine("best", {});
    matches::SearchOptions options;
    options.explain = true;
    const matches::Model* one[] = {&model_};
    if (engine)
      if (auto result = (*engine)->find(pyramid_, one, options)) found_ = std::move(*result);
  }
  [[nodiscard]] bool found() const { return !found_.matches.empty(); }

  [[nodiscard]] RgbImage part() const {
    const auto inside = [&](int x, int y) { return model_.mask.empty() || model_.mask.at(x, y) >= 128; };
    return enlarged(model_.picture.width(), model_.picture.height(), 2, [&](int x, int y) {
      const std::uint8_t grey = model_.picture.at(x, y);
      return inside(x, y) ? Rgb{grey, grey, grey}
                          : Rgb{static_cast<std::uint8_t>(grey / 3), static_cast<std::uint8_t>(grey / 3),
                                static_cast<std::uint8_t>(90 + grey / 3)};
    });
  }
  [[nodiscard]] RgbImage field() const {
    return enlarged(coarse_->width, coarse_->height, cell_px(), [&](int x, int y) {
      const std::uint32_t cell = *coarse_->at(x, y);
      const auto value = [&](int shift) { return (static_cast<double>(cell >> shift & 255U) - 128) / 127; };
      return direction_colour(value(0), value(8));
    });
  }
  /// Over all angles and scales.
  [[nodiscard]] RgbImage scores() const {
    image::Plane<float> most(coarse_->width, coarse_->height),
        own(coarse_->width + matches::kKernelBlock, coarse_->height);
    most.fill(-1);
    for (const matches::CoarseTile& tile : band().tiles) {
      std::vector<std::int32_t> offsets;
      for (std::size_t k = 0; k < tile.dx.size(); ++k) offsets.push_back(tile.dy[k] * coarse_->stride() + tile.dx[k]);
      const matches::FourTemplates four{offsets,
                                        tile.weights,
                                        {tile.bias[0], tile.bias[1], tile.bias[2], tile.bias[3]},
                                        {tile.norm[0], tile.norm[1], tile.norm[2], tile.norm[3]}};
      matches::best_of_four({coarse_->at(0, 0), coarse_->stride(), coarse_->width, coarse_->height}, four, own.row(0),
                            own.stride());
      for (int y = 0; y < most.height(); ++y)
        for (int x = 0; x < most.width(); ++x) most.at(x, y) = std::max(most.at(x, y), own.at(x, y));
    }
    float highest = 0.01F;
    for (int y = 0; y < most.height(); ++y)
      highest = std::max(highest, *std::max_element(most.row(y), most.row(y) + most.width()));
    return enlarged(most.width(), most.height(), cell_px(),
                    [&](int x, int y) { return heat_colour(std::max(0.F, most.at(x, y)) / highest); });
  }
  [[nodiscard]] RgbImage candidates() {
    RgbImage out = image::to_rgb(pyramid_.level(0));
    const auto list = coarse_candidates();
    for (auto c = list.rbegin(); c != list.rend(); ++c) {
      image::Path path;
      for (const auto& corner : best_.outline(c->place).corner) path.push_back({corner[0], corner[1]});
      const double rank = list.empty() ? 0 : c->score / list.front().score;
      image::draw_path(out, image::closed(path), {.colour = heat_colour(rank), .width_px = 1.5 + rank, .halo_px = 1});
    }
    return halved(out);
  }
  /// The found part, enlarged: where the coarse search saw the contour, and where the fit put it.
  [[nodiscard]] RgbImage contours() {
    constexpr int kTimes = 3, kSide = 160;
    const matches::Similarity last = place_of(found_.matches.front().pose);
    const image::ImageView picture = pyramid_.level(0);
    const int x0 = std::clamp(static_cast<int>(last.x_px) - kSide / 2, 0, picture.width() - kSide);
    const int y0 = std::clamp(static_cast<int>(last.y_px) - kSide / 2, 0, picture.height() - kSide);
    RgbImage out = enlarged(kSide, kSide, kTimes, [&](int x, int y) {
      const std::uint8_t grey = picture.at(x0 + x, y0 + y);
      return Rgb{grey, grey, grey};
    });
    const auto points = matches::choose_contour_points(best_.pyramid, 0, 300);
    const auto draw = [&](const matches::Similarity& place, Rgb colour) {
      const matches::LevelMap map = matches::at_level(place, 0);
      for (std::size_t i = 0; i < static_cast<std::size_t>(points.count); ++i) {
        const double x = map.x + map.a * points.x[i] + map.b * points.y[i],
                     y = map.y - map.b * points.x[i] + map.a * points.y[i];
        image::draw_path(out, image::circle({(x - x0 + 0.5) * kTimes, (y - y0 + 0.5) * kTimes}, 1.5),
                         {.colour = colour, .width_px = 1.5, .halo_px = 0.5});
      }
    };
    const auto list = coarse_candidates();
    const auto apart = [&](const matches::CoarseCandidate& c) {
      return std::hypot(c.place.x_px - last.x_px, c.place.y_px - last.y_px) +
             20 * std::abs(matches::wrap_rad(c.place.angle_rad - last.angle_rad));
    };
    if (!list.empty())
      draw(std::min_element(list.begin(), list.end(), [&](const auto& a, const auto& b) { return apart(a) < apart(b); })
               ->place,
           kStart);
    draw(last, kFound);
    return out;
  }
  [[nodiscard]] RgbImage result() const {
    const matches::Model* one[] = {&model_};
    return halved(matches::draw_overlay(pyramid_.level(0), found_, one));
  }

 private:
  /// A range of scales as narrow as the rendered set's is one band.
  [[nodiscard]] const matches::CoarseTemplates& band() const { return best_.quick.front(); }
  [[nodiscard]] int cell_px() const { return std::max(1, 480 / coarse_->width); }
  [[nodiscard]] std::vector<matches::CoarseCandidate> coarse_candidates() {
    matches::WorkBudget unlimited;
    matches::CoarseRequest request;
    request.candidates = settings_.quick.candidates;
    std::pmr::vector<matches::CoarseCandidate> out;
    search_.run(*coarse_, band(), request, unlimited, out);
    return {out.begin(), out.end()};
  }
  [[nodiscard]] matches::Similarity place_of(const matches::Pose2d& pose) const {
    const auto at = matches::to_scene(model_, pose, best_.pyramid.anchor_x_px, best_.pyramid.anchor_y_px);
    return {at.x_px, at.y_px, pose.angle_deg / matches::kDegPerRad, pose.scale};
  }

  const matches::Model& model_;
  matches::BestSettings settings_;
  matches::BestModel best_;
  image::Pyramid pyramid_;
  matches::BestScene scene_;
  const matches::CoarseScene* coarse_ = nullptr;
  matches::CoarseSearch search_;
  matches::FindResult found_;
};

core::Result<int> run(const ExperimentOptions& options, Io& io) {
  const int number = options.n.value_or(12);
  const auto folder = options.out / "set";
  if (auto done = sim::write_rendered_set(folder, options.seed, number); !done) return core::forward(done);
  const auto set = load_dataset(folder);
  if (!set) return tl::unexpected(set.error());
  const DatasetImage& last = set->images.back();
  const DatasetTemplate& part = set->templates[last.template_index];
  matches::TeachInput how;
  how.scale = set->scale;
  auto taught = teach_file((set->folder / part.file).string(),
                           part.mask ? (set->folder / *part.mask).string() : std::string(), how);
  if (!taught) return core::forward(taught);
  const auto picture = image::load_grey(set->folder / last.file);
  if (!picture) return tl::unexpected(picture.error());
  const auto stages = std::make_unique<Stages>(taught->model, picture->view());
  if (!stages->found()) {
    io.err << "pickcell: " << last.file.string() << ": " << part.id
           << " was not found; choose another picture with --n\n";
    return 1;
  }
  const std::pair<const char*, RgbImage> files[] = {
      {"stage-1-part.png", stages->part()},         {"stage-2-field.png", stages->field()},
      {"stage-3-scores.png", stages->scores()},     {"stage-4-candidates.png", stages->candidates()},
      {"stage-5-contours.png", stages->contours()}, {"stage-6-result.png", stages->result()}};
  for (const auto& [name, drawn] : files)
    if (auto saved = image::save_png(options.out / name, drawn); !saved) return core::forward(saved);
  io.out << "six pictures of how " << part.id << " is found are in " << options.out.string() << "\n";
  return 0;
}

const ExperimentRegistration registered({"stages",
                                         "a picture per stage of engine best, for docs/matching.md; --n: which picture "
                                         "of the rendered set (1..75, default 12)",
                                         false, run});

}  // namespace

}  // namespace pickcell::cli
