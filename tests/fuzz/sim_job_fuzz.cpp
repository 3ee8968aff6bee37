// INFORM text through the parser; what it takes is run for a second of simulated time.

#include <cstdint>
#include <cstdlib>
#include <string_view>
#include <utility>

#include "pickcell/sim/controller_commands.hpp"
#include "pickcell/sim/job_interpreter.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace pickcell::sim;
  auto job = parse_job({reinterpret_cast<const char*>(data), size});
  if (!job) return 0;
  ControllerState state{ControllerSettings{}};
  const std::string name = job->name;
  state.load_job(std::move(*job));
  if (set_servo(state, true) != Refusal::none || start(state, name) != Refusal::none) std::abort();
  for (int i = 0; i < 100; ++i) run_tick(state, 0.01);
  if (!inside_limits(*state.arm, state.q)) std::abort();
  return 0;
}
