// The server on real sockets, without a browser.

#include "pickcell/server/server.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <future>
#include <set>
#include <thread>

#include "pickcell/core/json.hpp"
#include "pickcell/core/log.hpp"
#include "pickcell/server/assets.hpp"
#include "tests/hmi/raw_socket.hpp"
#include "tests/hmi/scripted_cell.hpp"

namespace pickcell::server {
namespace {

using testing::ask;
using testing::post;
using testing::RawPage;
using testing::RawSocket;
using testing::ScriptedCell;

constexpr const char* kKey = "00112233445566778899aabbccddeeff";
constexpr const char* kSubscribe =
    R"({"type":"sub","video":{"cam":0,"maxW":320,"maxFps":60,"quality":80},"topics":["log"]})";

class ServerTest : public ::testing::Test {
 protected:
  void serve(ServerSettings settings = {}) {
    settings.listen = "127.0.0.1:0";
    server_ = std::make_unique<Server>(settings, cell_);
    const auto started = server_->start();
    ASSERT_TRUE(started) << started.error().line();
    port_ = server_->port();
  }
  static ServerSettings quick() {
    ServerSettings settings;
    settings.heartbeat = std::chrono::milliseconds(50);
    settings.publish_interval = std::chrono::milliseconds(5);
    return settings;
  }
  /// The next text of this type; frames in between are counted.
  core::Json await(RawPage& page, const std::string& type) {
    while (const auto message = page.next()) {
      if (message->close) break;
      if (!message->text) {
        ++frames_;
        last_frame_ = message->data;
        continue;
      }
      auto json = core::parse_json(message->data, "message");
      EXPECT_TRUE(json) << message->data;
      if ((*json)["type"].string() == type) return *json;
    }
    ADD_FAILURE() << "no " << type;
    return {};
  }
  /// The id of the frame in a binary message.
  static std::uint32_t frame_id(const std::string& message) {
    std::uint32_t id = 0;
    for (std::size_t i = 0; i < 4; ++i)
      id |= static_cast<std::uint32_t>(static_cast<unsigned char>(message.at(8 + i))) << (8 * i);
    return id;
  }

