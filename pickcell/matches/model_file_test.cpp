#include "pickcell/matches/model_file.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <limits>
#include <random>

#include "pickcell/core/file.hpp"

namespace pickcell::matches {
namespace {

Model small_model() {
  Model m;
  m.name = "winkel \xc3\xa4";
  m.date = "2026-01-02T03:04:05Z";
  m.picture.resize(5, 3);
  m.mask.resize(5, 3);
  for (int y = 0; y < 3; ++y)
    for (int x = 0; x < 5; ++x) {
      m.picture.at(x, y) = static_cast<std::uint8_t>(50 * y + x);
      m.mask.at(x, y) = x == 4 ? 0 : 255;
    }
  m.ref_x_px = 2.25;
  m.ref_y_px = -1.5;
  m.roi_x_px = 17;
  m.roi_y_px = 4;
  m.angle_deg = {170, 190};
  m.scale = {0.9, 1.1};
  m.height_m = 0.0125;
  m.grasps = {{1.5, 2, 45, true}, {0, 0, -90, false}};
  m.learnt = {2, {180}, 0.61, 0.55};
  return m;
}

void expect_equal(const Model& a, const Model& b) {
  EXPECT_EQ(a.name, b.name);
  EXPECT_EQ(a.date, b.date);
  for (const auto member : {&Model::picture, &Model::mask}) {
    ASSERT_EQ((a.*member).width(), (b.*member).width());
    ASSERT_EQ((a.*member).height(), (b.*member).height());
    for (int y = 0; y < (a.*member).height(); ++y)
      for (int x = 0; x < (a.*member).width(); ++x) ASSERT_EQ((a.*member).at(x, y), (b.*member).at(x, y));
  }
  for (const auto member : {&Model::ref_x_px, &Model::ref_y_px, &Model::roi_x_px, &Model::roi_y_px, &Model::height_m})
    EXPECT_EQ(a.*member, b.*member);
  for (const auto member : {&Model::angle_deg, &Model::scale}) {
    EXPECT_EQ((a.*member).lo, (b.*member).lo);
    EXPECT_EQ((a.*member).hi, (b.*member).hi);
  }
  ASSERT_EQ(a.grasps.size(), b.grasps.size());
  for (std::size_t i = 0; i < a.grasps.size(); ++i) {
    EXPECT_EQ(a.grasps[i].x_px, b.grasps[i].x_px);
    EXPECT_EQ(a.grasps[i].y_px, b.grasps[i].y_px);
    EXPECT_EQ(a.grasps[i].angle_deg, b.grasps[i].angle_deg);
    EXPECT_EQ(a.grasps[i].sym180, b.grasps[i].sym180);
  }
  EXPECT_EQ(a.learnt.symmetry_order, b.learnt.symmetry_order);
  EXPECT_EQ(a.learnt.ambiguous_deg, b.learnt.ambiguous_deg);
  EXPECT_EQ(a.learnt.second_best_self_match, b.learnt.second_best_self_match);
  EXPECT_EQ(a.learnt.suggested_min_score, b.learnt.suggested_min_score);
}

/// Puts the checksum right after a change, as only a program could.
std::vector<std::byte> sealed(std::vector<std::byte> bytes) {
  const std::uint32_t crc = core::crc32(std::span(bytes).first(bytes.size() - 4));
  for (std::size_t i = 0; i < 4; ++i) bytes[bytes.size() - 4 + i] = static_cast<std::byte>(crc >> (8 * i));
  return bytes;
}

TEST(ModelFile, RoundTripKeepsEveryField) {
  const Model model = small_model();
  const auto back = decode_model(encode_model(model), "a.pcm");
  ASSERT_TRUE(back) << back.error().line();
  expect_equal(model, *back);
}

TEST(ModelFile, RandomModelsSurviveARoundTrip) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> number(-100, 100);
  for (int round = 0; round < 200; ++round) {
    Model m = small_model();
    m.name.assign(random() % 40, static_cast<char>(random() % 256));
    m.picture.resize(1 + static_cast<int>(random() % 70), 1 + static_cast<int>(random() % 9));
    for (int y = 0; y < m.picture.height(); ++y)
      for (int x = 0; x < m.picture.width(); ++x) m.picture.at(x, y) = static_cast<std::uint8_t>(random());
    if (random() % 2)
      m.mask = image::Image();
    else
      m.mask = m.picture;
    m.ref_x_px = number(random);
    m.grasps.resize(random() % 5);
    for (Grasp& g : m.grasps) g = {number(random), number(random), number(random), random() % 2 == 0};
    m.learnt.ambiguous_deg.assign(random() % 6, number(random));
    const auto back = decode_model(encode_model(m), "a.pcm");
    ASSERT_TRUE(back) << back.error().line();
    expect_equal(m, *back);
  }
}

TEST(ModelFile, TheBytesAreTheSameOnEveryMachine) {
  Model m;
  m.name = "n";
  m.picture.resize(2, 1);
  m.picture.at(0, 0) = 7;
  m.picture.at(1, 0) = 9;
  const auto bytes = encode_model(m);
  const std::array<int, 38> begin{0x89, 'P', 'C', 'M', 13,  10, 26, 10, 1, 0, 0, 0, 127,
                                  0,    0,   0,                             // magic, version, length
                                  1,    0,   0,   0,   'n', 0,  0,  0,  0,  // name, date
                                  2,    0,   0,   0,   1,   0,  0,  0,  7, 9, 0, 0, 0};
  ASSERT_GT(bytes.size(), begin.size());
  EXPECT_EQ(bytes.size(), 16u + 127u + 4u);
  for (std::size_t i = 0; i < begin.size(); ++i) EXPECT_EQ(std::to_integer<int>(bytes[i]), begin[i]) << i;
}

TEST(ModelFile, EveryTruncationIsRefusedWithTheFilesName) {
  const auto bytes = encode_model(small_model());
  for (std::size_t n = 0; n < bytes.size(); ++n) {
    const auto back = decode_model(std::span(bytes).first(n), "part.pcm");
    ASSERT_FALSE(back) << n;
    EXPECT_EQ(back.error().what, "part.pcm");
    EXPECT_EQ(core::exit_code(back.error().code), 2);
  }
}

TEST(ModelFile, EveryFlippedBitIsRefused) {
  auto bytes = encode_model(small_model());
  for (std::size_t i = 0; i < bytes.size(); ++i)
    for (int bit = 0; bit < 8; ++bit) {
      bytes[i] ^= static_cast<std::byte>(1 << bit);
      EXPECT_FALSE(decode_model(bytes, "a.pcm")) << i << " " << bit;
      bytes[i] ^= static_cast<std::byte>(1 << bit);
    }
}

TEST(ModelFile, TrailingBytesAreRefused) {
  auto bytes = encode_model(small_model());
  bytes.push_back(std::byte{0});
  EXPECT_FALSE(decode_model(bytes, "a.pcm"));
}

TEST(ModelFile, AnotherVersionIsNamed) {
  auto bytes = encode_model(small_model());
  bytes[8] = std::byte{2};
  const auto back = decode_model(sealed(bytes), "a.pcm");
  ASSERT_FALSE(back);
  EXPECT_EQ(back.error().why, "a model of version 2, this program reads version 1");
}

TEST(ModelFile, DamageBehindAValidChecksumNeverBreaksTheReader) {
  const auto good = encode_model(small_model());
  std::mt19937 random(11);
  int accepted = 0;
  for (int round = 0; round < 20000; ++round) {
    auto bytes = good;
    for (unsigned k = 0; k <= random() % 3; ++k)
      bytes[16 + random() % (bytes.size() - 20)] = static_cast<std::byte>(random() % 3 == 0 ? 0xff : random());
    const auto back = decode_model(sealed(bytes), "a.pcm");
    accepted += back ? 1 : 0;
    if (back) {
      EXPECT_LE(back->picture.width() * back->picture.height(), 15);
      EXPECT_TRUE(std::isfinite(back->ref_x_px) && std::isfinite(back->learnt.second_best_self_match));
    }
  }
  EXPECT_GT(accepted, 0);
}

TEST(ModelFile, ValuesNoTaughtModelCanHaveAreRefused) {
  const auto refused = [](auto change) {
    Model m = small_model();
    change(m);
    return !decode_model(encode_model(m), "a.pcm");
  };
  EXPECT_TRUE(refused([](Model& m) { m.ref_x_px = std::numeric_limits<double>::quiet_NaN(); }));
  EXPECT_TRUE(refused([](Model& m) { m.angle_deg = {90, -90}; }));
  EXPECT_TRUE(refused([](Model& m) { m.scale = {0, 1}; }));
  EXPECT_TRUE(refused([](Model& m) { m.mask.resize(4, 3); }));
  EXPECT_TRUE(refused([](Model& m) { m.picture.resize(0, 0); }));
  EXPECT_TRUE(refused([](Model& m) { m.learnt.symmetry_order = 0; }));
  EXPECT_TRUE(refused([](Model& m) { m.learnt.suggested_min_score = 1.5; }));
}

TEST(ModelFile, SavedAndLoadedThroughAFile) {
  const auto path = std::filesystem::path(::testing::TempDir()) / "model_file_test.pcm";
  ASSERT_TRUE(save_model(path, small_model()));
  const auto back = load_model(path);
  ASSERT_TRUE(back);
  expect_equal(small_model(), *back);
  std::filesystem::remove(path);
  const auto gone = load_model(path);
  ASSERT_FALSE(gone);
  EXPECT_EQ(gone.error().what, path.string());
}

}  // namespace
}  // namespace pickcell::matches
