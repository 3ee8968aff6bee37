#include "pickcell/frames/file_source.hpp"

#include <gtest/gtest.h>

#include <cstdint>
#include <filesystem>
#include <string>

#include "pickcell/core/file.hpp"

namespace pickcell::frames {
namespace {

class FileSourceTest : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = std::filesystem::path(::testing::TempDir()) /
              ("pickcell_files_" + std::string(::testing::UnitTest::GetInstance()->current_test_info()->name()));
    std::filesystem::remove_all(folder_);
    std::filesystem::create_directories(folder_);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  /// A 6x4 binary PGM of one grey value.
  void write(const std::string& name, char value, int width = 6) {
    const std::string header = "P5\n" + std::to_string(width) + " 4\n255\n";
    ASSERT_TRUE(
        core::write_file_atomically(folder_ / name, header + std::string(static_cast<std::size_t>(4 * width), value)));
  }

  std::filesystem::path folder_;
  core::SimulatedClock clock_{1'000'000};
  std::unique_ptr<core::Seat> seat_ = clock_.join("test");
};

TEST_F(FileSourceTest, GivesPicturesInTheOrderOfTheirNamesThenEnds) {
  write("b.pgm", 20);
  write("a.PGM", 10);
  ASSERT_TRUE(core::write_file_atomically(folder_ / "notes.txt", std::string_view("no picture")));
  auto source = FileSource::open(folder_, {}, clock_);
  ASSERT_TRUE(source) << source.error().line();
  EXPECT_EQ((*source)->info().width_px, 6);
  for (int expected : {10, 20}) {
    const auto frame = (*source)->grab(*seat_, core::duration_s(1));
    ASSERT_TRUE(frame) << frame.error().line();
    EXPECT_EQ(frame->picture->at(3, 2), expected);
    EXPECT_EQ(frame->sequence, static_cast<std::uint64_t>(expected / 10));
    EXPECT_EQ(frame->exposed_unix_us, 1'000'000);
    EXPECT_FALSE(frame->simulated);
  }
  const auto end = (*source)->grab(*seat_, core::duration_s(1));
  ASSERT_FALSE(end);
  EXPECT_EQ(end.error().code, core::ErrorCode::negative);
}

TEST_F(FileSourceTest, LoopsWhenAskedAndKeepsItsRate) {
  write("a.pgm", 10);
  write("b.pgm", 20);
  auto source = FileSource::open(folder_, {"cam-1", 4.0, true}, clock_);
  ASSERT_TRUE(source);
  for (int i = 0; i < 5; ++i) {
    const auto frame = (*source)->grab(*seat_, core::duration_s(1));
    ASSERT_TRUE(frame);
    EXPECT_EQ(frame->picture->at(0, 0), i % 2 == 0 ? 10 : 20);
    EXPECT_EQ(frame->camera_id, "cam-1");
  }
  EXPECT_DOUBLE_EQ(core::seconds(clock_.now()), 1.0);
  const auto late = (*source)->grab(*seat_, core::duration_s(0.1));
  ASSERT_FALSE(late);
  EXPECT_EQ(late.error().code, core::ErrorCode::timeout);
}

TEST_F(FileSourceTest, NamesADamagedPictureAndGoesOn) {
  write("a.pgm", 10);
  ASSERT_TRUE(core::write_file_atomically(folder_ / "b.pgm", std::string_view("P5\n6 4\n255\nshort")));
  write("c.pgm", 30, 8);
  write("d.pgm", 40);
  auto source = FileSource::open(folder_, {}, clock_);
  ASSERT_TRUE(source);
  ASSERT_TRUE((*source)->grab(*seat_, core::duration_s(1)));
  const auto damaged = (*source)->grab(*seat_, core::duration_s(1));
  ASSERT_FALSE(damaged);
  EXPECT_EQ(damaged.error().code, core::ErrorCode::device);
  EXPECT_NE(damaged.error().line().find("b.pgm"), std::string::npos);
  const auto other_size = (*source)->grab(*seat_, core::duration_s(1));
  ASSERT_FALSE(other_size);
  EXPECT_NE(other_size.error().line().find("c.pgm"), std::string::npos);
  const auto good = (*source)->grab(*seat_, core::duration_s(1));
  ASSERT_TRUE(good);
  EXPECT_EQ(good->sequence, 4u) << "lost pictures leave a gap";
}

TEST_F(FileSourceTest, RefusesFoldersWithoutPictures) {
  EXPECT_FALSE(FileSource::open(folder_, {}, clock_));
  const auto missing = FileSource::open(folder_ / "missing", {}, clock_);
  ASSERT_FALSE(missing);
  EXPECT_EQ(missing.error().code, core::ErrorCode::unreadable);
}

}  // namespace
}  // namespace pickcell::frames
