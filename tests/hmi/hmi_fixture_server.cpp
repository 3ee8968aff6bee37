// The real server over a scripted cell, for the tests of the page: commands on stdin, one line each; `ready PORT` on
// stdout, then `done` after each command. Ends at the end of stdin.
//   frame [N]        N numbered pictures (default 1)      parts            a picture with a part in every state
//   alarm P TEXT     an alarm of priority P               alarms N         N different alarms at once
//   clear            no alarms                            fault TEXT       mode fault with a reason
//   counter NAME N   placed | missed | unknown            reject NAME N    turned down by reason
//   log LEVEL TEXT   a log line                           commands NAME    prints how often the page asked: `NAME
//   COUNT` root DIR         serves the page of that folder instead, on the same port (a restart) stop, serve closes the
//   server; opens it again on the same port stats            prints frames sent, clients, cut off

#include <chrono>
#include <filesystem>
#include <iostream>
#include <memory>
#include <sstream>

#include "pickcell/core/log.hpp"
#include "pickcell/server/server.hpp"
#include "tests/hmi/scripted_cell.hpp"

namespace {

using pickcell::server::Server;
using pickcell::server::ServerSettings;
using pickcell::testing::ScriptedCell;

std::int64_t unix_us_now() {
  using namespace std::chrono;
  return duration_cast<microseconds>(system_clock::now().time_since_epoch()).count();
}

class Fixture {
 public:
  bool serve(const std::optional<std::filesystem::path>& web_root) {
    ServerSettings settings;
    settings.listen = "127.0.0.1:" + std::to_string(port_);
    settings.host_names = {"cell.test"};
    settings.web_root = web_root;
    server_ = std::make_unique<Server>(settings, cell_);
    if (const auto started = server_->start(); !started) {
      std::cerr << started.error().line() << "\n";
      return false;
    }
    port_ = server_->port();
    return true;
  }
  [[nodiscard]] int port() const { return port_; }

  bool run(const std::string& line) {
    std::istringstream in(line);
    std::string verb;
    in >> verb;
    if (verb == "frame" || verb == "parts") return picture(verb == "parts", in);
    if (verb == "alarm" || verb == "alarms" || verb == "clear" || verb == "fault") return alarm(verb, in);
    if (verb == "counter" || verb == "reject") return counter(verb, in);
    if (verb == "stop") return server_.reset(), true;
    if (verb == "serve") return serve(std::nullopt);
    return others(verb, in);
  }

 private:
  bool picture(bool many, std::istringstream& in) {
    int n = 1;
    in >> n;
    for (int i = 0; i < n; ++i) cell_.publish_frame(unix_us_now(), many);
    return true;
  }

  bool alarm(const std::string& verb, std::istringstream& in) {
    int number = 1;
    if (verb.starts_with("alarm")) in >> number;
    std::string text;
    std::getline(in >> std::ws, text);
    cell_.change([&](pickcell::cell::Snapshot& s) {
      if (verb == "clear") s.alarms.clear();
      if (verb == "alarm") s.alarms.push_back(row("CODE_" + std::to_string(s.alarms.size()), number, text));
      for (int i = 0; verb == "alarms" && i < number; ++i)
        s.alarms.push_back(row("STORM_" + std::to_string(i), 2, "storm"));
      if (verb == "fault") {
        s.mode = pickcell::cell::Mode::fault;
        s.step = "standing";
        s.reason = text;
        s.remedy = "Look at the robot, then reset.";
      }
    });
    return true;
  }

  static pickcell::cell::CellAlarm row(const std::string& code, int priority, const std::string& text) {
    pickcell::cell::CellAlarm out;
    out.code = code;
    out.priority = priority;
    out.text = text;
    out.cause = "the controller reports it";
    out.remedies = {"Look whether the way of the arm is free.", "Clear the alarm on the pendant.", "Reset here."};
    out.first_unix_us = out.last_unix_us = unix_us_now();
    return out;
  }

  bool counter(const std::string& verb, std::istringstream& in) {
    std::string name;
    std::int64_t n = 0;
    in >> name >> n;
    cell_.change([&](pickcell::cell::Snapshot& s) {
      auto& c = s.counters;
      if (verb == "reject")
        c.rejected[name] = n;
      else
        (name == "placed" ? c.placed : name == "missed" ? c.missed : c.unknown) = n;
      c.submitted = c.placed + c.missed + c.unknown;
      c.picks_per_min = 11.4;
      c.match_ms_median = 21;
      c.match_ms_p95 = 34;
    });
    return true;
  }

  bool others(const std::string& verb, std::istringstream& in) {
    std::string first, rest;
    in >> first;
    std::getline(in >> std::ws, rest);
    if (verb == "log") {
      const auto level = first == "error"     ? pickcell::core::LogLevel::error
                         : first == "warning" ? pickcell::core::LogLevel::warning
                                              : pickcell::core::LogLevel::info;
      pickcell::core::log(level, "cell", rest);
    } else if (verb == "commands") {
      std::cout << first << " " << cell_.commands(first) << "\n";
    } else if (verb == "root") {
      server_.reset();
      return serve(first);
    } else if (verb == "stats") {
      const auto s = server_->statistics();
      std::cout << "stats " << s.frames_sent << " " << s.clients << " " << s.clients_cut << "\n";
    } else {
      return false;
    }
    return true;
  }

  ScriptedCell cell_;
  std::unique_ptr<Server> server_;
  int port_ = 0;
};

}  // namespace

int main() {
  Fixture fixture;
  if (!fixture.serve(std::nullopt)) return 3;
  std::cout << "ready " << fixture.port() << std::endl;
  for (std::string line; std::getline(std::cin, line);)
    std::cout << (fixture.run(line) ? "done" : "unknown: " + line) << std::endl;
  return 0;
}
