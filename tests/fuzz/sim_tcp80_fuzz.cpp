// Bytes of a host through the simulated Ethernet Server: session and commands, no sockets. The arm never leaves its
// limits, and every answer is framed.

#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "pickcell/sim/job_interpreter.hpp"
#include "pickcell/sim/shipped_jobs.hpp"
#include "pickcell/sim/tcp80_commands.hpp"
#include "pickcell/sim/tcp80_session.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace pickcell::sim;
  static const ControllerSettings settings = [] {
    ControllerSettings s;
    s.jobs = shipped_jobs();
    return s;
  }();
  ControllerState state(settings);
  Tcp80Session session("YR");
  session.feed({reinterpret_cast<const char*>(data), size});
  while (const auto step = session.next()) {
    if (!step->command) continue;
    const auto answer = execute_tcp80(state, step->command->name, step->command->operands);
    if (!answer.bytes().ends_with(answer.kind == Tcp80Answer::Kind::data ? "\r" : "\r\n")) std::abort();
    for (int i = 0; i < 5; ++i) run_tick(state, 0.01);
    if (!inside_limits(*state.arm, state.q)) std::abort();
  }
  return 0;
}
