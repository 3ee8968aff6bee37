// Picture files: raw bytes, and edits of a valid file of every format.

#include <array>
#include <cmath>
#include <cstdlib>
#include <string_view>

#include "pickcell/core/file.hpp"
#include "pickcell/image/codec.hpp"
#include "tests/fuzz/edits.hpp"

namespace {

using namespace pickcell;
using Bytes = std::vector<std::byte>;

void put(Bytes& out, std::string_view text) {
  for (const char c : text) out.push_back(static_cast<std::byte>(c));
}
void put_little(Bytes& out, std::uint32_t v) {
  for (int shift = 0; shift < 32; shift += 8) out.push_back(static_cast<std::byte>(v >> shift));
}
void put_big(Bytes& out, std::uint32_t v) {
  for (int shift = 24; shift >= 0; shift -= 8) out.push_back(static_cast<std::byte>(v >> shift));
}

image::Image pattern() {
  image::Image out(16, 12);
  for (int y = 0; y < 12; ++y)
    for (int x = 0; x < 16; ++x) out.at(x, y) = static_cast<std::uint8_t>(x * 16 + y * 3);
  return out;
}

Bytes bmp() {
  Bytes out;
  put(out, "BM");
  for (const std::uint32_t v :
       {54u + 64u + 12u * 8u, 0u, 54u + 64u, 40u, 16u, 12u, 1u | 4u << 16, 0u, 0u, 0u, 0u, 16u, 0u})
    put_little(out, v);
  for (std::uint32_t i = 0; i < 16; ++i) put_little(out, i * 0x101010u);
  out.resize(out.size() + 12 * 8, std::byte{0x5a});
  return out;
}

void put_chunk(Bytes& out, std::string_view type, const Bytes& content) {
  put_big(out, static_cast<std::uint32_t>(content.size()));
  const std::size_t from = out.size();
  put(out, type);
  out.insert(out.end(), content.begin(), content.end());
  put_big(out, core::crc32(std::span(out).subspan(from)));
}

/// 4x4 grey, stored without compression: two header bytes, one block, Adler-32.
Bytes png() {
  Bytes out, header, raw, data;
  put(out, "\x89PNG\r\n\x1a\n");
  put_big(header, 4);
  put_big(header, 4);
  for (const int v : {8, 0, 0, 0, 0}) header.push_back(static_cast<std::byte>(v));
  for (int i = 0; i < 20; ++i) raw.push_back(static_cast<std::byte>(i % 5 == 0 ? 0 : i * 9));
  for (const int v : {0x78, 0x01, 0x01, 20, 0, 0xeb, 0xff}) data.push_back(static_cast<std::byte>(v));
  data.insert(data.end(), raw.begin(), raw.end());
  std::uint32_t a = 1, b = 0;
  for (const std::byte v : raw) {
    a = (a + std::to_integer<std::uint32_t>(v)) % 65521;
    b = (b + a) % 65521;
  }
  put_big(data, b << 16 | a);
  put_chunk(out, "IHDR", header);
  put_chunk(out, "IDAT", data);
  put_chunk(out, "IEND", {});
  return out;
}

/// Makes the checksum of every PNG chunk fit again.
void seal_png(Bytes& bytes) {
  std::size_t at = 8;
  while (at + 12 <= bytes.size()) {
    std::size_t length = 0;
    for (std::size_t i = 0; i < 4; ++i) length = length << 8 | std::to_integer<std::size_t>(bytes[at + i]);
    if (length > bytes.size() - at - 12) return;
    const std::uint32_t crc = core::crc32(std::span(bytes).subspan(at + 4, length + 4));
    for (std::size_t i = 0; i < 4; ++i) bytes[at + 8 + length + i] = static_cast<std::byte>(crc >> (24 - 8 * i));
    at += length + 12;
  }
}

std::array<Bytes, 4> seeds() {
  Bytes ppm;
  put(ppm, "P6 # c\n4 3 65535 ");
  ppm.resize(ppm.size() + 4 * 3 * 6, std::byte{0x77});
  return {png(), image::encode_jpeg(pattern().view(), 75), bmp(), ppm};
}

void check(std::span<const std::byte> bytes) {
  const auto picture = image::decode_grey(bytes, "fuzz");
  if (picture && picture->empty()) std::abort();
}

}  // namespace

extern "C" int LLVMFuzzerInitialize(int*, char***) {
  for (const Bytes& seed : seeds())
    if (!image::decode_grey(seed, "seed")) std::abort();
  return 0;
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  static const std::array<Bytes, 4> valid = seeds();
  const std::size_t which = data[0] % 5;
  const std::span<const std::uint8_t> rest(data + 1, size - 1);
  if (which == 4) {
    check(std::as_bytes(rest));
    return 0;
  }
  Bytes bytes = fuzz::edited(valid[which], rest);
  if (which == 0) seal_png(bytes);
  check(bytes);
  return 0;
}
