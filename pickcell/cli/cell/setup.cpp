#include "pickcell/cli/cell/setup.hpp"

#include <utility>

#include "pickcell/cli/cell/calibration.hpp"
#include "pickcell/cli/cell/job.hpp"
#include "pickcell/cli/cell/models.hpp"
#include "pickcell/cli/cell/paced_source.hpp"
#include "pickcell/cli/robot/link.hpp"
#include "pickcell/frames/open_source.hpp"
#include "pickcell/matches/engine.hpp"
#include "pickcell/poses/calibration.hpp"
#include "pickcell/robot/job_robot.hpp"
#include "pickcell/sim/shipped_jobs.hpp"

namespace pickcell::cli {

using core::ErrorCode;
using core::failure;

namespace {

SimulationConfig read_simulation(core::Config table) {
  SimulationConfig out;
  const std::int64_t seed = table.integer_or("seed", 1);
  if (seed < 0) table.problem("seed", "must not be negative");
  out.seed = static_cast<std::uint64_t>(seed);
  out.kinds = table.strings_or("kinds", out.kinds);
  for (const std::string& kind : out.kinds)
    if (!sim::is_part_kind(kind)) table.problem("kinds", "names '" + kind + "', which no simulated part is called");
  out.parts_per_pitch = static_cast<int>(table.integer_or("parts_per_pitch", out.parts_per_pitch));
  out.camera_width_px = static_cast<int>(table.integer_or("camera_width_px", out.camera_width_px));
  out.camera_height_px = static_cast<int>(table.integer_or("camera_height_px", out.camera_height_px));
  if (out.camera_width_px < 160 || out.camera_width_px > 4096)
    table.problem("camera_width_px", "must be within 160 and 4096");
  if (out.camera_height_px < 120 || out.camera_height_px > 4096)
    table.problem("camera_height_px", "must be within 120 and 4096");
  if (out.parts_per_pitch < 1 || out.parts_per_pitch > 20) table.problem("parts_per_pitch", "must be within 1 and 20");
  out.segment_pause_s = table.number_or("segment_pause_s", 0);
  if (out.segment_pause_s < 0) table.problem("segment_pause_s", "must not be negative");
  return out;
}

core::Status check_source(const std::string& source, const std::filesystem::path& file) {
  if (source == "sim") return {};
  auto known = frames::check_source(source);
  if (known) return {};
  return failure(ErrorCode::usage, file.string(), "'camera.source' = \"" + source + "\": " + known.error().why,
                 known.error().remedy);
}

/// The address behind [robot] link, in a protocol that can carry picks.
core::Result<RobotAddress> parse_link(const CellFile& file) {
  const std::string where = file.cell.file.string() + ": 'robot.link'";
  auto address = parse_robot_link(file.cell.robot.link, where);
  if (!address) return address;
  if (address->protocol == RobotProtocol::motoros)
    return failure(ErrorCode::usage, where, "MotoROS has no variables and no jobs, which picking needs",
                   "use tcp80:// or hses://");
  return address;
}

core::Result<cell::Vision> make_vision(const cell::CellConfig& config, cell::Vision::Settings calibration,
                                       const frames::SourceInfo& source, std::int64_t now_unix_us,
                                       const CellRunOptions& options) {
  const poses::CalibrationUse use{source.width_px, source.height_px, source.camera_id, config.calibration.max_age_days,
                                  now_unix_us};
  auto fits = calibration.handeye ? poses::check_fits(calibration.camera, *calibration.handeye, use)
                                  : poses::check_fits(calibration.camera, calibration.plane, use);
  if (!fits) return core::forward(fits);
  auto models = load_models(config);
  if (!models) return core::forward(models);
  auto engine = matches::make_engine(options.engine, options.engine_settings);
  if (!engine) return core::forward(engine);
  return cell::Vision(std::move(*engine), std::move(*models), std::move(calibration));
}

sim::WorldSettings world_settings(const SimulationConfig& config) {
  sim::WorldSettings settings = sim::default_world(config.seed);
  settings.feed.kinds = config.kinds;
  settings.feed.parts_per_pitch = config.parts_per_pitch;
  return settings;
}

sim::CameraSettings camera_settings(const SimulationConfig& config, const std::string& id, const sim::World& world) {
  sim::CameraSettings settings = sim::resized(sim::default_camera(world.settings().T_base_plane, config.seed),
                                              config.camera_width_px, config.camera_height_px);
  if (!id.empty()) settings.camera_id = id;
  return settings;
}

core::Status switch_on_controller(CellSetup& setup, const CellFile& file, const CellRunOptions& options) {
  sim::ControllerSettings settings;
  settings.segment_pause_s = file.sim.segment_pause_s;
  auto job = job_for(file.cell);
  if (!job) return core::forward(job);
  settings.jobs = sim::shipped_jobs();
  settings.jobs.front() = std::move(*job);
  settings.model = *sim::arm_model(file.cell.robot.model);  // checked at load
  sim::World& world = setup.plant->world;
  sim::Plant& wired = options.around_world ? options.around_world(world) : world;
  auto controller = sim::Controller::switch_on(settings, *setup.clock, &wired);
  if (!controller) return core::forward(controller);
  setup.plant->controller = std::move(*controller);
  return {};
}

core::Result<RobotAddress> robot_address(CellSetup& setup, const CellFile& file, const CellRunOptions& options) {
  if (file.cell.robot.link != "sim") return parse_link(file);
  if (!setup.plant->controller)
    if (auto on = switch_on_controller(setup, file, options); !on) return core::forward(on);
  const sim::Controller& controller = *setup.plant->controller;
  const bool hses = file.sim.protocol == RobotProtocol::hses;
  return RobotAddress{file.sim.protocol, "127.0.0.1", hses ? controller.hses_port() : controller.tcp80_port()};
}

core::Status make_robot(CellSetup& setup, const CellFile& file, const CellRunOptions& options) {
  auto address = robot_address(setup, file, options);
  if (!address) return core::forward(address);
  using Link = core::Result<std::unique_ptr<robot::ControllerLink>>;
  Link link = options.open_link ? Link(options.open_link(*setup.plant->controller))
                                : open_controller_link(*address, file.cell.file.string());
  if (!link) return core::forward(link);
  robot::JobRobotSettings settings;
  settings.frame = file.cell.robot.frame;
  settings.tool = file.cell.robot.tool;
  settings.limits.box_min_mm = file.cell.limits.box_min_mm;
  settings.limits.box_max_mm = file.cell.limits.box_max_mm;
  settings.limits.approach_mm = file.cell.limits.approach_mm;
  auto opened = cell::SqliteJournal::open(file.cell.state_dir / "journal.db");
  if (!opened) return core::forward(opened);
  setup.journal = std::move(*opened);
  if (file.cell.robot.link != "sim")
    if (auto written = write_job(file.cell); !written) return written;
  robot::Journal& journal = options.around_journal ? options.around_journal(*setup.journal) : *setup.journal;
  setup.robot = std::make_unique<robot::JobRobot>(settings, std::move(*link), journal, *setup.clock);
  return {};
}

/// The simulated camera as a device: served on loopback, opened like any other.
core::Result<frames::FrameSource*> make_gige_source(CellSetup& setup) {
#ifdef PICKCELL_WITH_ARAVIS
  const sim::CameraSettings& camera = setup.plant->camera.settings();
  auto served = sim::GigeCamera::switch_on({}, setup.plant->camera, *setup.clock);
  if (!served) return core::forward(served);
  setup.plant->gige = std::move(*served);
  frames::SourceOptions options;
  options.camera_id = camera.camera_id;
  options.settings.trigger = "software";
  // While it renders, the served camera answers no questions; on a busy machine that takes a while.
  options.lost_after = std::chrono::seconds(20);
  auto opened = frames::open_source(setup.plant->gige->source(), options, *setup.clock);
  if (!opened) return core::forward(opened);
  setup.source = std::move(*opened);
  if (!setup.clock->simulated()) return setup.source.get();
  setup.paced = std::make_unique<PacedSource>(*setup.source, core::duration_s(camera.exposure_us * 1e-6),
                                              core::duration_s(camera.readout_us * 1e-6));
  return setup.paced.get();
#else
  (void)setup;
  return failure(ErrorCode::usage, "--camera gige", "this build has no support for GigE Vision",
                 "build with -DPICKCELL_WITH_ARAVIS=ON (./start --camera gige does)");
#endif
}

core::Result<frames::FrameSource*> make_source(CellSetup& setup, const CellFile& file) {
  const cell::CameraConfig& camera = file.cell.camera;
  if (camera.source == "sim") {
    if (file.sim.camera_over_gige) return make_gige_source(setup);
    return &setup.plant->camera;
  }
  frames::SourceOptions options;
  options.camera_id = camera.id;
  options.fps = camera.fps;
  options.loop = camera.loop;
  options.base = std::filesystem::absolute(file.cell.file).parent_path();
  options.settings = camera.settings;
  auto opened = frames::open_source(camera.source, options, *setup.clock);
  if (!opened) return core::forward(opened);
  setup.source = std::move(*opened);
  return setup.source.get();
}

}  // namespace

CellSetup& CellSetup::operator=(CellSetup&& other) noexcept {
  // Memberwise assignment would take the clock away from under the cell first.
  CellSetup old(std::move(*this));
  clock = std::move(other.clock);
  plant = std::move(other.plant);
  source = std::move(other.source);
  paced = std::move(other.paced);
  journal = std::move(other.journal);
  robot = std::move(other.robot);
  cell = std::move(other.cell);
  return *this;
}

core::Result<CellFile> read_cell_file(const std::filesystem::path& path) {
  auto config = core::Config::load(path);
  if (!config) return core::forward(config);
  CellFile out;
  out.cell = cell::read_cell_config(*config, path);
  out.sim = read_simulation(config->table("sim"));
  if (auto finished = config->finish(); !finished) return core::forward(finished);
  return out;
}

core::Result<CellFile> load_cell_file(const std::filesystem::path& path) {
  auto file = read_cell_file(path);
  if (!file) return file;
  CellFile& out = *file;
  if (auto known = check_source(out.cell.camera.source, path); !known) return core::forward(known);
  if (out.cell.robot.link == "sim" && !sim::arm_model(out.cell.robot.model))
    return failure(ErrorCode::usage, path.string(),
                   "'robot.model' is \"" + out.cell.robot.model + "\", which no simulated arm is",
                   "use gp7, gp8 or motomini");
  if (out.cell.robot.link != "sim")
    if (auto link = parse_link(out); !link) return core::forward(link);
  return file;
}

SimulatedPlant::SimulatedPlant(const SimulationConfig& config, const std::string& camera_id, const core::Clock& clock)
    : world(world_settings(config)), camera(camera_settings(config, camera_id, world), world, clock) {}

core::Result<CellSetup> set_up_cell(const CellFile& file, const CellRunOptions& options) {
  CellSetup setup;
  const bool may_jump = file.wholly_simulated() && options.stop_after_picks > 0;
  if (may_jump)
    setup.clock = std::make_unique<core::SimulatedClock>();
  else
    setup.clock = std::make_unique<core::RealClock>();
  if (file.cell.camera.source == "sim" || file.cell.robot.link == "sim")
    setup.plant = std::make_unique<SimulatedPlant>(file.sim, file.cell.camera.id, *setup.clock);
  if (auto made = restart_pc(setup, file, options); !made) return core::forward(made);
  return setup;
}

core::Status restart_pc(CellSetup& setup, const CellFile& file, const CellRunOptions& options) {
  setup.cell.reset();
  setup.robot.reset();
  setup.journal.reset();
  setup.paced.reset();
  setup.source.reset();
  // The cell's seat first: simulated time stands still until the cell itself waits.
  auto seat = setup.clock->join("cell");

  auto source = make_source(setup, file);
  if (!source) return core::forward(source);
  auto calibration = load_calibration(file.cell.calibration);
  if (!calibration) return core::forward(calibration);
  auto check = camera_check(file.cell.calibration, *calibration);
  if (!check) return core::forward(check);
  auto vision = make_vision(file.cell, std::move(*calibration), (*source)->info(), setup.clock->unix_us(), options);
  if (!vision) return core::forward(vision);
  cell::CellSettings settings = cell::settings_from(file.cell, vision->models());
  settings.simulated = setup.plant != nullptr;
  settings.stop_after_picks = options.stop_after_picks;
  settings.start_at_once = options.stop_after_picks > 0;
  settings.board_is_taken_away = file.cell.calibration.verify_at_start == cell::VerifyAtStart::board_is_taken_away;
  settings.T_flange_tool = flange_tool(file.cell.calibration);
  if (settings.start_at_once && !settings.allow_motion)
    return failure(ErrorCode::usage, file.cell.file.string(), "motion is not allowed by this cell file",
                   "set allow_motion = true in [robot]");
  if (settings.start_at_once && settings.board_is_taken_away)
    return failure(ErrorCode::usage, file.cell.file.string(), "nobody is there to take the board away with --picks",
                   "mount the board in the picture (verify_at_start = \"board_stays\"), or run with the page");
  if (auto robot = make_robot(setup, file, options); !robot) return core::forward(robot);
  auto log = cell::RunLog::create(
      file.cell.state_dir / "runs",
      {file.cell.name, std::filesystem::absolute(file.cell.file), (*source)->info().camera_id, file.cell.robot.link,
       vision->engine_name(), setup.clock->unix_us(), settings.simulated, cell::files_of(file.cell)},
      file.cell.record_frames);
  if (!log) return core::forward(log);
  setup.cell = std::make_unique<cell::Cell>(
      cell::CellParts{*setup.clock, std::move(seat), **source, *setup.robot, std::move(*vision), std::move(*log),
                      setup.journal.get(), std::move(*check)},
      std::move(settings));
  return {};
}

}  // namespace pickcell::cli
