#include "pickcell/cli/experiment/faults_soak.hpp"

#include <algorithm>
#include <memory>
#include <optional>
#include <utility>

#include "pickcell/cli/cell/setup.hpp"
#include "pickcell/cli/cell/start_demo.hpp"
#include "pickcell/cli/experiment/faults_audit.hpp"
#include "pickcell/cli/experiment/faults_journal.hpp"
#include "pickcell/cli/experiment/faults_watch.hpp"
#include "pickcell/robot/hses_client.hpp"
#include "pickcell/robot/tcp80_client.hpp"
#include "pickcell/sim/controller_contacts.hpp"

namespace pickcell::cli {

using namespace std::chrono_literals;
using cell::Mode;
using cell::Snapshot;
using core::ErrorCode;
using robot::CommandState;

namespace {

constexpr double kLongestStandstill_s = 600;  // simulated, without anything dealt with

/// The person at the cell: presses Start and Reset, puts things right at the controller, starts the PC again, and
/// notes what is not as it should be. Everything happens on the simulated clock.
class Soak {
 public:
  explicit Soak(FaultSoakOptions options) : options_(std::move(options)), dice_(options_.seed) {}
  ~Soak() { setup_.cell.reset(); }
  Soak(const Soak&) = delete;
  Soak& operator=(const Soak&) = delete;

  core::Result<FaultSoakReport> run() {
    const auto began = std::chrono::steady_clock::now();
    if (auto ready = set_up(); !ready) return core::forward(ready);
    core::TimePoint progress = person_->now();
    for (int told = 0; report_.parts < options_.picks;) {
      const int parts = report_.parts;
      if (auto gone_on = step(); !gone_on) return core::forward(gone_on);
      if (report_.parts != parts) progress = person_->now();
      if (core::seconds(person_->now() - progress) > kLongestStandstill_s) {
        auto standstill = stuck();
        return core::forward(standstill);
      }
      if (options_.progress && report_.parts / 100 > told) options_.progress(100 * (told = report_.parts / 100));
    }
    if (auto ended = finish(); !ended) return core::forward(ended);
    report_.simulated_s = core::seconds(setup_.clock->now());
    report_.wall_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count();
    return std::move(report_);
  }

 private:
  // --- the cell ---

  core::Status set_up() {
    std::error_code ignored;
    const std::filesystem::path folder = options_.folder / "cell";
    std::filesystem::remove_all(folder, ignored);
    DemoOptions demo;
    demo.seed = options_.seed;
    demo.now_unix_us = core::SimulatedClock().unix_us();
    demo.camera_width_px = 640;  // a quarter of the pixels: thousands of pictures are searched
    demo.camera_height_px = 512;
    auto made = prepare_demo(folder, demo);
    if (!made) return core::forward(made);
    auto file = load_cell_file(*made);
    if (!file) return core::forward(file);
    file_ = std::move(*file);
    file_.sim.seed = options_.seed;
    run_.stop_after_picks = 1'000'000'000;  // starts by itself; the person says when it is enough
    run_.open_link = [this](const sim::Controller& controller) { return link(controller); };
    run_.around_journal = [this](robot::Journal& journal) -> robot::Journal& {
      mortal_ = std::make_unique<MortalJournal>(journal);
      return *mortal_;
    };
    run_.around_world = [this](sim::World& world) -> sim::Plant& {
      watch_ = std::make_unique<GripWatch>(world);
      return *watch_;
    };
    auto setup = set_up_cell(file_, run_);
    if (!setup) return core::forward(setup);
    setup_ = std::move(*setup);
    watch_->of(controller());
    person_ = setup_.clock->join("person");
    return live();
  }

  /// Every start of the PC may speak another protocol: the registers are the same.
  std::unique_ptr<robot::ControllerLink> link(const sim::Controller& controller) {
    hses_ =
        options_.protocols == SoakProtocols::hses || (options_.protocols == SoakProtocols::both && dice_.chance(0.5));
    if (hses_) {
      robot::HsesSettings settings;
      settings.host = "127.0.0.1";
      settings.port = controller.hses_port();
      settings.timeout = std::max<std::chrono::milliseconds>(options_.answer_timeout / settings.tries, 1ms);
      return std::make_unique<robot::HsesClient>(settings);
    }
    robot::Tcp80Settings settings;
    settings.host = "127.0.0.1";
    settings.port = controller.tcp80_port();
    settings.line_timeout = settings.result_timeout = options_.answer_timeout;
    return std::make_unique<robot::Tcp80Client>(settings);
  }

