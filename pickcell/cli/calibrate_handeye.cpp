#include "pickcell/cli/calibrate.hpp"
namespace pickcell::cli {
Runner add_calibrate_handeye(CLI::App&) { return [](Io&) -> core::Result<int> { return 2; }; }
}
