#pragma once
/// Turns fuzz input into edits of a valid file, so that the fuzzer reaches what lies behind headers and checksums.

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace pickcell::fuzz {

/// Every three bytes of input are a place (16 bit) and a value; a place past the end cuts the file to value/256 of its
/// length.
inline std::vector<std::byte> edited(std::vector<std::byte> file, std::span<const std::uint8_t> input) {
  for (std::size_t i = 0; i + 2 < input.size() && !file.empty(); i += 3) {
    const std::size_t place = static_cast<std::size_t>(input[i]) | static_cast<std::size_t>(input[i + 1]) << 8;
    if (place < file.size())
      file[place] = std::byte{input[i + 2]};
    else
      file.resize(file.size() * input[i + 2] / 256);
  }
  return file;
}

}  // namespace pickcell::fuzz