  /// A PC that was just started: until it picks, or stands with a reason.
  core::Status live() {
    ++report_.pc_starts;
    try_outside();
    auto rows = setup_.journal->newest_rows(10 * options_.picks + 1000);
    if (!rows) return core::forward(rows);
    ended_before_ = static_cast<int>(std::count_if(rows->begin(), rows->end(), ended));
    looks_before_ = report_.looks;
    submitted_seen_ = 0;
    remove_old_runs();
    setup_.cell->open();
    const Snapshot s = wait_until(decided);
    if (s.mode != Mode::fault) return {};
    expect_words(s, s.reason);
    return recover();
  }

  core::Status restart() {
    strikes_.reset();
    put_right();
    if (auto made = restart_pc(setup_, file_, run_); !made) return made;
    return live();
  }

  static bool ended(const robot::JournalRow& row) {
    return row.state == CommandState::done || row.state == CommandState::refused || row.state == CommandState::unknown;
  }

  void remove_old_runs() const {
    std::vector<std::filesystem::path> runs;
    std::error_code ignored;
    for (const auto& entry : std::filesystem::directory_iterator(file_.cell.state_dir / "runs", ignored))
      if (entry.path() != setup_.cell->ledger().run_folder()) runs.push_back(entry.path());
    for (const auto& run : runs) std::filesystem::remove_all(run, ignored);
  }

  // --- 50 ms of the cell's time ---

  core::Status step() {
    person_->sleep_for(cell::Arm::kPoll);
    const Snapshot s = setup_.cell->snapshot();
    watch_box();
    report_.parts = ended_before_ + static_cast<int>(s.counters.placed + s.counters.missed + s.counters.unknown);
    report_.looks = looks_before_ + static_cast<int>(s.counters.frames);
    if (s.counters.submitted != submitted_seen_) {
      submitted_seen_ = s.counters.submitted;
      ++report_.submitted;
      report_.over_hses += hses_;
      begin_pick();
    }
    if (mortal_->dead()) return restart();
    if (strikes_ && person_->now() >= *strikes_) {
      strikes_.reset();
      if (fault_ != SoakFault::power_loss) return restart();
      kill();
    }
    if (s.mode == Mode::fault) {
      judge(stop_of(s));
      return dice_.chance(0.1) ? restart() : recover();
    }
    if (s.mode == Mode::idle) (void)setup_.cell->start();  // no parts, or a full tray
    return {};
  }

  void begin_pick() {
    before_ = std::exchange(fault_, std::nullopt);
    strikes_.reset();
    mortal_->forget();
    controller().follow({});
    watch_->blind(dice_.chance(options_.blind_rate));
    if (dice_.chance(options_.fault_rate)) choose_fault();
    const auto newest = setup_.journal->newest_rows(1);
    if (fault_ && newest && !newest->empty()) fault_of_pick_[newest->front().sequence] = *fault_;
  }

  void choose_fault() {
    const auto fault = static_cast<SoakFault>(dice_.below(kSoakFaults));
    fault_ = fault;
    ++report_.injected[static_cast<std::size_t>(fault)];
    if (auto event = scenario_event(fault, dice_)) {
      controller().follow({*event});
    } else if (fault == SoakFault::power_loss && dice_.chance(0.4)) {
      mortal_->at_commit(1 + dice_.below(3), dice_.chance(0.5), [this] {
        kill();
        return false;
      });
    } else if (fault == SoakFault::pc_dies_at_journal) {
      mortal_->at_commit(1 + dice_.below(3), dice_.chance(0.5), [] { return true; });
    } else {
      strikes_ = person_->now() + core::duration_s(dice_.unit() * kPickLength_s);
    }
  }

  void kill() {
    controller().kill();
    killed_ = true;
  }

  // --- stops ---

