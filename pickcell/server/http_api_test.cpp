// Rooms of the HTTP side that need no socket; the whole is tested in tests/hmi/server_test.cpp.

#include "pickcell/server/http_api.hpp"

#include <gtest/gtest.h>

#include <filesystem>

#include "pickcell/core/file.hpp"
#include "pickcell/server/listen_address.hpp"
#include "pickcell/server/log_tail.hpp"

namespace pickcell::server {
namespace {

using namespace std::chrono_literals;
const WallTime kBegin = WallTime{} + 1h;

TEST(ListenAddress, LoopbackInEveryForm) {
  EXPECT_EQ(parse_listen_address("127.0.0.1:8080")->port, 8080);
  EXPECT_EQ(parse_listen_address("127.3.2.1:0")->host, "127.3.2.1");
  EXPECT_EQ(parse_listen_address("localhost:1")->host, "127.0.0.1");
  EXPECT_EQ(parse_listen_address("[::1]:80")->host, "::1");
}

TEST(ListenAddress, OthersAreRefusedAndNonsenseIsUsage) {
  for (const char* open : {"0.0.0.0:80", "[::]:80", "10.0.0.1:80", "128.0.0.1:80"})
    EXPECT_NE(parse_listen_address(open).error().why.find("password"), std::string::npos) << open;
  for (const char* bad : {"", ":", "127.0.0.1", "127.0.0.1:", ":80", "127.0.0.1:65536", "127.0.0.1:-1", "127.0.0.1:8x",
                          "::1:80", "[::1]80", "[::1:80", "cell.example:80"})
    EXPECT_EQ(parse_listen_address(bad).error().code, core::ErrorCode::usage) << bad;
}

TEST(ListenAddress, OnlyNamesOfThisMachineAreLoopback) {
  for (const char* own : {"localhost", "localhost:8080", "127.0.0.1", "127.0.0.1:1", "[::1]", "[::1]:80"})
    EXPECT_TRUE(names_loopback(own)) << own;
  for (const char* other : {"", "evil.example", "evil.example:80", "127.0.0.1.evil.example",
                            "localhost.evil.example:80", "10.0.0.1", "[::2]:80"})
    EXPECT_FALSE(names_loopback(other)) << other;
}

TEST(IdempotencyStore, KeepsTenMinutesAndNoMoreThanItsLimit) {
  IdempotencyStore store;
  store.keep("key-of-sixteen-1", "/a", HttpReply{200, {}, "one"}, kBegin);
  store.keep("key-of-sixteen-1", "/a", HttpReply{200, {}, "two"}, kBegin);
  ASSERT_NE(store.find("key-of-sixteen-1", "/a", kBegin + 9min), nullptr);
  EXPECT_EQ(store.find("key-of-sixteen-1", "/a", kBegin + 9min)->body, "one");
  EXPECT_TRUE(store.conflicts("key-of-sixteen-1", "/b", kBegin));
  EXPECT_EQ(store.find("key-of-sixteen-1", "/a", kBegin + 11min), nullptr);
  for (int i = 0; i < 5000; ++i) store.keep("key" + std::to_string(i), "/a", {}, kBegin + 12min);
  EXPECT_EQ(store.size(), IdempotencyStore::kLimit);
  EXPECT_EQ(store.find("key0", "/a", kBegin + 12min), nullptr);
  EXPECT_NE(store.find("key4999", "/a", kBegin + 12min), nullptr);
}

TEST(IdempotencyStore, KeysArePlain) {
  EXPECT_TRUE(well_formed_key("00112233445566778899aabbccddeeff"));
  EXPECT_TRUE(well_formed_key("123e4567-e89b-12d3-a456-426614174000"));
  for (const std::string& bad : {std::string(), std::string(15, 'a'), std::string(65, 'a'), std::string(20, ' '),
                                 std::string("key\nwith a line end")})
    EXPECT_FALSE(well_formed_key(bad)) << bad;
}

TEST(LogTail, KeepsTheLastTwoHundred) {
  LogTail tail;
  for (int i = 1; i <= 500; ++i) tail.add({i, core::LogLevel::info, "m", std::to_string(i)});
  const auto all = tail.after(0);
  ASSERT_EQ(all.size(), 200u);
  EXPECT_EQ(all.front().number, 301u);
  EXPECT_EQ(all.back().entry.text, "500");
  EXPECT_EQ(tail.after(498).size(), 2u);
  EXPECT_TRUE(tail.after(500).empty());
}

TEST(AssetTable, EmbeddedPageIsTheCommittedOne) {
  const auto embedded = AssetTable::embedded();
  ASSERT_TRUE(embedded) << embedded.error().line();
  const auto folder = AssetTable::from_folder(std::filesystem::path(PICKCELL_SOURCE_DIR) / "hmi/dist");
  ASSERT_TRUE(folder) << folder.error().line();
  EXPECT_EQ(embedded->build(), folder->build());
  ASSERT_EQ(embedded->all().size(), folder->all().size());
  for (const auto& [target, asset] : folder->all()) {
    const Asset* same = embedded->find(target);
    ASSERT_NE(same, nullptr) << target;
    EXPECT_EQ(same->body, asset.body) << target;
  }
  EXPECT_EQ(embedded->find("/"), embedded->find("/index.html"));
}

TEST(AssetTable, ABadFolderIsSaid) {
  const auto folder = std::filesystem::path(::testing::TempDir()) / "pickcell_assets";
  std::filesystem::create_directories(folder);
  for (const char* manifest :
       {"", "{}", R"({"build":"x","files":[]})", R"({"build":"x","files":[{"path":"../secret.js"}]})",
        R"({"build":"x","files":[{"path":"run.exe"}]})", R"({"build":"x","files":[{"path":"none.js"}]})"}) {
    ASSERT_TRUE(core::write_file_atomically(folder / "manifest.json", std::string_view(manifest)));
    EXPECT_FALSE(AssetTable::from_folder(folder)) << manifest;
  }
  std::filesystem::remove_all(folder);
  EXPECT_FALSE(AssetTable::from_folder(folder));
}

}  // namespace
}  // namespace pickcell::server
