// Whatever a peer on port 80 sends: lines do not depend on how the stream is cut, and no parser crashes on a line.

#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "pickcell/robot/tcp80_codec.hpp"

namespace {

using namespace pickcell::robot;

std::vector<std::string> lines_of(std::string_view bytes, std::size_t piece) {
  Tcp80LineSplitter splitter;
  std::vector<std::string> lines;
  while (!bytes.empty()) {
    if (!splitter.feed(bytes.substr(0, piece))) return {};
    bytes.remove_prefix(std::min(piece, bytes.size()));
  }
  while (auto line = splitter.next()) lines.push_back(*line);
  return lines;
}

void parse(std::string_view line) {
  (void)tcp80_line_kind(line);
  (void)tcp80_fault_code(line);
  (void)tcp80_keeps_alive(line);
  (void)parse_rstats(line);
  (void)parse_rposc(line, 0);
  (void)parse_rposj(line);
  (void)parse_ralarm(line);
  (void)parse_rjseq(line);
  (void)parse_integer_variable(line, VariableType::byte);
  (void)parse_real_variable(line);
  (void)parse_ioread(line, 2);
  const auto position = parse_position_variable(line, 10);
  if (!position) return;
  // What was understood can be written, and is understood the same way again.
  const auto again = parse_position_variable(tcp80_position_fields(*position), 10);
  if (!again || again->index() != position->index()) std::abort();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const std::size_t piece = 1 + data[0] % 9;
  const std::string_view bytes(reinterpret_cast<const char*>(data) + 1, size - 1);
  const auto whole = lines_of(bytes, bytes.size() + 1);
  if (lines_of(bytes, piece) != whole) std::abort();
  for (const std::string& line : whole) parse(line);
  return 0;
}
