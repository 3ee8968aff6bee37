#include "pickcell/cli/calibrate.hpp"
namespace pickcell::cli {
Runner add_calibrate_verify(CLI::App&) { return [](Io&) -> core::Result<int> { return 2; }; }
}
