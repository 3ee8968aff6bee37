/// pickcell robot: a controller looked at and moved by hand, for commissioning.

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <memory>
#include <ostream>

#include "pickcell/cli/robot_jobs.hpp"
#include "pickcell/cli/robot_link.hpp"
#include "pickcell/cli/robot_moves.hpp"
#include "pickcell/cli/robot_names.hpp"
#include "pickcell/cli/robot_status.hpp"
#include "pickcell/cli/subcommand.hpp"

namespace pickcell::cli {

using core::ErrorCode;
using core::failure;
using core::Json;

namespace {

struct Options {
  std::string link, action;
  std::vector<std::string> words;
  bool json = false;
  int frame = 0;
  int reads = 50;
  std::string job = "VISPICK", output, box;
  int home_variable = 0;
  bool line = false;
  std::optional<int> tool;
  MoveLimits limits;
};

/// What a request has found out: for programs, and for people.
struct Answer {
  Json json;
  std::string words;
};

core::Result<Answer> status(robot::ControllerLink& link, const Options& o) {
  auto report = read_report(link, o.frame, o.job, o.reads);
  if (!report) return core::forward(report);
  return Answer{report_json(*report), report_words(*report)};
}

core::Result<Answer> alarms(robot::ControllerLink& link, const Options&) {
  auto list = link.read_alarms();
  if (!list) return core::forward(list);
  Json out = Json::array();
  std::string words;
  for (const robot::Alarm& a : *list) {
    out.push(Json::object().set("code", a.code).set("data", a.data).set("text", a.text));
    words += a.text + "\n";
  }
  return Answer{Json::object().set("alarms", out), words.empty() ? "no alarm\n" : words};
}

core::Result<Answer> read(robot::ControllerLink& link, const Options& o) {
  if (o.words.empty()) return failure(ErrorCode::usage, "read", "names nothing", "for example: read B010 P010 27010");
  std::vector<RobotName> names;
  for (const std::string& word : o.words) {
    auto name = parse_robot_name(word);
    if (!name) return core::forward(name);
    names.push_back(*name);
  }
  Answer out{Json::object(), {}};
  for (const RobotName& name : names) {
    auto value = read_robot_value(link, name);
    if (!value) return core::forward(value);
    out.words += name.text + " = " + value->dump() + "\n";
    out.json.set(name.text, std::move(*value));
  }
  return out;
}

/// A running job may act on what is written: that is motion.
core::Status may_write(robot::ControllerLink& link, const Options& o) {
  auto state = link.read_status();
  if (!state) return core::forward(state);
  if (!state->running || o.limits.allow_motion) return {};
  return failure(ErrorCode::safety, link.peer(), "a job runs and may move on what is written",
                 "stop it, or add --allow-motion");
}

core::Result<Answer> write(robot::ControllerLink& link, const Options& o) {
  if (o.words.empty()) return failure(ErrorCode::usage, "write", "names nothing", "for example: write B010=0 27010=1");
  std::vector<std::pair<RobotName, std::string>> values;
  for (const std::string& word : o.words) {
    const std::size_t equals = word.find('=');
    auto name = parse_robot_name(word.substr(0, equals));
    if (!name) return core::forward(name);
    if (equals == std::string::npos)
      return failure(ErrorCode::usage, word, "has no value", "write " + name->text + "=VALUE");
    values.emplace_back(*name, word.substr(equals + 1));
  }
  if (auto may = may_write(link, o); !may) return core::forward(may);
  Answer out{Json::object(), {}};
  for (const auto& [name, value] : values) {
    if (auto written = write_robot_value(link, name, value); !written) return core::forward(written);
    auto now = read_robot_value(link, name);
    if (!now) return core::forward(now);
    out.words += name.text + " = " + now->dump() + "\n";
    out.json.set(name.text, std::move(*now));
  }
  return out;
}

core::Result<Answer> moved(robot::ControllerLink& link, const robot::DirectMove& move, double way, double turn) {
  auto done = move_and_watch(link, move, way, turn);
  if (!done) return core::forward(done);
  const Json at = position_json(done->at);
  return Answer{Json::object().set("moved", true).set("took_s", done->took_s).set("pose_base", at),
                "moved, now at " + at.dump() + "\n"};
}

/// Base frame, with the tool of the options or the one that is chosen.
core::Result<robot::CartesianPosition> here(robot::ControllerLink& link, const Options& o) {
  auto at = link.read_position(robot::kBaseFrame);
  if (at && o.tool && *o.tool != at->tool)
    return failure(ErrorCode::usage, "--tool", "the controller works with tool " + std::to_string(at->tool),
                   "choose the tool at the pendant, or leave the option out");
  return at;
}

core::Result<Answer> jog(robot::ControllerLink& link, const Options& o) {
  static const std::vector<std::string> kAxes = {"x", "y", "z", "rx", "ry", "rz"};
  const auto axis = o.words.empty() ? kAxes.end() : std::find(kAxes.begin(), kAxes.end(), o.words[0]);
  if (o.words.size() != 2 || axis == kAxes.end())
    return failure(ErrorCode::usage, "jog", "needs an axis and a distance",
                   "for example: jog z 5 (mm), jog rz -10 (deg)");
  auto by = parse_numbers(o.words[1], 1, 1, "jog " + *axis);
  if (!by) return core::forward(by);
  if (auto may = may_move(link, o.limits); !may) return core::forward(may);
  auto at = here(link, o);
  if (!at) return core::forward(at);
  robot::DirectMove move{.kind = robot::DirectMove::Kind::line_by, .target = {}};
  double* const fields[] = {&move.target.x_mm,   &move.target.y_mm,   &move.target.z_mm,
                            &move.target.rx_deg, &move.target.ry_deg, &move.target.rz_deg};
  const auto i = static_cast<std::size_t>(axis - kAxes.begin());
  *fields[i] = by->front();
  move.target.tool = at->tool;
  move.target.form = at->form;
  const double way = i < 3 ? std::abs(by->front()) : 0, turn = i < 3 ? 0 : std::abs(by->front());
  if (turn > o.limits.most_turn_deg)
    return failure(ErrorCode::safety, "jog", "turns by more than allowed at once", "go in steps, or --max-turn-deg");
  robot::CartesianPosition to = *at;
  to.x_mm += move.target.x_mm, to.y_mm += move.target.y_mm, to.z_mm += move.target.z_mm;
  if (auto safe = check_target(*at, to, o.limits); !safe) return core::forward(safe);
  set_line_speed(move, way, turn, o.limits);
  return moved(link, move, way, turn);
}

core::Result<Answer> go(robot::ControllerLink& link, const Options& o, const robot::CartesianPosition& at,
                        robot::CartesianPosition to, bool line) {
  if (auto safe = check_target(at, to, o.limits); !safe) return core::forward(safe);
  using Kind = robot::DirectMove::Kind;
  robot::DirectMove move{.kind = line ? Kind::line : Kind::joint, .speed = o.limits.speed_pct, .target = to};
  if (line) set_line_speed(move, way_mm(at, to), turn_deg(at, to), o.limits);
  return moved(link, move, way_mm(at, to), turn_deg(at, to));
}

core::Result<Answer> go_to(robot::ControllerLink& link, const Options& o) {
  if (o.words.size() != 1)
    return failure(ErrorCode::usage, "goto", "needs a place", "goto x,y,z[,rx,ry,rz] in mm and degrees, base frame");
  auto v = parse_numbers(o.words[0], 3, 6, "goto");
  if (!v) return core::forward(v);
  if (v->size() != 3 && v->size() != 6)
    return failure(ErrorCode::usage, "goto", "needs three or six numbers", "goto x,y,z[,rx,ry,rz]");
  if (auto may = may_move(link, o.limits); !may) return core::forward(may);
  auto at = here(link, o);
  if (!at) return core::forward(at);
  robot::CartesianPosition to = *at;  // the same form and tool
  to.x_mm = (*v)[0], to.y_mm = (*v)[1], to.z_mm = (*v)[2];
  if (v->size() == 6) to.rx_deg = (*v)[3], to.ry_deg = (*v)[4], to.rz_deg = (*v)[5];
  return go(link, o, *at, to, o.line);
}

core::Result<Answer> home(robot::ControllerLink& link, const Options& o) {
  if (auto may = may_move(link, o.limits); !may) return core::forward(may);
  auto variable = link.read_position_variable(o.home_variable);
  if (!variable) return core::forward(variable);
  const auto* to = std::get_if<robot::CartesianPosition>(&*variable);
  if (!to || to->frame != robot::kBaseFrame)
    return failure(ErrorCode::refused, "P" + std::to_string(o.home_variable), "is not a place in the base frame",
                   "teach it cartesian in the base frame, or name another with --home-variable");
  auto at = here(link, o);
  if (!at) return core::forward(at);
  return go(link, o, *at, *to, false);
}

core::Result<Answer> job(robot::ControllerLink& link, const Options& o) {
  auto done = run_job_request(link, {o.words, o.output, o.limits});
  if (!done) return core::forward(done);
  std::string words = (*done)["text"].string();
  if (words.empty() && done->has("jobs"))
    for (const Json& name : (*done)["jobs"].items()) words += name.string() + "\n";
  if (words.empty()) words = done->dump() + "\n";
  return Answer{std::move(*done), std::move(words)};
}

core::Result<Answer> hold(robot::ControllerLink& link, const Options&) {
  if (auto held = link.hold(true); !held) return core::forward(held);
  return Answer{Json::object().set("held", true), "held; reset releases it\n"};
}

core::Result<Answer> reset(robot::ControllerLink& link, const Options&) {
  if (auto s = link.hold(false); !s) return core::forward(s);
  if (auto s = link.reset_alarm(); !s) return core::forward(s);
  if (auto s = link.cancel_error(); !s) return core::forward(s);
  return Answer{Json::object().set("reset", true), "hold released, alarm and error reset\n"};
}

struct Action {
  std::string_view name;
  core::Result<Answer> (*run)(robot::ControllerLink&, const Options&);
};
constexpr Action kActions[] = {{"status", status}, {"read", read},  {"write", write}, {"jog", jog},
                               {"goto", go_to},    {"home", home},  {"job", job},     {"alarms", alarms},
                               {"hold", hold},     {"reset", reset}};

core::Status read_box(Options& o) {
  if (o.box.empty()) return {};
  auto v = parse_numbers(o.box, 6, 6, "--box");
  if (!v) return core::forward(v);
  o.limits.box_mm.emplace();
  std::copy(v->begin(), v->end(), o.limits.box_mm->begin());
  return {};
}

core::Result<int> run(Options o, Io& io) {
  auto address = parse_robot_link(o.link, "robot");
  if (!address) return core::forward(address);
  const auto* action =
      std::find_if(std::begin(kActions), std::end(kActions), [&](const Action& a) { return a.name == o.action; });
  if (action == std::end(kActions))
    return failure(ErrorCode::usage, "robot", "'" + o.action + "' is nothing to do",
                   "one of status, read, write, jog, goto, home, job, alarms, hold, reset");
  if (auto box = read_box(o); !box) return core::forward(box);
  if (auto limits = check_limits(o.limits); !limits) return core::forward(limits);
  auto link = open_controller_link(*address, "robot " + o.link);
  if (!link) return core::forward(link);
  if (auto connected = (*link)->connect(); !connected) return core::forward(connected);
  auto answer = action->run(**link, o);
  if (!answer) return core::forward(answer);
  io.out << (o.json ? answer->json.dump() + "\n" : answer->words);
  return 0;
}

Runner add(CLI::App& app) {
  auto o = std::make_shared<Options>();
  app.add_option("link", o->link, "tcp80://HOST[:PORT] | hses://HOST[:PORT]")->required();
  app.add_option("action", o->action,
                 "status | read NAME... | write NAME=VALUE... | jog AXIS DISTANCE | goto x,y,z[,rx,ry,rz] | home | "
                 "job list|show|download|upload|delete|start [NAME] | alarms | hold | reset")
      ->required();
  app.add_option("words", o->words, "B010, I010, D010, R003, P010, contacts such as 27010; what the action needs");
  app.add_flag("--json", o->json, "one object on one line");
  app.add_flag("--allow-motion", o->limits.allow_motion, "needed by everything that moves the arm");
  app.add_option("--speed-pct", o->limits.speed_pct, "of joint moves (2)");
  app.add_option("--max-speed-pct", o->limits.most_pct, "that --speed-pct may ask for (5; never above 25)");
  app.add_option("--speed-mm-s", o->limits.speed_mm_s, "of straight lines (20)");
  app.add_option("--max-speed-mm-s", o->limits.most_mm_s, "that --speed-mm-s may ask for (50; never above 250)");
  app.add_option("--max-way-mm", o->limits.most_way_mm, "of one move (500)");
  app.add_option("--max-turn-deg", o->limits.most_turn_deg, "of one move (90)");
  app.add_option("--box", o->box, "x,y,z lowest,x,y,z highest in mm, base frame: targets outside are refused");
  app.add_flag("--line", o->line, "goto: on a straight line");
  app.add_option("--tool", o->tool, "the tool that must be chosen on the controller");
  app.add_option("--home-variable", o->home_variable, "home: position variable (P000, of VISPICK)")
      ->check(CLI::Range(0, 127));
  app.add_option("--frame", o->frame, "status: the pose in this frame too, as in RPOSC (1 robot, 2.. user 1..)")
      ->check(CLI::Range(0, 65));
  app.add_option("--reads", o->reads, "status: how many reads are timed (50)")->check(CLI::Range(1, 100000));
  app.add_option("--job", o->job, "status: the job that picks need (VISPICK)");
  app.add_option("-o,--output", o->output, "job download: file (NAME.JBI)");
  return [o](Io& io) { return run(*o, io); };
}

const Registration registered({"robot", "a controller looked at and moved by hand, for commissioning", add});

}  // namespace

}  // namespace pickcell::cli
