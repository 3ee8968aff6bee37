#pragma once
/// What rst and erst derive from a model: the training of the paper.

#include <atomic>
#include <cstddef>
#include <deque>
#include <memory>
#include <mutex>
#include <vector>

#include "pickcell/core/result.hpp"
#include "pickcell/matches/fields/template_pyramid.hpp"
#include "pickcell/matches/match.hpp"
#include "pickcell/matches/model.hpp"
#include "pickcell/matches/rotated_rect.hpp"
#include "pickcell/matches/rst/kernels.hpp"
#include "pickcell/matches/rst/lut.hpp"
#include "pickcell/matches/rst/radial.hpp"
#include "pickcell/matches/rst/settings.hpp"
#include "pickcell/matches/rst/window.hpp"

namespace pickcell::matches {

/// The template at full resolution, at every whole degree and scale, made when first asked for. get() may be called
/// from many threads.
class WindowCache {
 public:
  WindowCache(WindowSource source, std::vector<double> scales);
  [[nodiscard]] const Window& get(int angle_deg, int scale);
  [[nodiscard]] std::size_t bytes() const { return bytes_; }
  /// Not while get() is in use.
  void drop();

 private:
  WindowSource source_;
  std::vector<double> scales_;
  std::vector<std::atomic<const Window*>> slot_;
  std::deque<Window> made_;
  std::atomic<std::size_t> bytes_{0};
  std::mutex guard_;
};

/// Radial features of one scale (of the largest alone, unless radial_length is matched).
struct RstRadial {
  PixelLists lines;
  RadialQuery query;
};

struct RstModel {
  const Model* model = nullptr;
  Range scale;                 ///< as asked for
  std::vector<double> scales;  ///< ascending
  int level = 1;               ///< NP
  TemplatePyramid pyramid;
  image::Image coarse_grey;           ///< the template at level NP, smoothed when asked for
  double anchor_x = 0, anchor_y = 0;  ///< of the coarse anchor in pixels of the full template
  double ref_dx = 0, ref_dy = 0;      ///< reference point less anchor
  int pixel_x = 0, pixel_y = 0;       ///< of the full template, next to the anchor: about it windows of step 4 turn
  int margin = 0;                     ///< radius of the largest circle
  std::vector<int> radii;
  PixelLists circles;
  RingQuery rings;
  std::vector<std::vector<float>> ring_means;  ///< the same features before normalisation
  std::vector<RstRadial> radials;
  int lines = 36;
  std::vector<Window> coarse;  ///< [scale * lines + shift]
  std::unique_ptr<WindowCache> fine;

  [[nodiscard]] const RstRadial& radial(int scale_index) const {
    return radials[radials.size() == 1 ? 0 : static_cast<std::size_t>(scale_index)];
  }
  [[nodiscard]] const Window& window(int scale_index, int shift) const {
    return coarse[static_cast<std::size_t>(scale_index * lines + shift)];
  }
  /// The reference point's pose when the anchor lies at (x, y) of the full picture.
  [[nodiscard]] Pose2d pose(double x, double y, double angle_deg, double scale_factor) const;
  /// The same when a window of step 4 lies at pixel (x, y) of the full picture.
  [[nodiscard]] Pose2d window_pose(int x, int y, double angle_deg, double scale_factor) const;
  [[nodiscard]] RotatedRect outline(const Pose2d& pose) const;
};

/// The anchor of the coarse template is its middle pixel; a coarse pixel x is the block of pixels 2^NP x .. 2^NP x +
/// 2^NP - 1, so the anchor lies at 2^NP x + (2^NP - 1) / 2 of the full template, whatever the remainder of its size.
/// That is between two pixels; windows of step 4 turn about the upper left one, so that a part that is not turned meets
/// the picture pixel by pixel, and all its 2^NP places are pixels of one block: a picture shifted by 0 .. 2^NP - 1
/// pixels finds the same pose. Circles have the same radii in pixels at all scales;
/// those that do not fit a scale are left out there (errata of Kim & de Araujo). Errors (usage): a template too small
/// for NP, a coarse template without features.
[[nodiscard]] core::Result<std::unique_ptr<RstModel>> prepare_rst_model(const Model& model, Range scale,
                                                                        const RstSettings& settings);

}  // namespace pickcell::matches
