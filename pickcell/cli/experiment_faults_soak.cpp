#include "pickcell/cli/experiment_faults_soak.hpp"

#include <algorithm>
#include <map>
#include <memory>
#include <optional>
#include <random>
#include <set>
#include <stdexcept>
#include <utility>

#include "pickcell/cell/halt.hpp"
#include "pickcell/cell/journal.hpp"
#include "pickcell/cli/experiment_faults_journal.hpp"
#include "pickcell/cli/experiment_faults_world.hpp"
#include "pickcell/robot/hses_client.hpp"
#include "pickcell/robot/job_robot.hpp"
#include "pickcell/robot/tcp80_client.hpp"
#include "pickcell/sim/controller.hpp"
#include "pickcell/sim/shipped_jobs.hpp"

namespace pickcell::cli {

using namespace std::chrono_literals;
using core::ErrorCode;
using robot::CommandState;
using robot::Outcome;

namespace {

constexpr core::Duration kPoll = 50ms;
constexpr core::Duration kPickTimeout = 60s;  // simulated; a pick takes about 4 s
constexpr int kCommandsOfAPick = 150;
constexpr double kPickLength_s = 4;
constexpr std::size_t kMostFindings = 20;

/// The whole room the arm may be in: the tool centre point of targets, with the approach.
constexpr std::array<double, 3> kBoxMin_mm{150, -500, -300}, kBoxMax_mm{700, 500, 400};

bool of_the_answer(SoakFault fault) { return fault <= SoakFault::reset_after_ok; }
bool of_the_state(SoakFault fault) { return fault >= SoakFault::alarm && fault <= SoakFault::servo_off; }

/// What stopped the cell, in its words.
struct Stop {
  std::string code, why, remedy;
  bool seen_in_state = false;  ///< by looking at the arm, not by a failed call
};

bool mentions(const Stop& stop, std::initializer_list<const char*> words) {
  for (const char* word : words)
    if (stop.why.find(word) != std::string::npos || stop.code == word) return true;
  return false;
}

/// Whether the words name what was done to the cell.
bool explains(const Stop& stop, SoakFault fault) {
  const bool link = stop.code == "LINK_LOST" || stop.code == "LINK_TIMEOUT";
  switch (fault) {
    case SoakFault::alarm:
      return mentions(stop, {"ROBOT_ALARM", "2060", "alarm"});
    case SoakFault::estop:
    case SoakFault::servo_off:
      return mentions(stop, {"ROBOT_SERVO_OFF", "3010", "2070", "3450"});
    case SoakFault::teach:
      return mentions(stop, {"ROBOT_TEACH", "2100", "2080", "TEACH"});
    case SoakFault::hold:
      return mentions(stop, {"ROBOT_HELD", "2020", "held"});
    default:
      return link;
  }
}

class Soak {
 public:
  explicit Soak(FaultSoakOptions options)
      : options_(std::move(options)), random_(options_.seed), world_(options_.picks) {}

  core::Result<FaultSoakReport> run() {
    const auto began = std::chrono::steady_clock::now();
    if (options_.picks < 1 || options_.picks > SoakTable::kMost)
      return core::failure(ErrorCode::usage, "--n", "1 to " + std::to_string(SoakTable::kMost) + " picks", "");
    if (auto ready = set_up(); !ready) return core::forward(ready);
    for (int part = 0; part < options_.picks; ++part) {
      if (auto dealt = deal(part); !dealt) return core::forward(dealt);
      if (options_.progress && part % 100 == 99) options_.progress(part + 1);
    }
    if (auto audited = audit(); !audited) return core::forward(audited);
    report_.simulated_s = core::seconds(clock_.now());
    report_.wall_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count();
    return std::move(report_);
  }

 private:
  // --- the cell and its parts ---

  core::Status set_up() {
    std::error_code ignored;
    for (const char* end : {"", "-wal", "-shm"})
      std::filesystem::remove(options_.folder / ("soak-journal.db" + std::string(end)), ignored);
    sim::ControllerSettings settings;
    settings.jobs = sim::shipped_jobs();
    auto on = sim::Controller::switch_on(settings, clock_, &world_);
    if (!on) return core::forward(on);
    controller_ = std::move(*on);
    if (auto booted = boot(); !booted) return booted;
    return recover();
  }

