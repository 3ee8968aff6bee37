// Whatever arrives on the ports of the High Speed Ethernet Server, on both sides: no parser crashes, and what was
// understood is written back as the same bytes' meaning.

#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "pickcell/robot/hses_codec.hpp"

namespace {

using namespace pickcell::robot;

void parse_payload(HsesView payload) {
  (void)parse_hses_status(payload);
  (void)parse_hses_alarm(payload);
  (void)parse_hses_job(payload);
  (void)parse_hses_system(payload);
  (void)parse_hses_time(payload);
  (void)parse_hses_axis_names(payload);
  (void)parse_hses_axes(payload);
  (void)parse_hses_plural(payload, kHsesPluralB, 2);
  (void)parse_hses_plural(payload, kHsesPluralP, 1);
  if (const auto text = parse_hses_string(payload))
    if (text->size() > payload.size()) std::abort();
  if (const auto axes = parse_hses_axes_position(payload))
    if (parse_hses_axes_position(hses_payload(*axes)).value() != *axes) std::abort();
  (void)parse_hses_file_list({reinterpret_cast<const char*>(payload.data()), payload.size()});
  if (const auto move = parse_hses_move(payload)) {
    const auto again = parse_hses_move(hses_move(HsesMoveKind::line, *move).payload);
    if (!again || again->target != move->target) std::abort();
  }
  if (const auto move = parse_hses_pulse_move(payload)) {
    const auto again = parse_hses_pulse_move(hses_pulse_move(HsesMoveKind::joint, *move).payload);
    if (!again || again->pulses != move->pulses) std::abort();
  }
  const auto position = parse_hses_position(payload);
  if (!position) return;
  const auto variable = variable_position(*position);
  if (!variable) return;
  const auto again = variable_position(hses_position(*variable));
  if (!again || *again != *variable) std::abort();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const HsesView bytes(data, size);
  if (const auto answer = parse_hses_answer(bytes)) {
    const auto again = parse_hses_answer(hses_bytes(*answer));
    if (!again || *again != *answer) std::abort();
    parse_payload(answer->payload);
  }
  if (const auto request = parse_hses_request(bytes)) {
    const auto again = parse_hses_request(hses_bytes(*request));
    if (!again || *again != *request) std::abort();
  }
  parse_payload(bytes);
  return 0;
}
