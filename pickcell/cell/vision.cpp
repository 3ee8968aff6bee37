#include "pickcell/cell/vision.hpp"

#include <chrono>

#include "pickcell/core/units.hpp"
#include "pickcell/poses/moving_view.hpp"

namespace pickcell::cell {

namespace {

/// A candidate that failed the threshold is worth a word only when it came close.
constexpr double kNearThreshold = 0.85;

double ms_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
}

}  // namespace

Vision::Vision(std::unique_ptr<matches::Engine> engine, std::vector<matches::Model> models, Settings settings)
    : engine_(std::move(engine)), models_(std::move(models)), settings_(std::move(settings)) {
  for (const matches::Model& model : models_) {
    searched_.push_back(&model);
    locators_.emplace_back(model);
  }
  engine_->prepare(searched_, search_options());
  fixed_view_.lens = settings_.camera.lens;
  fixed_view_.T_base_camera = settings_.plane.T_base_camera;
  fixed_view_.T_base_plane = settings_.plane.T_base_plane;
  fixed_view_.sigma_position_m = core::m_from_mm(settings_.plane.sigma.place_mm);
  fixed_view_.sigma_turn_rad = core::rad_from_deg(settings_.plane.sigma.turn_deg);
}

core::Result<poses::View> Vision::view_of(const frames::Frame& frame) const {
  const poses::CalibrationUse use{frame.picture->width(), frame.picture->height(), frame.camera_id,
                                  settings_.max_age_days, frame.exposed_unix_us};
  const auto& handeye = settings_.handeye;
  auto fits = handeye ? poses::check_fits(settings_.camera, *handeye, use)
                      : poses::check_fits(settings_.camera, settings_.plane, use);
  if (!fits) return core::forward(fits);
  if (!handeye) return fixed_view_;
  return poses::view_at_exposure(settings_.camera, *handeye, settings_.plane.T_base_plane, frame.T_base_flange);
}

void Vision::judge_one(Sight& sight, Sight::Seen& seen, const frames::Frame& frame,
                       const core::Result<poses::View>& view) const {
  const auto index = static_cast<std::size_t>(seen.match.model_index);
  seen.rejection = judge(seen.match, models_[index]);
  if (!view) seen.rejection = Rejection{"calibration", view.error().line()};
  if (seen.rejection) return;
  auto pose = locators_[index].locate(seen.match, *view);
  if (!pose) {
    seen.rejection = Rejection{"not_on_plane", pose.error().line()};
    return;
  }
  pose->model_index = seen.match.model_index;
  pose->ambiguous_deg = open_ambiguities_deg(seen.match, models_[index]);
  pose->detection_id = seen.detection_id;
  pose->frame_sequence = frame.sequence;
  pose->exposed = frame.exposed;
  sight.parts.push_back(std::move(*pose));
}

matches::SearchOptions Vision::search_options() const {
  matches::SearchOptions options;
  options.max_matches = settings_.max_matches;
  options.threads = settings_.threads;
  options.explain = true;
  return options;
}

core::Result<Sight> Vision::look(const frames::Frame& frame, std::uint64_t first_id) {
  Sight sight;
  const auto start = std::chrono::steady_clock::now();
  pyramid_.build(frame.picture->view());
  if (auto found = engine_->find_into(pyramid_, searched_, search_options(), found_); !found)
    return core::forward(found);
  sight.match_ms = ms_since(start);

  const auto view = view_of(frame);
  if (!view) sight.unfit = view.error();
  for (const matches::Match& match : found_.matches) {
    sight.seen.push_back({first_id++, match, {}});
    judge_one(sight, sight.seen.back(), frame, view);
  }
  for (const matches::Rejected& rejected : found_.rejected) {
    if (rejected.reason != matches::RejectReason::score || rejected.stage != matches::Stage::final) continue;
    const matches::Model& model = models_[static_cast<std::size_t>(rejected.match.model_index)];
    if (rejected.match.score < kNearThreshold * model.learnt.suggested_min_score) continue;
    sight.seen.push_back({first_id++, rejected.match, judge(rejected.match, model)});
  }
  return sight;
}

}  // namespace pickcell::cell
