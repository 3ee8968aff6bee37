#pragma once
/// A cell put together from its CELL.toml, with real or simulated camera and robot. The only place that knows which.

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "pickcell/cell/cell.hpp"
#include "pickcell/cell/cell_config.hpp"
#include "pickcell/cell/journal.hpp"
#include "pickcell/cli/robot/link.hpp"
#include "pickcell/core/clock.hpp"
#include "pickcell/core/result.hpp"
#include "pickcell/frames/frame_source.hpp"
#include "pickcell/matches/engine.hpp"
#include "pickcell/robot/robot.hpp"
#include "pickcell/sim/camera.hpp"
#include "pickcell/sim/controller.hpp"
#ifdef PICKCELL_WITH_ARAVIS
#include "pickcell/sim/gige_camera.hpp"
#endif
#include "pickcell/sim/world.hpp"

namespace pickcell::cli {

/// [sim] of CELL.toml: what the simulated plant is like, for source = "sim" and link = "sim".
struct SimulationConfig {
  std::uint64_t seed = 1;
  std::vector<std::string> kinds = {"bracket_l", "gear_18", "label_box"};
  int parts_per_pitch = 4;
  int camera_width_px = 1280;  ///< over the same field of view
  int camera_height_px = 1024;
  RobotProtocol protocol = RobotProtocol::tcp80;  ///< spoken with the simulated controller; not in the file
  bool camera_over_gige = false;  ///< the camera is reached through GigE Vision on loopback, as a real one
  double segment_pause_s = 0;     ///< wall time between the controller's OK and its result; real ones need some
};

/// The whole of a cell file.
struct CellFile {
  cell::CellConfig cell;
  SimulationConfig sim;
  [[nodiscard]] bool wholly_simulated() const { return cell.camera.source == "sim" && cell.robot.link == "sim"; }
};

/// Errors name the file and the key. Whether camera and robot can be reached is not asked.
[[nodiscard]] core::Result<CellFile> read_cell_file(const std::filesystem::path& path);
/// The same for a cell that is to run: sources and links that this build does not have are refused.
[[nodiscard]] core::Result<CellFile> load_cell_file(const std::filesystem::path& path);

/// The simulated plant: world, camera and controller. The controller answers on a loopback port of its own.
struct SimulatedPlant {
  /// camera_id: how the camera calls itself; empty: as the simulation does.
  SimulatedPlant(const SimulationConfig& config, const std::string& camera_id, const core::Clock& clock);
  sim::World world;
  sim::SimulatedCamera camera;
#ifdef PICKCELL_WITH_ARAVIS
  std::unique_ptr<sim::GigeCamera> gige;  ///< null unless the camera is reached over GigE Vision
#endif
  std::unique_ptr<sim::Controller> controller;  ///< null unless the link is simulated
};

struct CellRunOptions {
  std::int64_t stop_after_picks = 0;  ///< > 0: starts by itself and stands when so many are dealt with
  std::string engine = "best";        ///< of the matcher, with its settings
  matches::Settings engine_settings{};

  // What experiments put between the parts of a wholly simulated cell; empty: nothing. What is returned must outlive
  // the cell.
  std::function<std::unique_ptr<robot::ControllerLink>(const sim::Controller&)> open_link{};
  std::function<robot::Journal&(robot::Journal&)> around_journal{};
  std::function<sim::Plant&(sim::World&)> around_world{};
};

/// Everything that lives as long as the cell does. Each member stands on those above it, so it is torn down from the
/// last to the first, also when another one is assigned.
struct CellSetup {
  CellSetup() = default;
  CellSetup(CellSetup&&) = default;
  CellSetup& operator=(CellSetup&& other) noexcept;
  ~CellSetup() = default;

  std::unique_ptr<core::Clock> clock;
  std::unique_ptr<SimulatedPlant> plant;        ///< null for a real cell
  std::unique_ptr<frames::FrameSource> source;  ///< null when the plant's camera is used
  std::unique_ptr<frames::FrameSource> paced;   ///< source on a simulated clock, where it is a device
  std::unique_ptr<cell::SqliteJournal> journal;
  std::unique_ptr<robot::Robot> robot;
  std::unique_ptr<cell::Cell> cell;
};

/// A wholly simulated cell that stops by itself runs on a simulated clock, everything else in real time. Refuses
/// calibrations that do not fit the camera, unreadable models, links and sources that cannot be opened. The robot is
/// not connected yet: cell->open() does that.
[[nodiscard]] core::Result<CellSetup> set_up_cell(const CellFile& file, const CellRunOptions& options);

/// The PC's part made anew on the same clock and plant, as after a new start of the process: only files survive.
/// Whoever calls holds a seat on a simulated clock, so that time stands meanwhile.
[[nodiscard]] core::Status restart_pc(CellSetup& setup, const CellFile& file, const CellRunOptions& options);

}  // namespace pickcell::cli
