/// jog, goto, home of `pickcell robot`.

#include <algorithm>
#include <cmath>

#include "pickcell/cli/robot/names.hpp"
#include "pickcell/cli/robot/request.hpp"
#include "pickcell/cli/values.hpp"

namespace pickcell::cli {

using core::ErrorCode;
using core::failure;
using core::Json;
using Answer = RobotAnswer;
using Options = RobotOptions;

namespace {

core::Result<Answer> moved(robot::ControllerLink& link, const robot::DirectMove& move, double way, double turn) {
  auto done = move_and_watch(link, move, way, turn);
  if (!done) return core::forward(done);
  const Json at = position_json(done->at);
  return Answer{Json::object().set("moved", true).set("took_s", done->took_s).set("pose_base", at),
                "moved, now at " + at.dump() + "\n",
                {}};
}

/// Base frame, with the tool of the options or the one that is chosen.
core::Result<robot::CartesianPosition> here(robot::ControllerLink& link, const Options& o) {
  auto at = link.read_position(robot::kBaseFrame);
  if (at && o.tool && *o.tool != at->tool)
    return failure(ErrorCode::usage, "--tool", "the controller works with tool " + std::to_string(at->tool),
                   "choose the tool at the pendant, or leave the option out");
  return at;
}

core::Result<Answer> go(robot::ControllerLink& link, const Options& o, const robot::CartesianPosition& at,
                        robot::CartesianPosition to, bool line) {
  if (auto safe = check_target(at, to, o.limits); !safe) return core::forward(safe);
  using Kind = robot::DirectMove::Kind;
  robot::DirectMove move{.kind = line ? Kind::line : Kind::joint, .speed = o.limits.speed_pct, .target = to};
  if (line) set_line_speed(move, way_mm(at, to), turn_deg(at, to), o.limits);
  return moved(link, move, way_mm(at, to), turn_deg(at, to));
}

}  // namespace

core::Result<Answer> jog(robot::ControllerLink& link, const Options& o) {
  static const std::vector<std::string> kAxes = {"x", "y", "z", "rx", "ry", "rz"};
  const auto axis = o.words.empty() ? kAxes.end() : std::find(kAxes.begin(), kAxes.end(), o.words[0]);
  if (o.words.size() != 2 || axis == kAxes.end())
    return failure(ErrorCode::usage, "jog", "needs an axis and a distance",
                   "for example: jog z 5 (mm), jog rz -10 (deg)");
  auto by = parse_numbers("jog " + *axis, o.words[1], 1, 1);
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

core::Result<Answer> go_to(robot::ControllerLink& link, const Options& o) {
  if (o.words.size() != 1)
    return failure(ErrorCode::usage, "goto", "needs a place", "goto x,y,z[,rx,ry,rz] in mm and degrees, base frame");
  auto v = parse_numbers("goto", o.words[0], 3, 6);
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

}  // namespace pickcell::cli
