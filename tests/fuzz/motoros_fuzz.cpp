// Whatever a peer on ports 50240 to 50242 sends: frames do not depend on how the stream is cut, no parser crashes, and
// what was understood is written the same way again.

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "pickcell/robot/motoros_codec.hpp"

namespace {

using namespace pickcell::robot;

std::vector<MotoFrame> frames_of(std::string_view bytes, std::size_t piece, ByteOrder order) {
  MotoFrameSplitter splitter(order);
  std::vector<MotoFrame> frames;
  while (!bytes.empty()) {
    splitter.feed(bytes.substr(0, piece));
    bytes.remove_prefix(std::min(piece, bytes.size()));
    for (;;) {
      auto frame = splitter.next();
      if (!frame) return frames;
      if (!*frame) break;
      frames.push_back(**frame);
    }
  }
  return frames;
}

template <class Parsed, class... Type>
void same_again(const Parsed& parsed, const MotoFrame& frame, Type... type) {
  if (parsed && moto_frame(type..., *parsed).body != frame.body) std::abort();
}

void parse(const MotoFrame& f) {
  same_again(parse_moto_status(f), f);
  same_again(parse_moto_feedback(f), f);
  same_again(parse_moto_point(f), f);
  same_again(parse_moto_command(f), f);
  same_again(parse_moto_reply(f), f);
  same_again(parse_moto_select_tool(f), f);
  same_again(parse_moto_io_refusal(f), f);
  same_again(parse_moto_dh_parameters(f), f);
  same_again(parse_moto_address(f, f.type), f, f.type);
  same_again(parse_moto_write(f, f.type), f, f.type);
  same_again(parse_moto_value(f, f.type), f, f.type);
  same_again(parse_moto_written(f, f.type), f, f.type);
  (void)parse_moto_point_ex(f);
  (void)parse_moto_feedback_ex(f);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size < 2) return 0;
  const std::size_t piece = 1 + data[0] % 31;
  const ByteOrder order = data[1] % 2 ? ByteOrder::big : ByteOrder::little;
  const std::string_view bytes(reinterpret_cast<const char*>(data) + 2, size - 2);
  const auto whole = frames_of(bytes, bytes.size() + 1, order);
  if (frames_of(bytes, piece, order) != whole) std::abort();
  for (const MotoFrame& frame : whole) {
    parse(frame);
    if (frames_of(moto_bytes(frame, order), 7, order) != std::vector<MotoFrame>{frame}) std::abort();
  }
  return 0;
}
