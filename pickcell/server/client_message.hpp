#pragma once
/// What a page may say over the WebSocket: subscribe, acknowledge, ask for everything anew. Commands go by HTTP.

#include <cstdint>
#include <optional>
#include <string_view>
#include <variant>

#include "pickcell/core/result.hpp"
#include "pickcell/server/adaptive_video.hpp"

namespace pickcell::server {

/// {"type":"sub","video":{"cam":0,"maxW":1280,"maxFps":15,"quality":80}|null,"topics":["log"]}
struct Subscribe {
  std::optional<VideoRequest> video;
  bool log = false;
};
/// {"type":"ack","f":1234}
struct Acknowledge {
  std::uint32_t frame_id = 0;
};
/// {"type":"resync"}
struct Resync {};

using ClientMessage = std::variant<Subscribe, Acknowledge, Resync>;

/// Refuses anything else with the reason. Numbers are held to maxW 160..4096, maxFps 0.2..60, quality 30..95; there is
/// one camera, 0.
[[nodiscard]] core::Result<ClientMessage> parse_client_message(std::string_view text);

/// Lets so many messages through per second, with bursts of the same size.
class MessageRate {
 public:
  explicit MessageRate(double per_s) : per_s_(per_s), tokens_(per_s) {}
  [[nodiscard]] bool allow(WallTime now);

 private:
  double per_s_;
  double tokens_;
  WallTime last_{};
};

}  // namespace pickcell::server
