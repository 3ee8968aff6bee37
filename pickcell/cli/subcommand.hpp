#pragma once
/// Subcommands register themselves: a .cpp of this folder that holds a static Registration is part of the binary.
///
///     core::Result<int> run(const Options& options, Io& io);
///     Runner add(CLI::App& app) {
///       auto options = std::make_shared<Options>();
///       app.add_option("--max", options->max, "...");
///       return [options](Io& io) { return run(*options, io); };
///     }
///     const Registration registered({"match", "find taught parts in pictures", add});

#include <functional>
#include <iosfwd>
#include <string>
#include <vector>

#include "pickcell/core/result.hpp"

namespace CLI {
class App;
}

namespace pickcell::cli {

/// Where a command writes: results for programs and people on out, everything else on err.
struct Io {
  std::ostream& out;
  std::ostream& err;
};

/// Does the work after the options are parsed. The value is the exit code: 0 done, 1 the asked-for result is negative.
/// An Error is printed by the program as one line and decides the exit code (core::exit_code).
using Runner = std::function<core::Result<int>(Io&)>;

struct Subcommand {
  std::string name;
  std::string summary;           ///< one line for --help
  Runner (*add)(CLI::App& app);  ///< declares the options; values live in what the Runner captures
};

/// A static object of this type makes the subcommand known. Before main() only.
class Registration {
 public:
  explicit Registration(Subcommand subcommand);
};

/// Sorted by name.
[[nodiscard]] std::vector<Subcommand> subcommands();

/// Runs `pickcell ARGS...` (without the program's name) and gives its exit code. Prints errors on io.err as
/// `pickcell: WHAT: why; remedy`. Values of options may begin with '-'.
[[nodiscard]] int run(std::vector<std::string> args, Io io);

}  // namespace pickcell::cli
