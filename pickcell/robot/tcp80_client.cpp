#include "pickcell/robot/tcp80_client.hpp"

#include <algorithm>
#include <array>
#include <stdexcept>
#include <utility>

#include "pickcell/core/log.hpp"
#include "pickcell/robot/controller_fault.hpp"

namespace pickcell::robot {

using core::ErrorCode;

namespace {

bool session_broke(const core::Error& error) {
  return error.code == ErrorCode::link || error.code == ErrorCode::timeout;
}

std::string without_end(std::string_view bytes) {
  while (bytes.ends_with('\r') || bytes.ends_with('\n')) bytes.remove_suffix(1);
  return std::string(bytes);
}

}  // namespace

Tcp80Client::Tcp80Client(Tcp80Settings settings) : settings_(std::move(settings)) {}

std::string Tcp80Client::peer() const { return settings_.host + ':' + std::to_string(settings_.port); }

void Tcp80Client::remember(char direction, std::string_view text) {
  trail_.add(std::string(1, direction) + ' ' + tcp80_shown(text));
}

core::Status Tcp80Client::send(const std::string& bytes, WallDeadline deadline) {
  remember('>', without_end(bytes));
  return link_->write(bytes, deadline);
}

core::Result<std::string> Tcp80Client::line(WallDeadline deadline) {
  for (bool heard = false;; heard = true) {
    if (auto complete = splitter_.next()) {
      remember('<', *complete);
      return std::move(*complete);
    }
    if (auto early = in_time(peer(), deadline); heard && !early) return core::forward(early);
    std::array<char, 512> buffer;
    auto n = link_->read(buffer, deadline);
    if (!n && !splitter_.partial().empty()) {
      n.error().why += " after half a line: \"" + tcp80_shown(splitter_.partial()) + '"';
    }
    if (!n) return core::forward(n);
    if (auto fed = splitter_.feed({buffer.data(), *n}); !fed) return core::forward(fed);
  }
}

core::Status Tcp80Client::open_session() {
  link_.reset();
  splitter_ = {};
  auto link = ByteLink::connect(settings_.host, settings_.port, from_now(settings_.connect_timeout));
  if (!link) return core::forward(link);
  link_ = std::move(*link);
  const auto deadline = from_now(settings_.line_timeout);
  if (auto sent = send(tcp80_connect(), deadline); !sent) return core::forward(sent);
  auto greeting = line(deadline);
  if (!greeting) return core::forward(greeting);
  if (tcp80_line_kind(*greeting) != Tcp80LineKind::ok) {
    return core::failure(ErrorCode::link, peer(), "greeting refused: \"" + tcp80_shown(*greeting) + '"',
                         "check that the address is a Yaskawa Ethernet Server and that nobody else is connected");
  }
  const std::string banner = tcp80_shown(*greeting);
  if (banner != banner_) core::log(core::LogLevel::info, "robot", peer() + " says \"" + banner + '"');
  banner_ = banner;
  keep_alive_ = tcp80_keeps_alive(banner_);
  return {};
}

core::Status Tcp80Client::connect() {
  trail_.clear();
  open_ = false;
  auto opened = open_session();
  if (!opened) {
    link_.reset();
    return tl::unexpected(trail_.onto(std::move(opened.error())));
  }
  open_ = true;
  return {};
}

void Tcp80Client::disconnect() {
  link_.reset();
  open_ = false;
}

core::Error Tcp80Client::refusal(const std::string& command, const std::string& answer) const {
  core::Error error{ErrorCode::refused, peer() + ' ' + command, {}, {}, {}};
  if (const auto code = tcp80_fault_code(answer)) {
    const ControllerFault fault = controller_fault(*code);
    constexpr char kDigits[] = "0123456789ABCDEF";
    std::string number;
    for (int shift = 12; shift >= 0; shift -= 4) number += kDigits[*code >> shift & 15];
    error.why = "refused with " + number + ": " + std::string(fault.meaning);
    error.remedy = fault.remedy;
  } else {
    error.why = "refused: \"" + tcp80_shown(answer) + '"';
    error.remedy = "see the message on the pendant";
  }
  return error;
}

core::Result<std::string> Tcp80Client::run_once(const Tcp80Request& request, Kind kind) {
  const auto line_deadline = from_now(settings_.line_timeout);
  if (auto sent = send(request.header, line_deadline); !sent) return core::forward(sent);
  auto understood = line(line_deadline);
  if (!understood) return core::forward(understood);
  const auto said = tcp80_line_kind(*understood);
  if (said == Tcp80LineKind::refused || said == Tcp80LineKind::error)
    return tl::unexpected(refusal(request.command, *understood));
  if (said != Tcp80LineKind::ok || understood->find(request.command) == std::string::npos)
    return core::failure(ErrorCode::link, peer() + ' ' + request.command,
                         "out of step: \"" + tcp80_shown(*understood) + '"', "the session is closed; connect again");
  const auto result_deadline = from_now(settings_.result_timeout);
  if (!request.operands.empty()) {
    if (auto sent = send(request.operands, result_deadline); !sent) return core::forward(sent);
  }
  auto result = line(result_deadline);
  if (!result) return core::forward(result);
  switch (tcp80_line_kind(*result)) {
    case Tcp80LineKind::error:
    case Tcp80LineKind::refused:
      return tl::unexpected(refusal(request.command, *result));
    case Tcp80LineKind::accepted:
      return *result;  // for a read: the value 0000
    case Tcp80LineKind::data:
      if (kind == Kind::read) return *result;
      break;
    case Tcp80LineKind::ok:
      break;
  }
  return core::failure(ErrorCode::link, peer() + ' ' + request.command, "out of step: \"" + tcp80_shown(*result) + '"',
                       "the session is closed; connect again");
}

core::Result<std::string> Tcp80Client::run(const std::string& command, const std::string& operands, Kind kind) {
  if (!open_) return core::failure(ErrorCode::link, peer(), "not connected", "connect first");
  const auto control = [](char c) { return c >= 0 && c < ' '; };  // a line end would begin another command
  if (std::any_of(operands.begin(), operands.end(), control))
    return core::failure(ErrorCode::usage, peer() + ' ' + command, "its operands hold control characters",
                         "give printable text");
  const Tcp80Request request = tcp80_request(command, operands);
  const int tries = kind == Kind::read ? 2 : 1;
  for (int attempt = 1;; ++attempt) {
    core::Status opened;
    if (!link_) opened = open_session();
    auto answer = opened ? run_once(request, kind) : core::Result<std::string>(core::forward(opened));
    const bool broke = !answer && session_broke(answer.error());
    if (broke || !keep_alive_) link_.reset();
    if (answer) return answer;
    if (broke && attempt < tries) continue;
    if (broke) open_ = false;
    return tl::unexpected(trail_.onto(std::move(answer.error())));
  }
}

core::Status Tcp80Client::control(const std::string& command, const std::string& operands) {
  auto answer = run(command, operands, Kind::control);
  if (!answer) return core::forward(answer);
  return {};
}

template <class Parse>
auto Tcp80Client::read(const std::string& command, const std::string& operands, Parse parse)
    -> decltype(parse(std::string_view{})) {
  auto answer = run(command, operands, Kind::read);
  if (!answer) return core::forward(answer);
  auto value = parse(*answer);
  if (value) return value;
  link_.reset();  // perhaps out of step; the next command opens a new session
  return tl::unexpected(trail_.onto(std::move(value.error())));
}

core::Result<RobotState> Tcp80Client::read_status() { return read("RSTATS", "", parse_rstats); }
core::Result<std::vector<Alarm>> Tcp80Client::read_alarms() { return read("RALARM", "", parse_ralarm); }
core::Result<std::vector<std::int32_t>> Tcp80Client::read_pulses() { return read("RPOSJ", "", parse_rposj); }
core::Result<CurrentJob> Tcp80Client::read_job() { return read("RJSEQ", "", parse_rjseq); }

core::Result<CartesianPosition> Tcp80Client::read_position(int frame) {
  return read("RPOSC", std::to_string(frame) + ",0",
              [frame](std::string_view line) { return parse_rposc(line, frame); });
}

core::Result<std::int32_t> Tcp80Client::read_integer(VariableType type, int number) {
  return read("SAVEV", tcp80_read_variable(type, number),
              [type](std::string_view line) { return parse_integer_variable(line, type); });
}

core::Result<double> Tcp80Client::read_real(int number) {
  return read("SAVEV", tcp80_read_variable(VariableType::real, number), parse_real_variable);
}

core::Result<std::string> Tcp80Client::read_string(int number) {
  return run("SAVEV", tcp80_read_variable(VariableType::string, number), Kind::read);
}

core::Result<VariablePosition> Tcp80Client::read_position_variable(int number) {
  return read("SAVEV", tcp80_read_variable(VariableType::position, number),
              [number](std::string_view line) { return parse_position_variable(line, number); });
}

core::Result<std::vector<std::uint8_t>> Tcp80Client::read_contacts(int first, int groups) {
  return read("IOREAD", std::to_string(first) + ',' + std::to_string(groups * 8),
              [groups](std::string_view line) { return parse_ioread(line, static_cast<std::size_t>(groups)); });
}

core::Status Tcp80Client::write_integer(VariableType type, int number, std::int32_t value) {
  return control("LOADV", tcp80_write_integer(type, number, value));
}

core::Status Tcp80Client::write_real(int number, double value) {
  return control("LOADV", tcp80_write_real(number, value));
}

core::Status Tcp80Client::write_string(int number, const std::string& value) {
  return control("LOADV", tcp80_write_string(number, value));
}

core::Status Tcp80Client::write_position_variable(int number, const VariablePosition& position) {
  return control("LOADV", tcp80_write_position(number, position));
}

core::Status Tcp80Client::write_contacts(int first, const std::vector<std::uint8_t>& groups) {
  std::string operands = std::to_string(first) + ',' + std::to_string(groups.size() * 8);
  for (const int byte : groups) operands += ',' + std::to_string(byte);
  return control("IOWRITE", operands);
}

core::Status Tcp80Client::hold(bool on) { return control("HOLD", on ? "1" : "0"); }
core::Status Tcp80Client::reset_alarm() { return control("RESET", ""); }
core::Status Tcp80Client::cancel_error() { return control("CANCEL", ""); }
core::Status Tcp80Client::servo(bool on) { return control("SVON", on ? "1" : "0"); }
core::Status Tcp80Client::start_job(const std::string& job) { return control("START", job); }

core::Status Tcp80Client::move(const DirectMove& move) {
  const Tcp80Move m = tcp80_move(move);
  return control(m.command, m.operands);
}

core::Status Tcp80Client::move_pulses(const PulseMove& move) {
  if (move.line) return tl::unexpected(lacks("straight moves in pulses whose layout is known"));
  const Tcp80Move m = tcp80_move(move);
  return control(m.command, m.operands);
}

core::Result<std::vector<std::string>> Tcp80Client::list_jobs() {
  return read("RJDIR", "*",
              [](std::string_view line) -> core::Result<std::vector<std::string>> { return parse_rjdir(line); });
}

core::Status Tcp80Client::delete_job(const std::string& job) { return control("DELETE", job); }

core::Status Tcp80Client::set_mode(bool play) { return control("MODE", play ? "2" : "1"); }
core::Status Tcp80Client::set_cycle(Cycle cycle) { return control("CYCLE", std::to_string(static_cast<int>(cycle))); }
core::Status Tcp80Client::lock_pendant(bool on) { return control("HLOCK", on ? "1" : "0"); }
core::Status Tcp80Client::show_message(const std::string& text) {
  if (text.size() > 30) throw std::invalid_argument("a message has at most 30 bytes");
  return control("MDSP", text);
}
core::Status Tcp80Client::select_job(const std::string& job, int line) {
  return control("JSEQ", job + ',' + std::to_string(line));
}
core::Status Tcp80Client::set_master_job(const std::string& job) { return control("SETMJ", job); }

core::Result<std::string> Tcp80Client::read_user_frame(int number) {
  if (number < 1 || number > 64) throw std::invalid_argument("user frames are 1 to 64");
  return run("RUFRAME", std::to_string(number), Kind::read);
}

}  // namespace pickcell::robot
