/// Answers of Video4Linux drivers.

#include <cstdint>
#include <span>

#include "pickcell/frames/v4l2_data.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  using namespace pickcell::frames::v4l2;  // NOLINT
  const auto data = std::as_bytes(std::span(bytes, size));
  if (const auto c = parse_capability(data); c && c->card.size() > 32) __builtin_trap();
  if (const auto f = parse_format_name(data)) (void)(fourcc_name(f->fourcc).size() + pfnc_of(f->fourcc).has_value());
  if (const auto l = parse_layout(data); l && (l->width_px < 1 || l->height_px < 1)) __builtin_trap();
  if (const auto c = parse_control(data); c && (c->key.size() > c->name.size() || c->step < 1)) __builtin_trap();
  if (const auto f = parse_filled(data); f && f->time_ns < 0) __builtin_trap();
  return 0;
}
