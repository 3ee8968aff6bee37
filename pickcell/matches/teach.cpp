#include "pickcell/matches/teach.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>

#include "pickcell/matches/learn/part_features.hpp"
#include "pickcell/matches/learn/self_match.hpp"
#include "pickcell/matches/limits.hpp"

namespace pickcell::matches {

namespace {

constexpr int kMinSidePx = 6;
constexpr double kSmallPartPixels = 600;  ///< about 24x24: below it every engine misses some under noise and blur
constexpr double kThinAspect = 6;
constexpr double kFeaturelessStd = 1.5;  ///< grey values left after averaging: sensor noise alone leaves less
constexpr double kLowContrastStd = 5;
constexpr double kManyDirections_bits = 2;  ///< see direction_bits
constexpr double kRound = 0.66;             ///< see roundness: coins have about 0.7, beasts 0.5
constexpr double kRoundSpread = 0.08;
constexpr double kOneDirection = 0.02;  ///< of structure across the other direction

tl::unexpected<core::Error> refuse(const std::string& what, const std::string& why, const std::string& remedy) {
  return core::failure(core::ErrorCode::usage, what, why, remedy);
}

std::string size_words(int width, int height) { return std::to_string(width) + "x" + std::to_string(height); }

std::string formatted(const char* format, double value) {
  char text[200];
  std::snprintf(text, sizeof(text), format, value);
  return text;
}

core::Result<SearchOptions::Roi> checked_roi(const TeachInput& input) {
  const int width = input.picture.width(), height = input.picture.height();
  const SearchOptions::Roi roi = input.roi.value_or(SearchOptions::Roi{0, 0, width, height});
  if (roi.x < 0 || roi.y < 0 || roi.w < 1 || roi.h < 1 || roi.w > width - roi.x || roi.h > height - roi.y)
    return refuse("roi", "the rectangle is not inside the picture of " + size_words(width, height),
                  "write x,y,w,h within the picture");
  if (roi.w < kMinSidePx || roi.h < kMinSidePx || roi.w * static_cast<long>(roi.h) < kMinPartPixels)
    return refuse("template", "it is only " + size_words(roi.w, roi.h) + " pixels",
                  "use one of at least " + std::to_string(kMinSidePx) + " pixels a side and " +
                      std::to_string(kMinPartPixels) + " in all; below about 25x25 some parts are missed");
  return roi;
}

/// Cuts the mask to the ROI and makes it 0 or 255. Empty when there is none.
core::Result<image::Image> checked_mask(const TeachInput& input, const SearchOptions::Roi& roi) {
  if (!input.mask) return image::Image();
  image::ImageView mask = *input.mask;
  const bool whole = mask.width() == input.picture.width() && mask.height() == input.picture.height();
  if (!whole && (mask.width() != roi.w || mask.height() != roi.h))
    return refuse("mask",
                  "it is " + size_words(mask.width(), mask.height()) + " but the picture is " +
                      size_words(input.picture.width(), input.picture.height()) +
                      (input.roi ? " and the ROI " + size_words(roi.w, roi.h) : std::string()),
                  "use a mask of the picture's size or the ROI's");
  if (whole) mask = mask.crop(roi.x, roi.y, roi.w, roi.h);
  image::Image out(mask);
  int part = 0;
  for (int y = 0; y < out.height(); ++y)
    for (int x = 0; x < out.width(); ++x) {
      out.at(x, y) = out.at(x, y) >= 128 ? 255 : 0;
      part += out.at(x, y) != 0;
    }
  if (part == 0) return refuse("mask", "it marks no part: no pixel is 128 or brighter", "paint the part white");
  if (part < kMinPartPixels)
    return refuse("mask", "it marks only " + std::to_string(part) + " pixels as part",
                  "use a larger picture of the part");
  return out;
}

core::Status check_numbers(const TeachInput& input) {
  if (auto fine = check_angle_range("angle", input.angle_deg); !fine) return fine;
  if (auto fine = check_scale_range("scale", input.scale); !fine) return fine;
  if (!(input.height_m >= 0 && input.height_m <= 10))
    return refuse("height-mm", "it is not a height from 0 to 10 m above the work plane",
                  "give the height of the part's upper side in mm");
  const double reach = 10.0 * (input.picture.width() + input.picture.height());
  const auto near = [&](double x, double y) { return std::abs(x) <= reach && std::abs(y) <= reach; };
  if (input.ref_px && !near(input.ref_px->x_px, input.ref_px->y_px))
    return refuse("ref", "the reference point is far from the picture", "give x,y in pixels of the template picture");
  for (const Grasp& g : input.grasps)
    if (!near(g.x_px, g.y_px) || !(std::abs(g.angle_deg) <= 720))
      return refuse("grasp", "it is far from the picture or its angle is not in degrees",
                    "give x,y,angle_deg in pixels of the template picture");
  return {};
}

void warn_about_size(const PartFeatures& features, std::vector<TeachWarning>& warnings) {
  if (features.part_pixels < kSmallPartPixels)
    warnings.push_back({"small", formatted("the part has only %.0f pixels: expect misses under noise and blur; use a "
                                           "larger picture",
                                           features.part_pixels)});
  const double aspect = features.long_side_px / std::max(1.0, features.short_side_px);
  if (aspect > kThinAspect)
    warnings.push_back({"thin", formatted("the part is %.1f times longer than wide: the search is slow and its width "
                                          "holds little to tell it by",
                                          aspect)});
}

void warn_about_features(const PartFeatures& features, std::vector<TeachWarning>& warnings) {
  if (features.coarse_std < kLowContrastStd)
    warnings.push_back({"low_contrast", formatted("the part's features stand out by only %.1f grey values; light it "
                                                  "better or expose longer",
                                                  features.coarse_std)});
  if (features.direction_ratio < kOneDirection)
    warnings.push_back(
        {"one_direction",
         "all edges run in one direction: the place along them is uncertain; include an end or a corner"});
}

void warn_about_points(const TeachInput& input, std::vector<TeachWarning>& warnings) {
  const auto outside = [&](double x, double y) {
    return x < -0.5 || y < -0.5 || x > input.picture.width() - 0.5 || y > input.picture.height() - 0.5;
  };
  if (input.ref_px && outside(input.ref_px->x_px, input.ref_px->y_px))
    warnings.push_back(
        {"ref_outside", "the reference point lies outside of the picture: an error of the angle moves it"});
  for (const Grasp& g : input.grasps)
    if (outside(g.x_px, g.y_px))
      warnings.push_back({"grasp_outside", formatted("a grasp at x %.0f", g.x_px) + formatted(", y %.0f", g.y_px) +
                                               " lies outside of the picture: is it in pixels of this template?"});
}

std::string angle_list(const std::vector<double>& angles) {
  std::string out;
  for (const double a : angles) out += (out.empty() ? "" : ", ") + formatted("%.0f", a);
  return out;
}

void warn_about_angles(const Learnt& learnt, std::vector<TeachWarning>& warnings) {
  if (learnt.symmetry_order == kAnyAngle)
    warnings.push_back({"symmetric", "the part looks the same at every angle: its angle cannot be told"});
  else if (learnt.symmetry_order > 1)
    warnings.push_back({"symmetric", "the part looks the same every " + formatted("%g", 360.0 / learnt.symmetry_order) +
                                         " degrees: its angle is ambiguous"});
  else if (!learnt.ambiguous_deg.empty())
    warnings.push_back({"ambiguous", "turned by " + angle_list(learnt.ambiguous_deg) +
                                         " degrees the part looks nearly the same: its angle may be mistaken"});
}

/// Engine best on 100 templates, 700 pictures with the part and 650 without: places where it is not reach 0.63 with
/// parts of about 4500 pixels (the more pixels, the less can agree by chance) and more with two parallel edges, which
/// agree with much of the world. A mask brings the outline, and one that is no disc is rare elsewhere: what comes near
/// the limit of masked parts are discs in place of other discs.
double suggested_threshold(double part_pixels, const TemplatePyramid& part) {
  const double by_size = std::clamp(0.66 - 0.03 * std::log2(part_pixels / 4500), 0.51, 0.725);
  const double few_directions = std::clamp(kManyDirections_bits - direction_bits(part), 0.0, 1.0);
  const double own_outline = part.masked ? std::clamp((kRound - roundness(part)) / kRoundSpread, 0.0, 1.0) : 0.0;
  return by_size + 0.22 * few_directions - 0.05 * own_outline;
}

void warn_about_repeat(const Repeat& repeat, std::vector<TeachWarning>& warnings) {
  warnings.push_back(
      {"repeats", formatted("moved by %.0f", repeat.dx_px) + formatted(", %.0f pixels", repeat.dy_px) +
                      formatted(" the part looks much like itself (%.2f): a neighbour may be taken for it; "
                                "teach a piece with an end or a mark",
                                repeat.likeness)});
}

Learnt learn(const Model& model, const PartFeatures& features, std::vector<TeachWarning>& warnings) {
  const SelfMatch self = self_match(model.picture.view(), model.mask.view());
  if (self.repeat) warn_about_repeat(*self.repeat, warnings);
  Learnt learnt;
  learnt.symmetry_order = self.symmetry_order;
  learnt.ambiguous_deg = self.ambiguous_deg;
  learnt.second_best_self_match = self.second_best;
  learnt.suggested_min_score = suggested_threshold(features.part_pixels, build_template_pyramid(model));
  return learnt;
}

/// The parts of a Model that need no measuring. The input has been checked.
Model cut(const TeachInput& input, const SearchOptions::Roi& roi, image::Image mask) {
  Model model;
  model.name = input.name;
  model.date = input.date;
  model.picture = image::Image(input.picture.crop(roi.x, roi.y, roi.w, roi.h));
  model.mask = std::move(mask);
  model.roi_x_px = roi.x;
  model.roi_y_px = roi.y;
  model.ref_x_px = input.ref_px ? input.ref_px->x_px - roi.x : (roi.w - 1) / 2.0;
  model.ref_y_px = input.ref_px ? input.ref_px->y_px - roi.y : (roi.h - 1) / 2.0;
  model.angle_deg = input.angle_deg;
  model.scale = input.scale;
  model.height_m = input.height_m;
  model.grasps = input.grasps;
  for (Grasp& g : model.grasps) {
    g.x_px -= roi.x;
    g.y_px -= roi.y;
  }
  return model;
}

}  // namespace

core::Result<Taught> teach(const TeachInput& input) {
  const auto start = std::chrono::steady_clock::now();
  if (auto fine = check_numbers(input); !fine) return core::forward(fine);
  const auto roi = checked_roi(input);
  if (!roi) return tl::unexpected(roi.error());
  auto mask = checked_mask(input, *roi);
  if (!mask) return core::forward(mask);
  Taught out;
  out.model = cut(input, *roi, std::move(*mask));
  const PartFeatures features = measure_features(out.model.picture.view(), out.model.mask.view());
  if (features.coarse_std < kFeaturelessStd)
    return refuse("template",
                  std::string("it has no features") + (input.mask ? " inside its mask" : "") +
                      formatted(" (contrast %.1f grey values)", features.coarse_std),
                  input.mask ? "let the mask include the part's edge, or light the part so that its shape shows"
                             : "choose a region with edges, or light the part so that its shape shows");
  out.model.learnt = learn(out.model, features, out.warnings);
  warn_about_size(features, out.warnings);
  warn_about_features(features, out.warnings);
  warn_about_angles(out.model.learnt, out.warnings);
  warn_about_points(input, out.warnings);
  out.teach_ms = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
  return out;
}

}  // namespace pickcell::matches
