#include "pickcell/server/client_message.hpp"

#include <algorithm>
#include <string>

#include "pickcell/core/json.hpp"

namespace pickcell::server {

namespace {

using core::ErrorCode;
using core::failure;
using core::Json;

constexpr std::string_view kName = "page message";

tl::unexpected<core::Error> refuse(std::string why) {
  return failure(ErrorCode::usage, std::string(kName), std::move(why));
}

/// A finite number of the object, clamped; otherwise when the key is absent; nothing when it is no number.
std::optional<double> number_in(const Json& object, std::string_view key, double otherwise, double low, double high) {
  if (!object.has(key)) return otherwise;
  const auto value = object[key].number();
  if (!value || !(*value == *value)) return std::nullopt;
  return std::clamp(*value, low, high);
}

core::Result<ClientMessage> parse_subscribe(const Json& message) {
  Subscribe out;
  for (const Json& topic : message["topics"].items()) out.log = out.log || topic.string() == "log";
  const Json& video = message["video"];
  if (video.is_null()) return ClientMessage(out);
  if (!video.is_object()) return refuse("sub: video is neither an object nor null");
  const auto camera = video.has("cam") ? video["cam"].integer() : std::optional<std::int64_t>(0);
  if (!camera || *camera != 0) return refuse("sub: there is one camera, 0");
  const auto width = number_in(video, "maxW", 1280, 160, 4096);
  const auto fps = number_in(video, "maxFps", 15, 0.2, 60);
  const auto quality = number_in(video, "quality", 80, 30, 95);
  if (!width || !fps || !quality) return refuse("sub: maxW, maxFps and quality are numbers");
  out.video = VideoRequest{0, static_cast<int>(*width), *fps, static_cast<int>(*quality)};
  return ClientMessage(out);
}

}  // namespace

core::Result<ClientMessage> parse_client_message(std::string_view text) {
  auto message = core::parse_json(text, kName);
  if (!message) return forward(message);
  const std::string& type = (*message)["type"].string();
  if (type == "sub") return parse_subscribe(*message);
  if (type == "resync") return ClientMessage(Resync{});
  if (type == "ack") {
    const auto id = (*message)["f"].integer();
    if (!id || *id < 0 || *id > UINT32_MAX) return refuse("ack: f is not a frame number");
    return ClientMessage(Acknowledge{static_cast<std::uint32_t>(*id)});
  }
  return refuse("unknown type: sub, ack and resync are known");
}

bool MessageRate::allow(WallTime now) {
  if (last_ != WallTime{})
    tokens_ = std::min(per_s_, tokens_ + per_s_ * std::chrono::duration<double>(now - last_).count());
  last_ = now;
  if (tokens_ < 1) return false;
  tokens_ -= 1;
  return true;
}

}  // namespace pickcell::server
