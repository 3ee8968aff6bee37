// Messages as the server writes them, kept as files that the page's parser is tested with
// (hmi/test/unit/golden.test.mjs). PICKCELL_WRITE_GOLDEN=1 writes them anew.

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>

#include "pickcell/core/file.hpp"
#include "pickcell/server/frame_message.hpp"
#include "pickcell/server/messages.hpp"
#include "pickcell/server/publisher.hpp"
#include "tests/hmi/scripted_cell.hpp"

namespace pickcell::server {
namespace {

const std::filesystem::path kFixtures = std::filesystem::path(PICKCELL_SOURCE_DIR) / "hmi/test/fixtures";

void expect_golden(const std::string& name, std::span<const std::byte> made) {
  const auto path = kFixtures / name;
  if (std::getenv("PICKCELL_WRITE_GOLDEN") != nullptr) {
    ASSERT_TRUE(core::write_file_atomically(path, made));
  }
  const auto kept = core::read_file(path);
  ASSERT_TRUE(kept) << kept.error().line();
  EXPECT_TRUE(std::ranges::equal(*kept, made)) << name << " differs: the page's parser is tested with another form";
}

/// The picture's bytes stand for themselves: what a JPEG library writes differs between its versions.
TEST(PageMessage, FrameIsTheGoldenFile) {
  testing::ScriptedCell cell;
  for (int i = 0; i < 5; ++i) cell.publish_frame(1'767'225'600'123'456, true);
  const auto shown = cell.latest_frame();
  FrameHeader header;
  header.camera = 2;
  header.frame_id = 5;
  header.exposed_unix_us = 1'767'225'600'123'456;
  header.width_px = 320;
  header.height_px = 256;
  header.scale_permille = 500;
  header.flags = kFlagSimulated | kFlagOverlayPending;
  constexpr std::array<std::byte, 6> kPicture{std::byte{0xFF}, std::byte{0xD8}, std::byte{1},
                                              std::byte{2},    std::byte{0xFF}, std::byte{0xD9}};
  expect_golden("frame.bin", encode_frame_message(header, overlay_json(*shown).dump(), kPicture));
}

TEST(PageMessage, TextsAreTheGoldenFile) {
  testing::ScriptedCell cell;
  LogTail log;
  Publisher publisher("0123456789abcdef");
  Told told;
  constexpr std::int64_t kTime = 1'767'225'600'000'000;
  std::string lines = publisher.hello(kTime) + "\n";
  const auto update = [&] {
    const auto change = publisher.update(cell.snapshot());
    for (const std::string& alarm : change.alarm_texts) lines += alarm + "\n";
    if (change.state && told.state) lines += publisher.state(told) + "\n";
  };
  update();
  lines += publisher.snap(told, log) + "\n";
  cell.change([](cell::Snapshot& s) {
    s.mode = cell::Mode::fault;
    s.reason = "link lost — \"TCP 80\"";
    s.counters.placed = 3;
    s.counters.rejected["score"] = 2;
    s.robot.connected = false;
    s.alarms.push_back(
        {"LINK_LOST", 1, "Link lost", "cable", {"Plug it in"}, 1'767'225'600'000'000, 1'767'225'601'000'000, 2, true});
  });
  update();
  log.add({kTime, core::LogLevel::warning, "robot", "no answer"});
  lines += publisher.log(told, log) + "\n";
  cell.change([](cell::Snapshot& s) { s.alarms.clear(); });
  update();
  lines += Publisher::no_video("too many pages show the picture") + "\n" + Publisher::heartbeat(kTime) + "\n";
  lines += publisher.snap(told, log) + "\n";
  expect_golden("messages.jsonl", std::as_bytes(std::span(lines)));
}

}  // namespace
}  // namespace pickcell::server