  static Stop stop_of(const Snapshot& s) {
    for (const cell::CellAlarm& alarm : s.alarms)
      if (alarm.active && alarm.cause == s.reason) return {alarm.code, s.reason, s.remedy};
    return {"", s.reason, s.remedy};
  }

  void judge(const Stop& stop) {
    ++report_.stops;
    const bool slow = stop.code == "LINK_TIMEOUT";  // the machine was busy: said in words, though nobody ordered it
    const bool named = (fault_ && explains(stop, *fault_)) || (before_ && explains(stop, *before_)) || slow;
    if (named && !stop.why.empty() && !stop.remedy.empty())
      ++report_.stops_explained;
    else
      report_.note("stop not explained after " + std::string(fault_ ? name(*fault_) : "no fault") + ": " + stop.code +
                   ": " + stop.why + "; " + stop.remedy);
    if (stop.code.starts_with("ROBOT_")) expect_rest(stop);
  }

  /// An arm that a person stopped stays where it is, also when somebody presses Start.
  void expect_rest(const Stop& stop) {
    person_->sleep_for(300ms);  // the ramps
    const sim::Joints before = controller().copy_of_state().q;
    if (setup_.cell->start()) finding(report_.forbidden_motions, "started in fault: " + stop.code);
    const bool stays = fault_ == SoakFault::estop || fault_ == SoakFault::teach || fault_ == SoakFault::hold;
    if (stays && dice_.chance(0.3) && setup_.cell->reset()) {
      wait_for_reset();
      if (setup_.cell->start() && wait_until(decided).mode == Mode::running)
        finding(report_.forbidden_motions, "started in spite of " + stop.code);
    }
    person_->sleep_for(1s);
    if (!controller().copy_of_state().q.isApprox(before, 1e-9))
      finding(report_.forbidden_motions, "the arm moved after " + stop.code);
  }

  void put_right() {
    fault_.reset();
    controller().follow({});
    if (std::exchange(killed_, false) && !controller().revive()) report_.note("the controller's ports are gone");
    controller().with_state([](sim::ControllerState& s) {
      s.hold_pendant = false;
      s.release_emergency_stop();
      s.reset_at_pendant();
      if (!s.remote) s.turn_key_to_remote();  // which switches the servo off
    });
  }

  /// Reset and Start until the cell runs.
  core::Status recover() {
    strikes_.reset();
    mortal_->forget();
    put_right();
    constexpr int kTries = 8;
    for (int tries = 0; tries < kTries; ++tries) {
      if (tries >= 2)  // asked to take a part out of the gripper
        controller().with_state([](sim::ControllerState& s) { sim::set_output(s, sim::kGripperOutput, false); });
      (void)setup_.cell->reset();
      wait_for_reset();
      if (auto started = setup_.cell->start(); !started) {
        expect_words(setup_.cell->snapshot(), started.error().line());
        continue;
      }
      const Snapshot s = wait_until(decided);
      if (s.mode == Mode::running) return {};
      expect_words(s, s.reason);
    }
    return core::failure(ErrorCode::timeout, "soak",
                         "the cell does not come out of a stop: " + setup_.cell->snapshot().reason);
  }

  void wait_for_reset() {
    person_->sleep_for(3 * cell::Arm::kPoll);
    (void)wait_until([](const Snapshot& s) { return s.step != "resetting"; });
  }

  void expect_words(const Snapshot& s, const std::string& told) {
    if (!told.empty() && (s.mode != Mode::fault || (!s.reason.empty() && !s.remedy.empty()))) return;
    ++report_.stops;
    report_.note("no reason or remedy while starting: " + s.reason);
  }

  /// Start has led to something.
  static bool decided(const Snapshot& s) {
    return s.mode == Mode::fault || (s.mode == Mode::running && s.step != "starting the robot's job");
  }

  template <class Condition>
  Snapshot wait_until(Condition condition) {
    constexpr int kPolls = 2400;  // two minutes
    Snapshot s = setup_.cell->snapshot();
    for (int i = 0; i < kPolls && !condition(s); ++i) {
      person_->sleep_for(cell::Arm::kPoll);
      s = setup_.cell->snapshot();
    }
    return s;
  }

  // --- the box ---

