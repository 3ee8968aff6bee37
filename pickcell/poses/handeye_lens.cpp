/// Whether the given lens fits the pictures of a hand-eye calibration, and what to do when it does not.

#include <algorithm>
#include <cmath>

#include "pickcell/poses/board_pose.hpp"
#include "pickcell/poses/handeye_problem.hpp"
#include "pickcell/poses/lens_fit.hpp"
#include "pickcell/poses/verdicts.hpp"

namespace pickcell::poses {

namespace {

constexpr double kBetterLens = 0.8;      ///< of the given lens's error on the pictures
constexpr double kBetterHandeye = 0.9;   ///< of the error on the plane, on poses held out
constexpr double kSigmaFocal = 0.01;     ///< of the focal length
constexpr std::size_t kEnoughViews = 8;  ///< for a lens of one's own
constexpr double kUsualCornerPx = 0.15;  ///< RMS that no better lens is looked for below

/// RMS over the points of the views, each with the board's best pose: the arm has no part in it.
double pictures_rms_px(const Lens& lens, const Board& board, const std::vector<NamedView>& views) {
  double sum = 0;
  std::size_t n = 0;
  for (const NamedView& v : views) {
    const auto pose = board_pose(lens, board, v.view);
    if (!pose) continue;
    sum += pose->rms_px * pose->rms_px * static_cast<double>(v.view.ids.size());
    n += v.view.ids.size();
  }
  return std::sqrt(sum / static_cast<double>(std::max<std::size_t>(1, n)));
}

struct OwnLens {
  CameraFit fit;
  double given_px = 0;  ///< of the given lens, on the pictures that the own one was made from
};

/// A lens from the pictures, when it fits pictures that took no part far better than the given one does.
std::optional<OwnLens> better_lens(const HandeyeInput& input) {
  std::vector<NamedView> views;
  for (const ArmView& v : input.views) views.push_back(v.picture);
  if (views.size() < kEnoughViews || pictures_rms_px(input.lens, input.board, views) < kUsualCornerPx) return {};
  // One quick fit tells whether the long way, with held-out pictures, is worth it.
  const auto quick = fit_lens(input.board, views, LensModel::brown5);
  if (!quick || quick->rms_px > kBetterLens * pictures_rms_px(input.lens, input.board, views)) return {};
  auto own = calibrate_camera(input.board, std::move(views));
  if (!own || own->views.size() < kEnoughViews) return {};
  const Lens& lens = own->calibration.lens;
  if (own->sigma.fx_px > kSigmaFocal * lens.fx_px || own->sigma.fy_px > kSigmaFocal * lens.fy_px) return {};
  std::vector<NamedView> used;
  for (const CameraView& v : own->views) used.push_back({v.image, v.view});
  const double given_px = pictures_rms_px(input.lens, input.board, used);
  if (!(own->calibration.holdout_rms_px < kBetterLens * given_px)) return {};
  return OwnLens{std::move(*own), given_px};
}

/// The arm must agree, on poses that took no part; and a fault that was seen must not vanish from the report.
bool arm_agrees(const HandeyeFit& given, const HandeyeFit& own) {
  const bool same_fault = own.fault == given.fault || (own.fault.empty() && own.calibration.verdict < Verdict::reject);
  // More poses at no greater error are agreement too: the given lens may have had its worst poses left out.
  const double wanted = own.views.size() > given.views.size() ? 1 : kBetterHandeye;
  return same_fault && own.views.size() >= given.views.size() && own.holdout_mm < wanted * given.holdout_mm;
}

}  // namespace

core::Result<HandeyeFit> calibrate_handeye(const HandeyeInput& input) {
  auto given = detail::fit_with_lens(input);
  if (!given || given->calibration.verdict == Verdict::excellent) return given;
  auto lens = better_lens(input);
  if (!lens) return given;
  const std::string figures = " (" + figure(lens->given_px, 2) + " px on the pictures alone, " +
                              figure(lens->fit.calibration.holdout_rms_px, 2) + " px with one calibrated from them";
  if (input.keep_lens) {
    given->why += "; the given lens does not fit these pictures" + figures + ")";
    return given;
  }
  HandeyeInput other = input;
  other.lens = lens->fit.calibration.lens;
  auto own = detail::fit_with_lens(other);
  if (!own || !arm_agrees(*given, *own)) {
    if (given->fault.empty())
      given->why +=
          "; the given lens does not fit these pictures" + figures + "), but the arm's poses agree better with it";
    return given;
  }
  own->why += "; made with a lens from these pictures, because the given one does not fit them" + figures + ")";
  own->own_lens = std::move(lens->fit);
  return own;
}

}  // namespace pickcell::poses
