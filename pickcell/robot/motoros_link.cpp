#include "pickcell/robot/motoros_link.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <stdexcept>
#include <utility>

#include "pickcell/core/units.hpp"
#include "pickcell/robot/pose_angles.hpp"

namespace pickcell::robot {

using core::ErrorCode;

namespace {

/// Contacts that tell of the controller (docs/yaskawa-protocols 2.5), by group.
constexpr std::uint32_t kAlarmGroup = 5001, kModeGroup = 5005, kRunGroup = 5007, kRemoteGroup = 8001;

bool bit(std::uint8_t group, int n) { return (group >> n & 1) != 0; }

/// The flange as a tool pose: tool 0.
CartesianPosition position_of(const FlangeInBase& T_base_flange) {
  CartesianPosition p = position_from({T_base_flange.rotation(), T_base_flange.translation_m()});
  p.frame = kBaseFrame;
  p.tool = 0;
  return p;
}

FlangeInBase flange_at(const CartesianPosition& p) {
  const auto T = transform_from(p);
  return {T.rotation(), T.translation_m()};
}

}  // namespace

MotoRosLink::MotoRosLink(MotoRosLinkSettings settings)
    : settings_(std::move(settings)),
      arm_(arm_geometry(settings_.model)),
      motion_(settings_.client),
      watch_(settings_.client) {
  if (!settings_.model.empty() && !arm_) throw std::invalid_argument("no arm '" + settings_.model + "'");
}

MotoRosLink::~MotoRosLink() { end_move(); }

void MotoRosLink::end_move() {
  stop_asked_ = true;
  if (mover_.joinable()) mover_.join();
}

core::Status MotoRosLink::connect() {
  disconnect();
  if (auto opened = motion_.connect(); !opened) return opened;
  order_ = motion_.order();
  settings_.client.order = order_;
  watch_ = MotoRosClient(settings_.client);  // state and I/O of its own: it looks while a move is streamed
  return {};
}

void MotoRosLink::disconnect() {
  end_move();
  moved_ = {};
  motion_.disconnect();
  watch_.disconnect();
  order_.reset();
}

core::Status MotoRosLink::standing() const {
  if (!moving_) return {};
  return core::failure(ErrorCode::refused, "motoros", "a move is under way", "wait for its end, or hold it");
}

core::Status MotoRosLink::reset_alarm() {
  if (auto stands = standing(); !stands) return stands;
  return motion_.reset_alarm();
}

core::Status MotoRosLink::servo(bool on) {
  if (!on && moving_) end_move();
  if (auto stands = standing(); !stands) return stands;
  return motion_.servo(on);
}

core::Status MotoRosLink::needs_model(const std::string& for_what) const {
  if (arm_) return {};
  return core::failure(ErrorCode::usage, "motoros", for_what + " needs the arm's geometry: MotoROS tells joints only",
                       "name the arm behind the link: motoros://HOST:PORT/gp7 (or gp8, motomini)");
}

core::Result<std::string> MotoRosLink::identity() {
  if (!order_) return std::string();
  return std::string(*order_ == ByteOrder::big ? "MotoROS, big-endian" : "MotoROS, little-endian");
}

core::Result<RobotState> MotoRosLink::read_status() {
  const bool moving = moving_;
  if (!moving && !moved_) return tl::unexpected(std::exchange(moved_, core::Status{}).error());
  auto now = watch_.read_state();
  if (!now) return core::forward(now);
  std::array<std::uint8_t, 4> groups{};
  for (std::size_t i = 0; const std::uint32_t group : {kAlarmGroup, kModeGroup, kRunGroup, kRemoteGroup}) {
    auto value = watch_.read_group(group);
    if (!value) return core::forward(value);
    groups[i++] = *value;
  }
  RobotState s;
  s.alarm = (groups[0] & 0x0F) != 0;
  s.error = bit(groups[0], 4);
  s.teach = bit(groups[1], 3);
  s.play = bit(groups[1], 4);
  s.running = moving || bit(groups[2], 0) || now->status.in_motion == 1;
  s.hold_external = bit(groups[2], 1);
  s.servo = bit(groups[2], 3);
  s.remote = bit(groups[3], 1);
  return s;
}

core::Result<std::vector<Alarm>> MotoRosLink::read_alarms() {
  auto now = watch_.read_state();
  if (!now) return core::forward(now);
  const int code = now->status.error_code;
  if (code == 0) return std::vector<Alarm>{};
  return std::vector<Alarm>{{code, 0, "alarm " + std::to_string(code)}};
}

core::Result<CartesianPosition> MotoRosLink::read_position(int frame) {
  if (auto known = needs_model("the pose"); !known) return core::forward(known);
  if (frame > kRobotFrame) return tl::unexpected(lacks("user frames"));
  auto now = watch_.read_state();
  if (!now) return core::forward(now);
  return position_of(flange_in_base(*arm_, arm_joints(now->feedback.position)));
}

core::Result<std::vector<MotoTrajectoryPoint>> MotoRosLink::plan(const DirectMove& move, const ArmJoints& from,
                                                                 const MotoRosLimits& limits) const {
  const bool joint = move.kind == DirectMove::Kind::joint;
  if (!(move.speed > 0) || move.speed > (joint ? settings_.most_fraction * 100 : settings_.most_mm_s))
    return core::failure(ErrorCode::safety, "motoros", "no speed for a move by the PC", "give a lower speed above 0");
  if (joint) {
    const auto to = joints_near(*arm_, flange_at(move.target), from);
    if (to) return plan_joint_move(*arm_, from, *to, move.speed / 100);
    return core::failure(ErrorCode::safety, "motoros", "the target is out of reach, or only with another form",
                         "choose a target nearer to where the arm stands");
  }
  const FlangeInBase here = flange_in_base(*arm_, from);
  FlangeInBase target = flange_at(move.target);
  if (move.kind == DirectMove::Kind::line_by) {
    target = {target.rotation() * here.rotation(), here.translation_m() + target.translation_m()};
  }
  if (!move.turning) return plan_line(limits, from, target, move.speed);
  // The speed is that of the turn: the way takes as long.
  const double turn_deg =
      core::deg_from_rad(Eigen::Quaterniond(here.rotation()).angularDistance(Eigen::Quaterniond(target.rotation())));
  const double way_mm = core::mm_from_m((target.translation_m() - here.translation_m()).norm());
  constexpr double kLeast_mm_s = 0.1;
  return plan_line(limits, from, target, std::max(kLeast_mm_s, way_mm * move.speed / std::max(turn_deg, 1e-3)));
}

core::Status MotoRosLink::move(const DirectMove& move) {
  if (auto known = needs_model("a move"); !known) return known;
  if (move.target.frame > kRobotFrame) return tl::unexpected(lacks("user frames"));
  if (move.target.tool != 0)
    return tl::unexpected(lacks("tools that the PC could know: give the target of the flange, tool 0"));
  if (auto stands = standing(); !stands) return stands;
  if (mover_.joinable()) mover_.join();
  auto now = watch_.read_state();
  if (!now) return core::forward(now);
  MotoRosLimits limits;
  limits.arm = arm_;
  limits.box_min_mm = settings_.box_min_mm;
  limits.box_max_mm = settings_.box_max_mm;
  limits.speed_fraction = settings_.most_fraction;
  limits.line_speed_mm_s = settings_.most_mm_s;
  auto points = plan(move, arm_joints(now->feedback.position), limits);
  if (!points) return core::forward(points);
  if (auto safe = check_trajectory(*points, limits); !safe) return safe;
  moved_ = {};
  stop_asked_ = false;
  moving_ = true;
  mover_ = std::jthread([this, way = std::move(*points), limits] {
    core::RealClock clock;
    moved_ = run_trajectory(motion_, way, limits, *clock.join("motoros"), [this] { return stop_asked_.load(); });
    moving_ = false;
  });
  return {};
}

core::Result<std::uint16_t> MotoRosLink::read_register(int number) {
  return watch_.read_register(static_cast<std::uint32_t>(number));
}

core::Status MotoRosLink::write_register(int number, std::uint16_t value) {
  return watch_.write_register(static_cast<std::uint32_t>(number), value);
}

core::Result<std::vector<std::uint8_t>> MotoRosLink::read_contacts(int first, int groups) {
  std::vector<std::uint8_t> out;
  for (int i = 0; i < groups; ++i) {
    auto value = watch_.read_group(static_cast<std::uint32_t>(first / 10 + i));
    if (!value) return core::forward(value);
    out.push_back(*value);
  }
  return out;
}

core::Status MotoRosLink::write_contacts(int first, const std::vector<std::uint8_t>& groups) {
  for (std::size_t i = 0; i < groups.size(); ++i) {
    const auto group = static_cast<std::uint32_t>(first / 10) + static_cast<std::uint32_t>(i);
    if (auto written = watch_.write_group(group, groups[i]); !written) return written;
  }
  return {};
}

core::Status MotoRosLink::hold(bool on) {
  if (on && moving_) {
    end_move();  // which stops the arm
    auto ended = std::exchange(moved_, core::Status{});
    if (!ended && ended.error().why != "a stop was asked for") return ended;
    return {};
  }
  if (on) return motion_.stop();
  return tl::unexpected(lacks("hold to take back: motion that was stopped is gone"));
}

}  // namespace pickcell::robot
