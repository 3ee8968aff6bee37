#include "pickcell/server/frame_message.hpp"

#include <gtest/gtest.h>

#include <random>
#include <stdexcept>
#include <string>

namespace pickcell::server {
namespace {

/// Read by shifting, not by the encoder's way.
std::uint64_t little_endian(const std::vector<std::byte>& m, std::size_t at, int bytes) {
  std::uint64_t v = 0;
  for (int i = bytes - 1; i >= 0; --i)
    v = v << 8 | std::to_integer<std::uint64_t>(m.at(at + static_cast<std::size_t>(i)));
  return v;
}

TEST(FrameMessage, EveryFieldStandsWhereTheDocumentPutsIt) {
  std::mt19937_64 random(7);
  for (int round = 0; round < 500; ++round) {
    FrameHeader h;
    h.kind = static_cast<FrameKind>(1 + random() % 4);
    h.camera = static_cast<std::uint16_t>(random());
    h.frame_id = static_cast<std::uint32_t>(random());
    h.exposed_unix_us = random();
    h.width_px = 1 + static_cast<int>(random() % 16384);
    h.height_px = 1 + static_cast<int>(random() % 16384);
    h.scale_permille = 1 + static_cast<int>(random() % 65535);
    h.flags = static_cast<std::uint16_t>(random());
    const std::string overlay(random() % 300, 'o');
    const std::vector<std::byte> jpeg(random() % 300, std::byte{0x77});
    const auto m = encode_frame_message(h, overlay, jpeg);
    ASSERT_EQ(m.size(), 32 + overlay.size() + jpeg.size());
    EXPECT_EQ(std::string(
                  {static_cast<char>(m[0]), static_cast<char>(m[1]), static_cast<char>(m[2]), static_cast<char>(m[3])}),
              "VMF1");
    EXPECT_EQ(little_endian(m, 4, 1), 1u);
    EXPECT_EQ(little_endian(m, 5, 1), static_cast<std::uint64_t>(h.kind));
    EXPECT_EQ(little_endian(m, 6, 2), h.camera);
    EXPECT_EQ(little_endian(m, 8, 4), h.frame_id);
    EXPECT_EQ(little_endian(m, 12, 4), overlay.size());
    EXPECT_EQ(little_endian(m, 16, 8), h.exposed_unix_us);
    EXPECT_EQ(little_endian(m, 24, 2), static_cast<std::uint64_t>(h.width_px));
    EXPECT_EQ(little_endian(m, 26, 2), static_cast<std::uint64_t>(h.height_px));
    EXPECT_EQ(little_endian(m, 28, 2), static_cast<std::uint64_t>(h.scale_permille));
    EXPECT_EQ(little_endian(m, 30, 2), h.flags);
    for (std::size_t i = 0; i < overlay.size(); ++i) ASSERT_EQ(m[32 + i], std::byte{'o'});
    for (std::size_t i = 0; i < jpeg.size(); ++i) ASSERT_EQ(m[32 + overlay.size() + i], std::byte{0x77});
  }
}

TEST(FrameMessage, WhatNoPageWouldTakeIsTheCallersFault) {
  FrameHeader good;
  good.width_px = good.height_px = 10;
  EXPECT_NO_THROW((void)encode_frame_message(good, "{}", {}));
  const auto bad = [&](auto edit) {
    FrameHeader h = good;
    edit(h);
    EXPECT_THROW((void)encode_frame_message(h, "{}", {}), std::invalid_argument);
  };
  bad([](FrameHeader& h) { h.width_px = 0; });
  bad([](FrameHeader& h) { h.height_px = 16385; });
  bad([](FrameHeader& h) { h.scale_permille = 0; });
  bad([](FrameHeader& h) { h.scale_permille = 65536; });
  EXPECT_THROW((void)encode_frame_message(good, std::string((1 << 20) + 1, ' '), {}), std::invalid_argument);
}

}  // namespace
}  // namespace pickcell::server
