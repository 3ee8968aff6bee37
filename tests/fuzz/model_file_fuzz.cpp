// PART.pcm: raw bytes, and a valid model with edits behind a checksum that fits.

#include <cstdlib>

#include "pickcell/core/file.hpp"
#include "pickcell/matches/model_file.hpp"
#include "tests/fuzz/edits.hpp"

namespace {

using namespace pickcell;

std::vector<std::byte> seed() {
  matches::Model model;
  model.name = "part";
  model.date = "2026-01-01T00:00:00Z";
  model.picture.resize(4, 3);
  model.mask.resize(4, 3);
  model.grasps = {{1, 2, 3, true}};
  model.learnt.ambiguous_deg = {90, 180};
  return matches::encode_model(model);
}

void seal(std::vector<std::byte>& bytes) {
  if (bytes.size() < 20) return;
  const auto length = static_cast<std::uint32_t>(bytes.size() - 20);
  for (std::size_t i = 0; i < 4; ++i) bytes[12 + i] = static_cast<std::byte>(length >> (8 * i));
  const std::uint32_t crc = core::crc32(std::span(bytes).first(bytes.size() - 4));
  for (std::size_t i = 0; i < 4; ++i) bytes[bytes.size() - 4 + i] = static_cast<std::byte>(crc >> (8 * i));
}

/// What is accepted can be written and read again.
void check(std::span<const std::byte> bytes) {
  const auto model = matches::decode_model(bytes, "fuzz");
  if (model && !matches::decode_model(matches::encode_model(*model), "again")) std::abort();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  check(std::as_bytes(std::span(data, size)));
  static const std::vector<std::byte> valid = seed();
  auto bytes = fuzz::edited(valid, {data, size});
  seal(bytes);
  check(bytes);
  return 0;
}
