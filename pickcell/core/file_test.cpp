#include "pickcell/core/file.hpp"

#include <gtest/gtest.h>

namespace pickcell::core {
namespace {

TEST(File, WhatWasWrittenIsRead) {
  const auto path = std::filesystem::path(testing::TempDir()) / "pickcell_file_test.txt";
  ASSERT_TRUE(write_file_atomically(path, std::string_view("hello")));
  EXPECT_EQ(read_text_file(path).value(), "hello");
  std::filesystem::remove(path);
}

TEST(File, MissingFileFolderAndLimitAreNamed) {
  EXPECT_EQ(read_text_file("no/such/file").error().what, "no/such/file");
  EXPECT_EQ(read_text_file(testing::TempDir()).error().why, "not a regular file");
  const auto path = std::filesystem::path(testing::TempDir()) / "pickcell_file_test_limit.txt";
  ASSERT_TRUE(write_file_atomically(path, std::string_view("hello")));
  EXPECT_FALSE(read_text_file(path, 4));
  std::filesystem::remove(path);
}

TEST(File, AFailedWriteLeavesTheOldContent) {
  EXPECT_FALSE(write_file_atomically("no/such/folder/file", std::string_view("x")));
  EXPECT_FALSE(write_file_atomically("/dev/full/file", std::string_view("x")));
}

TEST(Crc32, KnownVector) {  // the check value of CRC-32/ISO-HDLC
  const std::string_view text = "123456789";
  EXPECT_EQ(crc32(std::as_bytes(std::span(text))), 0xCBF43926u);
}

}  // namespace
}  // namespace pickcell::core