  void watch_box() {
    const Eigen::Vector3d tool_mm = controller().T_base_tool().translation_m() * 1e3;
    constexpr double kRounding_mm = 0.01;
    for (std::size_t i = 0; i < 3; ++i) {
      const double v = tool_mm(static_cast<Eigen::Index>(i));
      if (v < file_.cell.limits.box_min_mm[i] - kRounding_mm || v > file_.cell.limits.box_max_mm[i] + kRounding_mm)
        return finding(report_.forbidden_motions, "the tool is outside the box");
    }
  }

  /// A pick outside the box must end in the driver: nothing written.
  void try_outside() {
    picks::Pick p;
    Eigen::Matrix3d down;
    down << 1, 0, 0, 0, -1, 0, 0, 0, -1;
    p.T_base_grasp = p.T_base_place = {down, Eigen::Vector3d(0.45, 0, 0)};
    Eigen::Vector3d out(0.45, 0, 0);
    const int axis = dice_.below(3);
    const auto& limits = file_.cell.limits;
    out(axis) = dice_.chance(0.5) ? limits.box_min_mm[static_cast<std::size_t>(axis)] * 1e-3 - 0.001
                                  : limits.box_max_mm[static_cast<std::size_t>(axis)] * 1e-3 + 0.001;
    (dice_.chance(0.5) ? p.T_base_grasp : p.T_base_place) = {down, out};
    const sim::ControllerState before = controller().copy_of_state();
    const auto answer = setup_.robot->submit(p);
    const sim::ControllerState after = controller().copy_of_state();
    if (answer || answer.error().code != ErrorCode::safety)
      finding(report_.forbidden_motions, "a pick outside the box was taken");
    else if (before.D != after.D || before.I != after.I || before.B != after.B)
      finding(report_.forbidden_motions, "a pick outside the box reached the controller");
    else
      ++report_.outside_refused;
  }

  // --- the record ---

  core::Status finish() {
    put_right();
    if (auto stopped = setup_.cell->stop_cycle(); !stopped) return stopped;
    const Snapshot s =
        wait_until([](const Snapshot& now) { return now.mode == Mode::idle || now.mode == Mode::fault; });
    if (s.mode == Mode::fault) {
      if (auto recovered = recover(); !recovered) return recovered;
      if (auto stopped = setup_.cell->stop_cycle(); !stopped) return stopped;
      (void)wait_until([](const Snapshot& now) { return now.mode == Mode::idle; });
    }
    setup_.cell->close();
    auto rows = setup_.journal->newest_rows(10 * options_.picks + 1000);
    if (!rows) return core::forward(rows);
    audit_rows(*rows, watch_->closings(), fault_of_pick_, report_);
    audit_parts(setup_.plant->world, setup_.clock->now(), report_);
    return {};
  }

  core::Status stuck() {
    const Snapshot s = setup_.cell->snapshot();
    return core::failure(ErrorCode::timeout, "soak",
                         std::string("nothing goes on: ") + cell::name(s.mode) + ", " + s.step + ", " + s.reason);
  }

  void finding(int& count, const std::string& text) { report_.finding(count, text); }
  sim::Controller& controller() { return *setup_.plant->controller; }

  FaultSoakOptions options_;
  FaultSoakReport report_;
  Dice dice_;
  CellFile file_;
  CellRunOptions run_;
  std::unique_ptr<GripWatch> watch_;
  std::unique_ptr<MortalJournal> mortal_;
  CellSetup setup_;
  std::unique_ptr<core::Seat> person_;
  bool hses_ = false, killed_ = false;
  std::optional<SoakFault> fault_;   ///< of this pick
  std::optional<SoakFault> before_;  ///< of the pick before: it may strike late
  FaultOfPick fault_of_pick_;
  std::optional<core::TimePoint> strikes_;  ///< when the controller's power or the PC goes
  std::int64_t submitted_seen_ = 0;
  int ended_before_ = 0, looks_before_ = 0;  ///< by earlier processes
};

}  // namespace

core::Result<FaultSoakReport> run_fault_soak(const FaultSoakOptions& options) {
  if (options.picks < 1 || options.picks > 1'000'000)
    return core::failure(ErrorCode::usage, "--n", "1 to 1000000 picks", "");
  return Soak(options).run();
}

}  // namespace pickcell::cli
