// Bytes of a host through the simulated MotoROS: splitter, motion and I/O, no sockets, in either byte order (the first
// byte says which). The arm never leaves its limits, and every answer is a frame that can be sent.

#include <cstdint>
#include <cstdlib>

#include "pickcell/sim/job_interpreter.hpp"
#include "pickcell/sim/motoros_io.hpp"
#include "pickcell/sim/motoros_motion.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace pickcell;
  using namespace pickcell::sim;
  static const ControllerSettings settings;
  if (size == 0) return 0;
  const auto order = (data[0] & 1) != 0 ? robot::ByteOrder::big : robot::ByteOrder::little;
  ControllerState state(settings);
  MotoRosMotion motion;
  robot::MotoFrameSplitter splitter(order);
  splitter.feed({reinterpret_cast<const char*>(data + 1), size - 1});
  for (auto message = splitter.next(); message && *message; message = splitter.next()) {
    const MotoRosAnswer answer = is_motoros_io(**message)
                                     ? MotoRosAnswer{execute_motoros_io(state, **message), false, false}
                                     : motion.handle(state, **message);
    if (answer.frame) (void)robot::moto_bytes(*answer.frame, order);
    (void)motion.waited(state);
    (void)robot::moto_bytes(moto_frame(motion.status(state)), order);
    for (int i = 0; i < 5; ++i) {
      run_tick(state, 0.01);
      motion.tick(state, 0.01);
    }
    if (!inside_limits(*state.arm, state.q)) std::abort();
  }
  return 0;
}
