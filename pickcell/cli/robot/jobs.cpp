#include "pickcell/cli/robot/jobs.hpp"

#include <algorithm>
#include <filesystem>
#include <string_view>

#include "pickcell/core/file.hpp"

namespace pickcell::cli {

using core::ErrorCode;
using core::failure;
using core::Json;

namespace {

auto usage(std::string why) {
  return failure(
      ErrorCode::usage, "job", std::move(why),
      "job list | show NAME | download NAME [-o FILE] | upload FILE.JBI | delete NAME | select NAME | master NAME | "
      "start NAME");
}

core::Result<Json> list(robot::ControllerLink& link) {
  auto jobs = link.list_jobs();
  if (!jobs) return core::forward(jobs);
  auto current = link.read_job();
  Json out = Json::object().set("jobs", *jobs);
  if (current && !current->name.empty())
    out.set("job", current->name).set("line", current->line).set("step", current->step);
  return out;
}

core::Result<Json> download(robot::ControllerLink& link, const std::string& job, const std::string& file) {
  auto text = link.read_job_text(job);
  if (!text) return core::forward(text);
  Json out = Json::object().set("job", job).set("bytes", text->size());
  if (file.empty()) return out.set("text", *text);
  if (auto written = core::write_file_atomically(file, *text); !written) return core::forward(written);
  return out.set("file", file);
}

core::Result<Json> upload(robot::ControllerLink& link, const std::string& file) {
  constexpr std::size_t kMostBytes = 1u << 20;
  auto text = core::read_text_file(file, kMostBytes);
  if (!text) return core::forward(text);
  auto job = check_job_text(*text, file);
  if (!job) return core::forward(job);
  if (auto sent = link.write_job_text(*job, *text); !sent) return core::forward(sent);
  return Json::object().set("job", *job).set("bytes", text->size()).set("uploaded", true);
}

core::Result<Json> start(robot::ControllerLink& link, const std::string& job, const MoveLimits& limits) {
  if (auto may = may_move(link, limits); !may) return core::forward(may);
  auto state = link.read_status();
  if (!state) return core::forward(state);
  if (!state->servo)
    if (auto on = link.servo(true); !on) return core::forward(on);
  if (auto started = link.start_job(job); !started) {
    if (started.error().code != ErrorCode::link && started.error().code != ErrorCode::timeout)
      return core::forward(started);  // nothing was started
    // Nobody knows whether it runs: hold, never again.
    if (!link.connected()) (void)link.connect();
    started.error().remedy = link.hold(true) ? "the arm is held; look at it" : "press the emergency stop";
    return core::forward(started);
  }
  return Json::object().set("job", job).set("started", true);
}

std::vector<std::string_view> lines_of(std::string_view text) {
  std::vector<std::string_view> lines;
  while (!text.empty()) {
    const std::size_t end = text.find("\r\n");
    lines.push_back(text.substr(0, end));
    if (end == std::string_view::npos) break;
    text.remove_prefix(end + 2);
  }
  return lines;
}

}  // namespace

core::Result<std::string> check_job_text(const std::string& text, const std::string& file) {
  const auto bad = [&](std::size_t line, const std::string& why) {
    return failure(ErrorCode::unreadable, file, "line " + std::to_string(line) + ": " + why,
                   "save the job again from the controller or with CR LF line ends");
  };
  const auto lines = lines_of(text);
  if (lines.empty() || lines[0] != "/JOB") return bad(1, "a job begins with /JOB and CR LF");
  std::string name;
  std::string_view first, last;
  bool instructions = false;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    if (lines[i].find_first_of("\r\n") != std::string_view::npos) return bad(i + 1, "does not end with CR LF");
    if (lines[i].starts_with("//NAME ")) name = std::string(lines[i].substr(7));
    if (instructions && !lines[i].starts_with("//") && !lines[i].empty()) {
      if (first.empty()) first = lines[i];
      last = lines[i];
    }
    if (lines[i] == "//INST") instructions = true;
  }
  if (first != "NOP" || last != "END") return bad(lines.size(), "the first instruction must be NOP, the last END");
  if (name.empty() || name.size() > 32) return bad(1, "//NAME is missing or longer than 32 characters");
  const std::string stem = std::filesystem::path(file).stem().string();
  if (stem != name) return bad(1, "the job is called " + name + ", the file " + stem);
  return name;
}

core::Result<Json> run_job_request(robot::ControllerLink& link, const JobRequest& r) {
  const std::string what = r.words.empty() ? "list" : r.words[0];
  if (what == "list" && r.words.size() <= 1) return list(link);
  if (r.words.size() != 2) return usage(what + " needs one name");
  const std::string& name = r.words[1];
  constexpr std::size_t kMostCharacters = 32;
  const bool plain = std::all_of(name.begin(), name.end(), [](char c) { return c > ' ' && c <= '~' && c != ','; });
  if (what != "upload" && (name.empty() || name.size() > kMostCharacters || !plain))
    return usage("'" + name + "' is no name of a job: 1 to 32 printable characters without blanks and commas");
  if (what == "show") return download(link, name, "");
  if (what == "download") return download(link, name, r.output.empty() ? name + ".JBI" : r.output);
  if (what == "upload") return upload(link, name);
  if (what == "start") return start(link, name, r.limits);
  if (what == "select") {
    if (auto selected = link.select_job(name, 0); !selected) return core::forward(selected);
    return Json::object().set("job", name).set("selected", true);
  }
  if (what == "master") {
    if (auto set = link.set_master_job(name); !set) return core::forward(set);
    return Json::object().set("job", name).set("master", true);
  }
  if (what == "delete") {
    if (auto deleted = link.delete_job(name); !deleted) return core::forward(deleted);
    return Json::object().set("job", name).set("deleted", true);
  }
  return usage("'" + what + "' is no request");
}

}  // namespace pickcell::cli