  /// A new process: nothing survives but the journal's file.
  core::Status boot() {
    robot_.reset();
    mortal_.reset();
    journal_.reset();
    ++report_.pc_starts;
    auto journal = cell::SqliteJournal::open(options_.folder / "soak-journal.db");
    if (!journal) return core::forward(journal);
    journal_ = std::move(*journal);
    mortal_ = std::make_unique<MortalJournal>(*journal_);
    robot::JobRobotSettings settings;
    settings.limits.box_min_mm = kBoxMin_mm;
    settings.limits.box_max_mm = kBoxMax_mm;
    robot_ = std::make_unique<robot::JobRobot>(settings, link(), *mortal_, clock_);
    return {};
  }

  /// Every start of the PC may speak another protocol: the registers are the same.
  std::unique_ptr<robot::ControllerLink> link() {
    hses_ = options_.protocols == SoakProtocols::hses || (options_.protocols == SoakProtocols::both && chance(0.5));
    if (hses_) {
      robot::HsesSettings settings;
      settings.host = "127.0.0.1";
      settings.port = controller_->hses_port();
      settings.timeout = std::max<std::chrono::milliseconds>(options_.answer_timeout / settings.tries, 1ms);
      return std::make_unique<robot::HsesClient>(settings);
    }
    robot::Tcp80Settings settings;
    settings.host = "127.0.0.1";
    settings.port = controller_->tcp80_port();
    settings.line_timeout = settings.result_timeout = options_.answer_timeout;
    return std::make_unique<robot::Tcp80Client>(settings);
  }

  picks::Pick pick(int part) const {
    picks::Pick p;
    p.detection_id = static_cast<std::uint64_t>(part) + 1;
    p.place_slot = part;
    p.model = "soak";
    p.T_base_grasp = SoakTable::above(SoakTable::place_mm(part));
    p.T_base_place = SoakTable::above({450, 150.0 + part % 10, -60});
    return p;
  }

  // --- one part ---

  core::Status deal(int part) {
    if (chance(0.02)) world_.take_away(part);
    for (;;) {
      if (chance(options_.outside_rate)) try_outside(part);
      ++report_.submitted;
      report_.over_hses += hses_;
      before_ = std::exchange(fault_, std::nullopt);
      if (chance(options_.fault_rate)) choose_fault();
      if (auto handled = hand_over(part); !handled) return handled;
      auto state = recorded(part);
      if (!state) return core::forward(state);
      if (!*state || **state == CommandState::void_) {
        ++report_.withdrawn;
        continue;  // never taken: the part still lies there
      }
      ++report_.parts;
      report_.done += **state == CommandState::done;
      report_.refused += **state == CommandState::refused;
      report_.unknown += **state == CommandState::unknown;
      if (**state == CommandState::intent || **state == CommandState::sent)
        finding(report_.lost, "part " + std::to_string(part) + " was left open in the journal");
      return {};
    }
  }

  core::Result<std::optional<CommandState>> recorded(int part) {
    auto rows = journal_->newest_rows(3);
    if (!rows) return core::forward(rows);
    for (const robot::JournalRow& row : *rows)
      if (row.place_slot == part) return row.state;
    return std::nullopt;
  }

  /// Until the outcome is known, through whatever happens.
  core::Status hand_over(int part) {
    std::optional<Stop> stop;
    bool pc_gone = false;
    try {
      stop = pick_once(part);
    } catch (const PcDied&) {
      pc_gone = true;
    }
    mortal_->forget();
    controller_->follow({});
    if (!stop && !pc_gone) return {};
    if (stop) judge(*stop);
    if (pc_gone || chance(0.1)) {
      if (auto booted = boot(); !booted) return booted;
    }
    return recover();
  }

  /// Empty when the pick ended by itself.
  std::optional<Stop> pick_once(int part) {
    if (auto submitted = robot_->submit(pick(part)); !submitted) return failed(submitted.error(), "handing over");
    const core::TimePoint deadline = seat_->now() + kPickTimeout;
    while (seat_->now() < deadline) {
      watch_box();
      if (strikes_ && seat_->now() >= *strikes_) strike();
      auto outcome = robot_->outcome();
      if (!outcome) return failed(outcome.error(), "waiting for the outcome");
      if (*outcome) {
        tell(**outcome);
        strikes_.reset();
        return std::nullopt;
      }
      auto state = robot_->state();
      if (!state) return failed(state.error(), "looking at the arm");
      if (const auto hindrance = cell::hindrance_to_run(*state))
        return Stop{hindrance->code, hindrance->why, hindrance->remedy, true};
      seat_->sleep_for(kPoll);
    }
    return Stop{"PICK_TIMEOUT", "", "", false};
  }

  static Stop failed(const core::Error& error, const char* doing) {
    const cell::Halt halt = cell::halt_from(error, doing);
    return {halt.code, halt.why, halt.remedy, false};
  }

