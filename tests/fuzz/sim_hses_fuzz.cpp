// Datagrams of a host through the simulated High Speed Ethernet Server: requests and files, no sockets. Every request
// is answered with something that can be sent, and the arm never leaves its limits. Input: a byte for the door, then 16
// bit of length and a datagram, again and again; the identifier is put in, so that the fuzzer gets behind it.

#include <algorithm>
#include <cstdint>
#include <cstdlib>

#include "pickcell/sim/hses_commands.hpp"
#include "pickcell/sim/hses_files.hpp"
#include "pickcell/sim/job_interpreter.hpp"
#include "pickcell/sim/shipped_jobs.hpp"

namespace {

using namespace pickcell;

/// A datagram whose header is right where the fuzzer need not find out how.
robot::HsesBytes datagram(robot::HsesView raw, bool files) {
  robot::HsesBytes bytes(raw.begin(), raw.end());
  bytes.resize(std::max<std::size_t>(bytes.size(), robot::kHsesHeaderBytes));
  const std::size_t payload = bytes.size() - robot::kHsesHeaderBytes;
  constexpr std::uint8_t kStart[] = {'Y', 'E', 'R', 'C', 0x20, 0};
  std::copy(std::begin(kStart), std::end(kStart), bytes.begin());
  bytes[6] = static_cast<std::uint8_t>(payload & 0xFF);
  bytes[7] = static_cast<std::uint8_t>(payload >> 8);
  bytes[9] = files ? 2 : 1;
  bytes[10] &= 1;
  return bytes;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const sim::ControllerSettings settings = [] {
    sim::ControllerSettings s;
    s.jobs = sim::shipped_jobs();
    return s;
  }();
  sim::ControllerState state(settings);
  sim::HsesFiles files;
  robot::HsesView left(data, size);
  while (left.size() > 3) {
    const bool file = (left[0] & 1) != 0;
    const std::size_t length = std::min<std::size_t>((left[1] | left[2] << 8) % 512, left.size() - 3);
    const auto request = robot::parse_hses_request(datagram(left.subspan(3, length), file));
    left = left.subspan(3 + length);
    if (!request) continue;
    const auto answer = file ? files.handle(state, *request) : std::optional(sim::execute_hses(state, *request));
    (void)sim::hses_command_name(*request);
    if (answer && robot::hses_bytes(*answer).size() > robot::kHsesHeaderBytes + robot::kHsesMostPayload) std::abort();
    if (answer && answer->id != request->id) std::abort();
    for (int i = 0; i < 3; ++i) sim::run_tick(state, 0.01);
    if (!sim::inside_limits(*state.arm, state.q)) std::abort();
  }
  return 0;
}
