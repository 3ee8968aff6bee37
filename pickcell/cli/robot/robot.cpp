/// pickcell robot: a controller looked at and moved by hand, for commissioning.

#include <CLI/CLI.hpp>
#include <algorithm>
#include <memory>
#include <ostream>

#include "pickcell/cli/robot/jobs.hpp"
#include "pickcell/cli/robot/link.hpp"
#include "pickcell/cli/robot/names.hpp"
#include "pickcell/cli/robot/request.hpp"
#include "pickcell/cli/robot/status.hpp"
#include "pickcell/cli/subcommand.hpp"
#include "pickcell/cli/values.hpp"

namespace pickcell::cli {

using core::ErrorCode;
using core::failure;
using core::Json;

namespace {

using Options = RobotOptions;
using Answer = RobotAnswer;

core::Result<Answer> status(robot::ControllerLink& link, const Options& o) {
  auto report = read_report(link, o.frame, o.job, o.reads);
  if (!report) return core::forward(report);
  return Answer{report_json(*report), report_words(*report), {}};
}

Json alarm_json(const robot::Alarm& a) {
  Json out = Json::object().set("code", a.code).set("data", a.data).set("text", a.text);
  if (!a.time.empty()) out.set("time", a.time);
  return out;
}

void add_alarms(Answer& out, const std::string& key, const std::vector<robot::Alarm>& list) {
  Json alarms = Json::array();
  for (const robot::Alarm& a : list) {
    alarms.push(alarm_json(a));
    out.words += (a.time.empty() ? "" : a.time + "  ") + a.text + "\n";
  }
  out.json.set(key, alarms);
}

core::Result<Answer> alarms(robot::ControllerLink& link, const Options& o) {
  auto list = link.read_alarms();
  if (!list) return core::forward(list);
  Answer out{Json::object(), list->empty() ? "no alarm\n" : "", {}};
  add_alarms(out, "alarms", *list);
  if (o.history == 0) return out;
  using Which = robot::AlarmHistory;
  constexpr std::pair<Which, const char*> kLists[] = {{Which::major, "major"},
                                                      {Which::monitor, "monitor"},
                                                      {Which::user_system, "user_system"},
                                                      {Which::user_user, "user_user"},
                                                      {Which::off_line, "off_line"}};
  for (const auto& [which, name] : kLists) {
    auto past = link.read_past_alarms(which, o.history);
    if (!past && (!link.connected() || past.error().code == ErrorCode::usage)) return core::forward(past);
    out.words += std::string("past, ") + name + ":\n";
    if (past)
      add_alarms(out, std::string("past_") + name, *past);
    else
      out.refused.push_back(past.error());
  }
  return out;
}

core::Result<Answer> read(robot::ControllerLink& link, const Options& o) {
  if (o.words.empty()) return failure(ErrorCode::usage, "read", "names nothing", "for example: read B010 P010 27010");
  std::vector<RobotName> names;
  for (const std::string& word : o.words) {
    auto name = parse_robot_name(word);
    if (!name) return core::forward(name);
    names.push_back(*name);
  }
  Answer out{Json::object(), {}, {}};
  for (const RobotName& name : names) {
    auto value = read_robot_value(link, name);
    if (!value && value.error().code == ErrorCode::refused) {  // a P that was never written, say: the others count
      value.error().what = name.text + ": " + value.error().what;
      out.refused.push_back(value.error());
      continue;
    }
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
  Answer out{Json::object(), {}, {}};
  for (const auto& [name, value] : values) {
    if (auto written = write_robot_value(link, name, value); !written) return core::forward(written);
    auto now = read_robot_value(link, name);
    if (!now) return core::forward(now);
    out.words += name.text + " = " + now->dump() + "\n";
    out.json.set(name.text, std::move(*now));
  }
  return out;
}

core::Result<Answer> job(robot::ControllerLink& link, const Options& o) {
  auto done = run_job_request(link, {o.words, o.output, o.limits});
  if (!done) return core::forward(done);
  std::string words = (*done)["text"].string();
  if (words.empty() && done->has("jobs"))
    for (const Json& name : (*done)["jobs"].items()) words += name.string() + "\n";
  if (words.empty()) words = done->dump() + "\n";
  return Answer{std::move(*done), std::move(words), {}};
}

core::Result<Answer> hold(robot::ControllerLink& link, const Options&) {
  if (auto held = link.hold(true); !held) {
    core::Error error = held.error();
    error.remedy = "the arm may go on: use HOLD or the emergency stop at the pendant; " + error.remedy;
    return tl::unexpected(std::move(error));
  }
  auto state = link.read_status();
  if (!state) {
    core::Error error = state.error();
    error.why = "HOLD was taken, but the state after it cannot be read: " + error.why;
    return tl::unexpected(std::move(error));
  }
  return Answer{
      Json::object().set("stopped", true).set("held", state->held()),
      state->held()
          ? "held; reset releases it\n"
          : "stopped, but the controller does not tell that it holds (over MotoROS no hold stays): look at the arm\n",
      {}};
}

core::Result<Answer> reset(robot::ControllerLink& link, const Options&) {
  auto released = link.hold(false);
  if (!released && released.error().code != ErrorCode::usage) return core::forward(released);  // usage: has no hold
  if (auto s = link.reset_alarm(); !s) return core::forward(s);
  if (auto s = link.cancel_error(); !s) return core::forward(s);
  return Answer{
      Json::object().set("reset", true), released ? "hold released, alarm and error reset\n" : "alarm reset\n", {}};
}

core::Result<Answer> servo(robot::ControllerLink& link, const Options& o) {
  if (o.words.size() != 1 || (o.words[0] != "on" && o.words[0] != "off"))
    return failure(ErrorCode::usage, "servo", "needs a word", "servo on, servo off");
  const bool on = o.words[0] == "on";
  if (on)
    if (auto may = may_move(link, o.limits); !may) return core::forward(may);
  if (auto done = link.servo(on); !done) return core::forward(done);
  return Answer{Json::object().set("servo", on), "servo " + o.words[0] + " was ordered; status shows it\n", {}};
}

core::Result<Answer> cycle(robot::ControllerLink& link, const Options& o) {
  constexpr std::pair<const char*, robot::Cycle> kCycles[] = {
      {"step", robot::Cycle::step}, {"one", robot::Cycle::one_cycle}, {"continuous", robot::Cycle::continuous}};
  for (const auto& [word, which] : kCycles) {
    if (o.words != std::vector<std::string>{word}) continue;
    if (auto may = may_write(link, o); !may) return core::forward(may);
    if (auto set = link.set_cycle(which); !set) return core::forward(set);
    return Answer{Json::object().set("cycle", word), std::string("cycle: ") + word + "\n", {}};
  }
  return failure(ErrorCode::usage, "cycle", "needs a word", "cycle step, cycle one, cycle continuous");
}

core::Result<Answer> message(robot::ControllerLink& link, const Options& o) {
  constexpr std::size_t kMostBytes = 30;
  if (o.words.size() != 1 || o.words[0].empty() || o.words[0].size() > kMostBytes)
    return failure(ErrorCode::usage, "message", "needs one text of at most 30 bytes", "message \"text\"");
  if (auto shown = link.show_message(o.words[0]); !shown) return core::forward(shown);
  return Answer{Json::object().set("shown", o.words[0]), "shown on the pendant\n", {}};
}

struct Action {
  std::string_view name;
  core::Result<Answer> (*run)(robot::ControllerLink&, const Options&);
};
constexpr Action kActions[] = {{"status", status},  {"read", read},   {"write", write}, {"jog", jog},
                               {"goto", go_to},     {"home", home},   {"job", job},     {"alarms", alarms},
                               {"hold", hold},      {"reset", reset}, {"servo", servo}, {"cycle", cycle},
                               {"message", message}};

core::Status read_box(Options& o) {
  if (o.box.empty()) return {};
  auto v = parse_numbers("--box", o.box, 6, 6);
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
                   "one of status, read, write, jog, goto, home, job, alarms, hold, reset, servo, cycle, message");
  if (auto box = read_box(o); !box) return core::forward(box);
  if (auto limits = check_limits(o.limits); !limits) return core::forward(limits);
  auto link = open_controller_link(*address, "robot " + o.link);
  if (!link) return core::forward(link);
  if (auto connected = (*link)->connect(); !connected) return core::forward(connected);
  auto answer = action->run(**link, o);
  if (!answer) return core::forward(answer);
  io.out << (o.json ? answer->json.dump() + "\n" : answer->words);
  for (const core::Error& refused : answer->refused) io.err << "pickcell: " << refused.line() << "\n";
  return answer->refused.empty() ? 0 : core::exit_code(ErrorCode::refused);
}

Runner add(CLI::App& app) {
  auto o = std::make_shared<Options>();
  app.add_option("link", o->link, "tcp80://HOST[:PORT] | hses://HOST[:PORT] | motoros://HOST[:PORT][/MODEL]")
      ->required();
  app.add_option(
         "action", o->action,
         "status | read NAME... | write NAME=VALUE... | jog AXIS DISTANCE | goto x,y,z[,rx,ry,rz] | home | "
         "job list|show|download|upload|delete|select|master|start [NAME] | alarms | hold | reset | servo on|off | "
         "cycle step|one|continuous | message TEXT")
      ->required();
  app.add_option("words", o->words,
                 "B010, I010, D010, R003, S010, P010, M100, contacts such as 27010; what the action needs");
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
  app.add_option("--history", o->history, "alarms: so many past ones of each list (HSES)")->check(CLI::Range(0, 100));
  app.add_option("--reads", o->reads, "status: how many reads are timed (50)")->check(CLI::Range(1, 100000));
  app.add_option("--job", o->job, "status: the job that picks need (VISPICK)");
  app.add_option("-o,--output", o->output, "job download: file (NAME.JBI)");
  return [o](Io& io) { return run(*o, io); };
}

const Registration registered({"robot", "a controller looked at and moved by hand, for commissioning", add});

}  // namespace

}  // namespace pickcell::cli