  // --- faults ---

  void choose_fault() {
    const auto fault = static_cast<SoakFault>(below(kSoakFaults));
    fault_ = fault;
    ++report_.injected[static_cast<std::size_t>(fault)];
    const auto soon = [this] { return seat_->now() + core::duration_s(unit() * kPickLength_s); };
    if (of_the_answer(fault) || of_the_state(fault)) {
      sim::FaultEvent event;
      event.fault = static_cast<sim::Fault>(fault);
      event.delay_s = 0.005 + 0.3 * unit();
      if (of_the_state(fault) && chance(0.5)) {
        event.at_s = unit() * kPickLength_s;
        event.mid_move = chance(0.5);
      } else {
        event.after_commands = 1 + below(kCommandsOfAPick);
      }
      controller_->follow({event});
    } else if (fault == SoakFault::power_loss && chance(0.4)) {
      mortal_->at_commit(1 + below(3), chance(0.5), [this] { controller_->kill(); });
    } else if (fault == SoakFault::pc_dies_at_journal) {
      mortal_->at_commit(1 + below(3), chance(0.5), [] { throw PcDied{}; });
    } else {
      strikes_ = soon();
    }
  }

  void strike() {
    strikes_.reset();
    if (fault_ == SoakFault::power_loss) return controller_->kill();
    throw PcDied{};
  }

  void judge(const Stop& stop) {
    ++report_.stops;
    const bool slow = stop.code == "LINK_TIMEOUT";  // the machine was busy: said in words, though nobody ordered it
    const bool named = (fault_ && explains(stop, *fault_)) || (before_ && explains(stop, *before_)) || slow;
    if (named && !stop.why.empty() && !stop.remedy.empty())
      ++report_.stops_explained;
    else
      note("stop not explained after " + std::string(fault_ ? name(*fault_) : "no fault") + ": " + stop.code + ": " +
           stop.why + "; " + stop.remedy);
    if (!stop.seen_in_state) return;
    seat_->sleep_for(300ms);  // the ramps
    const sim::Joints before = joints();
    if (stop.code != "ROBOT_SERVO_OFF" && stop.code != "ROBOT_STOPPED" && chance(0.3) && robot_->start(*seat_))
      finding(report_.forbidden_motions, "started in spite of " + stop.code);
    seat_->sleep_for(1s);
    if (!joints().isApprox(before, 1e-9)) finding(report_.forbidden_motions, "the arm moved after " + stop.code);
  }

  /// A pick outside the box must end here: nothing written, nothing moved.
  void try_outside(int part) {
    picks::Pick p = pick(part);
    const std::array<Eigen::Vector3d, 4> places = {
        Eigen::Vector3d{450, 510, -60}, {140, 0, 0}, {450, 0, -310}, {450, 0, 350}};
    auto& pose = chance(0.5) ? p.T_base_grasp : p.T_base_place;
    pose = SoakTable::above(places[static_cast<std::size_t>(below(4))]);
    const auto before = controller_->copy_of_state();
    const auto answer = robot_->submit(p);
    seat_->sleep_for(100ms);
    const auto after = controller_->copy_of_state();
    if (answer || answer.error().code != ErrorCode::safety)
      finding(report_.forbidden_motions, "a pick outside the box was taken");
    else if (written(before) != written(after))
      finding(report_.forbidden_motions, "a pick outside the box reached the controller");
    else
      ++report_.outside_refused;
  }

  /// The command's variables, as the PC writes them.
  static std::array<std::int32_t, 9> written(const sim::ControllerState& s) {
    std::array<std::int32_t, 9> all{s.D[10], s.D[13], s.I[10], s.I[13]};
    for (std::size_t n : {10, 11})
      if (const auto& p = s.P[n]) all[n - 6] = p->axis[0], all[n - 4] = p->axis[1];
    return all;
  }

  void watch_box() {
    const Eigen::Vector3d tool_mm = controller_->T_base_tool().translation_m() * 1e3;
    for (std::size_t i = 0; i < 3; ++i) {
      const double v = tool_mm(static_cast<Eigen::Index>(i));
      if (v < kBoxMin_mm[i] || v > kBoxMax_mm[i])
        return finding(report_.forbidden_motions, "the tool is outside the box");
    }
  }

  // --- the person ---

