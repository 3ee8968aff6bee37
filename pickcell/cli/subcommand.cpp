#include "pickcell/cli/subcommand.hpp"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cctype>
#include <exception>
#include <ostream>

#include "pickcell/core/config.hpp"

namespace pickcell::cli {

namespace {

std::vector<Subcommand>& registry() {
  static std::vector<Subcommand> all;
  return all;
}

void print_overview(std::ostream& out) {
  out << "pickcell: vision-guided picking\n\nusage: pickcell COMMAND [OPTION]...   (pickcell COMMAND --help)\n\n";
  for (const Subcommand& s : subcommands())
    out << "  " << s.name << std::string(s.name.size() < 12 ? 12 - s.name.size() : 1, ' ') << s.summary << "\n";
}

int fail(Io& io, const core::Error& error) {
  std::string trail;
  for (const std::string& message : error.trail) trail += (trail.empty() ? " (last messages: " : " | ") + message;
  std::replace(trail.begin(), trail.end(), '\n', ' ');
  io.err << "pickcell: " << error.line() << trail << (trail.empty() ? "\n" : ")\n");
  return core::exit_code(error.code);
}

core::Error usage(std::string what, std::string why, std::string remedy) {
  return {core::ErrorCode::usage, std::move(what), std::move(why), std::move(remedy), {}};
}

std::string see_help(const std::string& command) { return "see 'pickcell " + command + " --help'"; }

/// The option of this name in the command or in one of its own subcommands.
const CLI::Option* find_option(const CLI::App& app, const std::string& name) {
  if (const CLI::Option* found = app.get_option_no_throw(name)) return found;
  for (const CLI::App* sub : app.get_subcommands([](const CLI::App*) { return true; }))
    if (const CLI::Option* found = find_option(*sub, name)) return found;
  return nullptr;
}

bool takes_value(const CLI::Option* option) { return option && option->get_items_expected_min() > 0; }

/// CLI11 takes `-180,180` behind `--angle` for an option of its own; `--angle=-180,180` it understands.
std::vector<std::string> join_dashed_values(const CLI::App& app, const std::vector<std::string>& args) {
  std::vector<std::string> out;
  for (std::size_t i = 0; i < args.size(); ++i) {
    out.push_back(args[i]);
    if (args[i] == "--") {
      out.insert(out.end(), args.begin() + static_cast<std::ptrdiff_t>(i) + 1, args.end());
      break;
    }
    const bool is_long = args[i].starts_with("--") && args[i].find('=') == std::string::npos;
    const bool is_short = args[i].size() == 2 && args[i][0] == '-' && args[i][1] != '-';
    if (!(is_long || is_short) || i + 1 >= args.size() || !takes_value(find_option(app, args[i]))) continue;
    const std::string& value = args[i + 1];
    if (value.size() < 2 || value[0] != '-' || find_option(app, value.substr(0, value.find('=')))) continue;
    out.back() += (is_long ? "=" : "") + value;
    ++i;
  }
  return out;
}

void collect_long_names(const CLI::App& app, std::vector<std::string>& names) {
  for (const CLI::Option* option : app.get_options())
    for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
  for (const CLI::App* sub : app.get_subcommands([](const CLI::App*) { return true; })) collect_long_names(*sub, names);
}

core::Error unexpected_argument(const CLI::App& app, const std::string& command) {
  const std::vector<std::string> left = app.remaining(true);
  const std::string argument = left.empty() ? "?" : left.front();
  if (!argument.starts_with("-")) return usage(command, "unexpected argument '" + argument + "'", see_help(command));
  std::vector<std::string> names;
  collect_long_names(app, names);
  const std::string near = core::nearest(argument.substr(0, argument.find('=')), names);
  return usage(command, "unknown option '" + argument + "'",
               near.empty() ? see_help(command) : "did you mean '" + near + "'?");
}

core::Error explain(const CLI::ParseError& error, const CLI::App& app, const std::string& command) {
  if (error.get_exit_code() == static_cast<int>(CLI::ExitCodes::ExtrasError)) return unexpected_argument(app, command);
  std::string why = error.what();
  if (why.size() > 1 && std::islower(static_cast<unsigned char>(why[1])))
    why[0] = static_cast<char>(std::tolower(static_cast<unsigned char>(why[0])));
  while (!why.empty() && (why.back() == '\n' || why.back() == ' ')) why.pop_back();
  return usage(command, why, see_help(command));
}

int run_subcommand(const Subcommand& subcommand, const std::vector<std::string>& args, Io& io) {
  CLI::App app(subcommand.summary, "pickcell " + subcommand.name);
  const Runner runner = subcommand.add(app);
  std::vector<std::string> reversed = join_dashed_values(app, args);
  std::reverse(reversed.begin(), reversed.end());
  try {
    app.parse(std::move(reversed));
  } catch (const CLI::CallForHelp&) {
    io.out << app.help();
    return 0;
  } catch (const CLI::ParseError& error) {
    return fail(io, explain(error, app, subcommand.name));
  }
  const auto code = runner(io);
  io.out.flush();
  if (code && !io.out)
    return fail(io, {core::ErrorCode::unreadable, "stdout", "the answer cannot be written", "check what reads it", {}});
  return code ? *code : fail(io, code.error());
}

}  // namespace

Registration::Registration(Subcommand subcommand) { registry().push_back(std::move(subcommand)); }

std::vector<Subcommand> subcommands() {
  std::vector<Subcommand> out = registry();
  std::sort(out.begin(), out.end(), [](const auto& a, const auto& b) { return a.name < b.name; });
  return out;
}

int run(std::vector<std::string> args, Io io) {
  if (args.empty()) return fail(io, usage("command", "none given", "see 'pickcell --help'"));
  if (args[0] == "--help" || args[0] == "-h" || args[0] == "help") {
    print_overview(io.out);
    return 0;
  }
  if (args[0] == "--version") {
    io.out << "pickcell " << PICKCELL_VERSION << "\n";
    return 0;
  }
  std::vector<std::string> names;
  for (const Subcommand& subcommand : subcommands()) {
    names.push_back(subcommand.name);
    if (subcommand.name != args[0]) continue;
    try {
      return run_subcommand(subcommand, {args.begin() + 1, args.end()}, io);
    } catch (const std::exception& error) {
      return fail(io, usage(subcommand.name, error.what(), "please report this with the command line"));
    }
  }
  const std::string near = core::nearest(args[0], names);
  return fail(
      io, usage(args[0], "no such command", near.empty() ? "see 'pickcell --help'" : "did you mean '" + near + "'?"));
}

}  // namespace pickcell::cli