  ScriptedCell cell_;
  std::unique_ptr<Server> server_;
  std::uint16_t port_ = 0;
  int frames_ = 0;
  std::string last_frame_;
};

TEST_F(ServerTest, ListensOnThisMachineOnly) {
  for (const char* address : {"0.0.0.0:0", "192.168.1.5:8080", "[::]:0"}) {
    ServerSettings settings;
    settings.listen = address;
    Server server(settings, cell_);
    const auto started = server.start();
    ASSERT_FALSE(started) << address;
    EXPECT_EQ(started.error().code, core::ErrorCode::usage);
    EXPECT_NE(started.error().line().find("password"), std::string::npos);
  }
}

TEST_F(ServerTest, APortInUseIsSaid) {
  serve();
  ServerSettings settings;
  settings.listen = "127.0.0.1:" + std::to_string(port_);
  Server second(settings, cell_);
  const auto started = second.start();
  ASSERT_FALSE(started);
  EXPECT_EQ(started.error().code, core::ErrorCode::device);
}

TEST_F(ServerTest, ServesEveryAssetFromTheBinaryWithItsHeaders) {
  serve();
  const auto table = AssetTable::embedded();
  ASSERT_TRUE(table);
  std::set<std::string> targets{"/"};
  for (const auto& [target, asset] : table->all()) targets.insert(target);
  EXPECT_GE(targets.size(), 5u);
  for (const std::string& target : targets) {
    SCOPED_TRACE(target);
    const Asset* asset = table->find(target);
    const auto answer = ask(port_, "GET", target);
    EXPECT_EQ(answer.status, 200);
    EXPECT_EQ(answer.body, asset->body);
    EXPECT_EQ(answer.header("Content-Type"), asset->content_type);
    EXPECT_EQ(answer.header("Cache-Control"), asset->immutable ? "public, max-age=31536000, immutable" : "no-cache");
    EXPECT_EQ(
        answer.header("Content-Security-Policy"),
        "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' blob: data:; connect-src 'self'; "
        "base-uri 'none'; frame-ancestors 'none'; form-action 'self'");
    EXPECT_EQ(answer.header("X-Content-Type-Options"), "nosniff");
    EXPECT_EQ(answer.header("Referrer-Policy"), "no-referrer");
    const auto head = ask(port_, "HEAD", target);
    EXPECT_EQ(head.status, 200);
    EXPECT_EQ(head.header("Content-Length"), std::to_string(asset->body.size()));
    EXPECT_TRUE(head.body.empty());
  }
  EXPECT_EQ(core::parse_json(ask(port_, "GET", "/api/version").body, "version").value()["data"]["build"].string(),
            table->build());
}

TEST_F(ServerTest, RefusesWhatItDoesNotServe) {
  serve();
  EXPECT_EQ(ask(port_, "GET", "/../etc/passwd").status, 404);
  EXPECT_EQ(ask(port_, "GET", "/manifest.json").status, 404);
  EXPECT_EQ(ask(port_, "DELETE", "/").status, 405);
  EXPECT_EQ(ask(port_, "GET", "/api/v1/start").status, 405);
  EXPECT_EQ(ask(port_, "GET", "/", "Host: evil.example\r\n").status, 421);
  EXPECT_EQ(ask(port_, "POST", "/api/v1/start", "Content-Type: application/json\r\n", std::string(20000, ' ')).status,
            413);
  EXPECT_EQ(ask(port_, "GET", "/", "X-Long: " + std::string(20000, 'a') + "\r\n").status, 431);
  RawSocket nonsense(port_);
  nonsense.send("nonsense\r\n\r\n");
  EXPECT_EQ(nonsense.read_to_end().substr(0, 12), "HTTP/1.1 400");
}

TEST_F(ServerTest, CommandsNeedTheirHeadersAndTheRightOrigin) {
  serve();
  const std::string json = "Content-Type: application/json\r\n";
  const std::string key = "Idempotency-Key: " + std::string(kKey) + "\r\n";
  EXPECT_EQ(ask(port_, "POST", "/api/v1/start", json, "{}").status, 400);
  EXPECT_EQ(ask(port_, "POST", "/api/v1/start", json + "Idempotency-Key: short\r\n", "{}").status, 400);
  EXPECT_EQ(ask(port_, "POST", "/api/v1/start", key + "Content-Type: text/plain\r\n", "{}").status, 415);
  EXPECT_EQ(ask(port_, "POST", "/api/v1/start", key + json, "[1").status, 400);
  EXPECT_EQ(post(port_, "/api/v1/start", kKey, "Origin: http://evil.example\r\n").status, 403);
  EXPECT_EQ(post(port_, "/api/v1/launch", kKey).status, 404);
  EXPECT_EQ(cell_.commands("start"), 0);
  EXPECT_EQ(ask(port_, "POST", "/api/v1/stop", json, "{}").status, 200) << "nothing stands in the way of a stop";
  EXPECT_EQ(post(port_, "/api/v1/start", kKey, "Origin: http://127.0.0.1:" + std::to_string(port_) + "\r\n").status,
            200);
}

TEST_F(ServerTest, ARetryNeverActsTwice) {
  serve();
  std::vector<std::future<testing::HttpAnswer>> asked;
  for (int i = 0; i < 5; ++i)
    asked.push_back(std::async(std::launch::async, [this] { return post(port_, "/api/v1/start", kKey); }));
  std::set<std::string> bodies;
  for (auto& a : asked) {
    const auto answer = a.get();
    EXPECT_EQ(answer.status, 200);
    bodies.insert(answer.body);
  }
  EXPECT_EQ(bodies.size(), 1u);
  EXPECT_EQ(cell_.commands("start"), 1);
  EXPECT_EQ(post(port_, "/api/v1/reset", kKey).status, 422) << "the same key for another command";
  const auto refused = post(port_, "/api/v1/start", "ffeeddccbbaa99887766554433221100");
  EXPECT_EQ(refused.status, 409);
  EXPECT_NE(refused.body.find("the cell is not idle"), std::string::npos);
}

TEST_F(ServerTest, GivesStateAndPictureToOtherPrograms) {
  serve();
  EXPECT_EQ(ask(port_, "GET", "/api/v1/camera/0/frame.jpg").status, 404) << "before the first picture";
  cell_.publish_frame(1);
  cell_.publish_frame(2);
  const auto picture = ask(port_, "GET", "/api/v1/camera/0/frame.jpg");
  EXPECT_EQ(picture.status, 200);
  EXPECT_EQ(picture.header("X-Frame-Id"), "2");
  EXPECT_EQ(picture.header("Content-Type"), "image/jpeg");
  EXPECT_EQ(picture.body.substr(0, 2), "\xFF\xD8");
  const auto state = core::parse_json(ask(port_, "GET", "/api/v1/state").body, "state");
  ASSERT_TRUE(state);
  EXPECT_EQ((*state)["data"]["state"]["cell"].string(), "Cell 7");
  EXPECT_EQ((*state)["data"]["counters"]["frames"].integer(), 2);
}

TEST_F(ServerTest, TellsAPageEverythingThenWhatChanges) {
  serve(quick());
  RawPage page(port_);
  ASSERT_EQ(page.status(), 101);
  EXPECT_NE(page.handshake().find("Sec-WebSocket-Protocol: cell.v1\r\n"), std::string::npos);
  EXPECT_EQ(await(page, "hello")["proto"].string(), "cell.v1");
  const auto snap = await(page, "snap");
  EXPECT_EQ(snap["state"]["mode"].string(), "idle");
  EXPECT_EQ(post(port_, "/api/v1/start", kKey).status, 200);
  const auto state = await(page, "state");
  EXPECT_EQ(state["mode"].string(), "running");
  EXPECT_FALSE(state.has("robot")) << "only what changed";
  EXPECT_EQ(state["base"].integer(), snap["rev"]["state"].integer());
  cell_.change([](cell::Snapshot& s) { s.alarms.push_back({"A", 1, "t", "c", {"r"}, 1, 1, 1, true}); });
  EXPECT_EQ(await(page, "alarm")["row"]["id"].string(), "A");
  cell_.change([](cell::Snapshot& s) { s.alarms.clear(); });
  EXPECT_EQ(await(page, "alarm")["row"]["gone"].boolean(), true);
  page.send(kSubscribe);
  core::log(core::LogLevel::warning, "test", "hello log");
  while (await(page, "log")["rows"].items().back()["text"].string() != "hello log" && !HasFailure()) {
  }
  await(page, "hb");
  page.send(R"({"type":"resync"})");
  EXPECT_EQ(await(page, "snap")["state"]["mode"].string(), "running");
}

/// News that come while a page is still being opened wait for it: two writes at once would end the server.
TEST_F(ServerTest, PagesOpenWhileTheCellChangesAllTheTime) {
  ServerSettings settings;
  settings.publish_interval = std::chrono::milliseconds(0);
  settings.heartbeat = std::chrono::milliseconds(1);
  serve(settings);
  std::jthread news([&](const std::stop_token& end) {
    for (std::int64_t n = 0; !end.stop_requested(); ++n)
      cell_.change([&](cell::Snapshot& s) {
        s.counters.placed = n;
        s.alarms.clear();
        s.alarms.push_back({"A" + std::to_string(n), 1, "t", "c", {"r"}, 1, 1, 1, true});
      });
  });
  for (int i = 0; i < 300; ++i) {
    RawPage page(port_);
    const auto first = page.next();
    ASSERT_TRUE(first && first->text) << i;
    EXPECT_EQ(core::parse_json(first->data, "message").value()["type"].string(), "hello");
  }
}

TEST_F(ServerTest, OneFrameIsOnItsWayAndOnlyTheNewestWaits) {
  serve(quick());
  RawPage page(port_);
  page.send(kSubscribe);
  await(page, "snap");
  cell_.publish_frame(1);
  while (frames_ == 0) await(page, "hb");
  for (int i = 0; i < 30; ++i) cell_.publish_frame(1);
  for (int i = 0; i < 4; ++i) await(page, "hb");
  EXPECT_EQ(frames_, 1) << "without acknowledgement nothing follows";
  page.send(R"({"type":"ack","f":7})");  // a frame that was never sent
  await(page, "hb");
  EXPECT_EQ(frames_, 1);
  page.send(R"({"type":"ack","f":1})");
  while (frames_ == 1) await(page, "hb");
  EXPECT_EQ(frame_id(last_frame_), 31u) << "the newest, not the next";
  EXPECT_EQ(last_frame_.substr(0, 4), "VMF1");
}

TEST_F(ServerTest, AReaderThatDoesNotReadIsCutOffAndOthersDoNotNotice) {
  ServerSettings settings = quick();
  settings.queue.write_stall = std::chrono::milliseconds(300);
  serve(settings);
  std::vector<std::unique_ptr<RawPage>> good;
  for (int i = 0; i < 3; ++i) good.push_back(std::make_unique<RawPage>(port_));
  RawPage bad(port_, {}, 4096);
  bad.send(kSubscribe);
  for (auto& page : good) await(*page, "snap");
  const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(30);
  while (server_->statistics().clients_cut == 0 && std::chrono::steady_clock::now() < deadline) {
    for (int i = 0; i < 100; ++i) core::log(core::LogLevel::info, "flood", std::string(1000, 'x'));
    for (auto& page : good) await(*page, "hb");
  }
  EXPECT_EQ(server_->statistics().clients_cut, 1u);
  for (auto& page : good) await(*page, "hb");
  EXPECT_EQ(server_->statistics().clients, 3u);
}

TEST_F(ServerTest, PagesThatMisbehaveAreClosed) {
  serve(quick());
  for (const std::string& said :
       {std::string("nonsense"), std::string(R"({"type":"start"})"), std::string(70000, ' ')}) {
    RawPage page(port_);
    page.send(said);
    auto message = page.next();
    while (message && !message->close) message = page.next();
    EXPECT_TRUE(message) << "ended without a word: " << said.substr(0, 20);
  }
  RawPage hasty(port_);
  for (int i = 0; i < 200; ++i) hasty.send(R"({"type":"ack","f":1})");
  auto message = hasty.next();
  while (message && !message->close) message = hasty.next();
  EXPECT_TRUE(message);
  RawPage calm(port_);
  await(calm, "hb");
}

TEST_F(ServerTest, RefusesPagesOfOthersAndTooMany) {
  ServerSettings settings = quick();
  settings.max_clients = 2;
  settings.max_video_clients = 1;
  serve(settings);
  EXPECT_EQ(RawPage(port_, "Origin: http://evil.example\r\n").status(), 403);
  EXPECT_EQ(RawPage(port_, {}, 0, "other.v1").status(), 400);
  RawPage first(port_);
  RawPage second(port_);
  await(first, "snap");
  await(second, "snap");
  EXPECT_EQ(RawPage(port_).status(), 503);
  first.send(kSubscribe);
  await(first, "hb");
  second.send(kSubscribe);
  EXPECT_EQ(await(second, "video")["on"].boolean(), false);
}

/// Browsers keep connections open without using them.
TEST_F(ServerTest, IdleConnectionsShutNobodyOut) {
  ServerSettings settings = quick();
  settings.max_connections = 8;
  serve(settings);
  RawPage page(port_);
  await(page, "snap");
  std::vector<std::unique_ptr<RawSocket>> idle;
  for (int i = 0; i < 50; ++i) {
    idle.push_back(std::make_unique<RawSocket>(port_));
    if (i % 2 == 0) idle.back()->send("GET / HT");
  }
  EXPECT_EQ(ask(port_, "GET", "/").status, 200);
  EXPECT_EQ(idle.front()->read_to_end(), "") << "the one that waited longest has made room";
  idle.back()->send("TP/1.1\r\nHost: 127.0.0.1:" + std::to_string(port_) + "\r\nConnection: close\r\n\r\n");
  await(page, "hb");
}

TEST_F(ServerTest, StopsWithPagesOpenAndCanBeFollowedByAnother) {
  serve(quick());
  RawPage page(port_);
  await(page, "snap");
  server_->stop();
  while (page.next()) {
  }
  cell_.publish_frame(1);  // rings at nobody
  serve(quick());
  EXPECT_EQ(ask(port_, "GET", "/").status, 200);
}

/// The cell's threads only ring: a thousand changes while a page is stuck take no longer than without it.
TEST_F(ServerTest, TheCellNeverWaitsForAPage) {
  serve(quick());
  RawPage stuck(port_, {}, 4096);
  stuck.send(kSubscribe);
  for (int i = 0; i < 1000; ++i) cell_.change([&](cell::Snapshot& s) { s.counters.placed = i; });
  RawPage late(port_);
  auto told = await(late, "snap")["counters"]["placed"].integer();
  while (told != 999 && !HasFailure()) told = await(late, "state")["counters"]["placed"].integer();
}

}  // namespace
}  // namespace pickcell::server