  /// Puts things right at the controller, looks at the gripper where asked to, resets and starts, until it runs.
  core::Status recover() {
    strikes_.reset();
    fault_.reset();
    (void)controller_->revive();
    controller_->with_state([](sim::ControllerState& s) {
      s.hold_pendant = false;
      s.release_emergency_stop();
      s.reset_at_pendant();
      s.turn_key_to_remote();
    });
    std::string last;
    constexpr int kTries = 8;
    for (int tries = 0; tries < kTries; ++tries) {
      seat_->sleep_for(100ms);
      auto running = bring_up();
      if (running) {
        for (const Outcome& o : robot_->take_settled()) tell(o);
        return {};
      }
      last = running.error().line();
      if (running.error().why.empty() || running.error().remedy.empty())
        note("no reason or remedy while starting: " + last), ++report_.stops;
      if (running.error().code == ErrorCode::refused && robot_->connected()) {
        world_.empty_the_gripper();
        seat_->sleep_for(100ms);
        (void)robot_->confirm(*seat_);
      }
    }
    return core::failure(ErrorCode::timeout, "soak", "the cell does not come out of a stop: " + last);
  }

  core::Status bring_up() {
    if (!robot_->connected()) {
      if (auto connected = robot_->connect(*seat_); !connected) return connected;
    }
    if (auto reset = robot_->reset(); !reset) return reset;
    return robot_->start(*seat_);
  }

  // --- the record ---

  void tell(const Outcome& outcome) {
    if (!told_.insert(outcome.sequence).second)
      finding(report_.lost, "the outcome of pick " + std::to_string(outcome.sequence) + " was told twice");
  }

  core::Status audit() {
    auto rows = journal_->newest_rows(1'000'000);
    if (!rows) return core::forward(rows);
    std::map<int, std::map<CommandState, int>> by_part;
    for (const robot::JournalRow& row : *rows) ++by_part[row.place_slot][row.state];
    const std::vector<int> grips = world_.grips();
    for (int part = 0; part < options_.picks; ++part) {
      const int gripped = grips[static_cast<std::size_t>(part)];
      auto& count = by_part[part];
      const std::string who = "part " + std::to_string(part);
      const int ran = count[CommandState::done] + count[CommandState::refused];
      if (gripped > 1 || count[CommandState::done] > 1)
        finding(report_.executed_twice, who + " was gripped " + std::to_string(gripped) + " times");
      if (gripped > ran + count[CommandState::unknown])
        finding(report_.lost, who + " was gripped, and no row of the journal knows");
      if (count[CommandState::done] > gripped) finding(report_.lost, who + " is recorded as done and was not gripped");
      if (count[CommandState::intent] + count[CommandState::sent] > 0)
        finding(report_.lost, who + " has a row that was left open");
    }
    for (int i = world_.strays(); i > 0; --i) finding(report_.forbidden_motions, "a grip where no part was ordered");
    return {};
  }

  void finding(int& count, const std::string& text) {
    ++count;
    note(text);
  }
  void note(const std::string& text) {
    if (report_.findings.size() < kMostFindings) report_.findings.push_back(text);
  }

  // --- helpers ---

  sim::Joints joints() const { return controller_->copy_of_state().q; }
  int below(int n) { return static_cast<int>(random_() % static_cast<std::uint64_t>(n)); }
  double unit() { return static_cast<double>(random_() >> 11) * 0x1p-53; }
  bool chance(double p) { return unit() < p; }

  FaultSoakOptions options_;
  FaultSoakReport report_;
  std::mt19937_64 random_;
  core::SimulatedClock clock_;
  std::unique_ptr<core::Seat> seat_ = clock_.join("pc");
  SoakWorld world_;
  std::unique_ptr<sim::Controller> controller_;
  std::unique_ptr<cell::SqliteJournal> journal_;
  std::unique_ptr<MortalJournal> mortal_;
  std::unique_ptr<robot::JobRobot> robot_;
  bool hses_ = false;
  std::optional<SoakFault> fault_;          ///< of this pick
  std::optional<SoakFault> before_;         ///< of the pick before, when that one ended well: it may strike late
  std::optional<core::TimePoint> strikes_;  ///< when the controller's power or the PC goes
  std::set<std::int32_t> told_;
};

}  // namespace

const char* name(SoakFault fault) {
  static constexpr std::array<const char*, kSoakFaults> kNames = {
      "drop",  "double", "late", "truncate",  "half_line",  "reset_after_ok", "alarm",
      "estop", "teach",  "hold", "servo_off", "power_loss", "pc_restart",     "pc_dies_at_journal"};
  return kNames[static_cast<std::size_t>(fault)];
}

core::Result<FaultSoakReport> run_fault_soak(const FaultSoakOptions& options) { return Soak(options).run(); }

}  // namespace pickcell::cli
