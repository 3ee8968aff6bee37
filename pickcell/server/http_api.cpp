#include "pickcell/server/http_api.hpp"

#include <algorithm>

#include "pickcell/core/log.hpp"
#include "pickcell/server/frame_message.hpp"
#include "pickcell/server/listen_address.hpp"
#include "pickcell/server/messages.hpp"
#include "pickcell/server/publisher.hpp"

namespace pickcell::server {

namespace {

using core::Json;

constexpr int kStillQuality = 90;
constexpr const char* kJson = "application/json";

HttpReply json_reply(int status, const Json& body) {
  return {status, {{"Content-Type", kJson}, {"Cache-Control", "no-store"}}, body.dump() + "\n"};
}

bool is_command(const std::string& path) {
  return path == "/api/v1/start" || path == "/api/v1/stop" || path == "/api/v1/reset";
}

bool is_json(const std::string& content_type) {
  const auto end = std::min(content_type.find(';'), content_type.size());
  std::string type = content_type.substr(0, end);
  while (type.ends_with(' ')) type.pop_back();
  std::transform(type.begin(), type.end(), type.begin(),
                 [](unsigned char c) { return static_cast<char>(c >= 'A' && c <= 'Z' ? c + 32 : c); });
  return type == kJson;
}

/// "gzip" among the codings, and not with q=0.
bool takes_gzip(const std::string& accept_encoding) {
  const std::size_t at = accept_encoding.find("gzip");
  if (at == std::string::npos) return false;
  const std::string rest = accept_encoding.substr(at + 4, accept_encoding.find(',', at) - at - 4);
  return rest.find("q=0") == std::string::npos || rest.find("q=0.") != std::string::npos;
}

HttpReply file_reply(const Asset& asset, bool gzip) {
  HttpReply reply{200,
                  {{"Content-Type", asset.content_type},
                   {"Cache-Control", asset.immutable ? "public, max-age=31536000, immutable" : "no-cache"},
                   {"Vary", "Accept-Encoding"}},
                  gzip && !asset.gzipped.empty() ? asset.gzipped : asset.body};
  if (gzip && !asset.gzipped.empty()) reply.headers.emplace_back("Content-Encoding", "gzip");
  return reply;
}

}  // namespace

const std::vector<std::pair<std::string, std::string>>& common_headers() {
  static const std::vector<std::pair<std::string, std::string>> headers{
      {"Content-Security-Policy",
       "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' blob: data:; connect-src 'self'; "
       "base-uri 'none'; frame-ancestors 'none'; form-action 'self'"},
      {"X-Content-Type-Options", "nosniff"},
      {"Referrer-Policy", "no-referrer"},
      {"Cross-Origin-Resource-Policy", "same-origin"},
  };
  return headers;
}

bool same_origin(const std::string& origin, const std::string& host) {
  return origin.empty() || origin == "http://" + host || origin == "https://" + host;
}

HttpReply error_reply(int status, const char* code, const std::string& text, const std::string& remedy) {
  Json details;
  details.set("code", code).set("text", text);
  details.set("remedies", remedy.empty() ? Json::array() : Json(Json::Array{remedy}));
  Json body;
  body.set("ok", false).set("error", std::move(details));
  return json_reply(status, body);
}

HttpApi::HttpApi(AssetTable assets, cell::CellPort& cell, std::vector<std::string> host_names)
    : assets_(std::move(assets)), cell_(cell), host_names_(std::move(host_names)) {}

bool HttpApi::serves_host(const std::string& host) const {
  if (names_loopback(host)) return true;
  const std::string name = host.substr(0, host.rfind(':'));
  return std::find(host_names_.begin(), host_names_.end(), name) != host_names_.end();
}

HttpReply HttpApi::answer(const HttpRequest& request, WallTime now) {
  const std::string path = request.target.substr(0, request.target.find('?'));
  if (!serves_host(request.host))
    return error_reply(421, "host", "this server is not " + request.host, "open it as http://127.0.0.1:PORT");
  if (request.method == "POST") return post(request, path, now);
  if (request.method == "GET" || request.method == "HEAD") return get(path, takes_gzip(request.accept_encoding));
  return error_reply(405, "method", "only GET, HEAD and POST are known");
}

HttpReply HttpApi::get(const std::string& path, bool gzip) {
  if (const Asset* asset = assets_.find(path)) return file_reply(*asset, gzip);
  if (path == "/api/version") {
    Json body;
    body.set("ok", true).set("data", Json::Object{{"build", assets_.build()}, {"proto", kProtocol}});
    return json_reply(200, body);
  }
  if (path == "/api/v1/state") return state();
  if (path == "/api/v1/camera/0/frame.jpg") return frame_jpg();
  if (is_command(path)) {
    HttpReply reply = error_reply(405, "method", "commands are sent with POST");
    reply.headers.emplace_back("Allow", "POST");
    return reply;
  }
  return error_reply(404, "not_found", "there is nothing at " + path);
}

HttpReply HttpApi::state() const {
  Publisher view(assets_.build());
  (void)view.update(cell_.snapshot());
  Json body;
  body.set("ok", true).set("data", view.snap_json());
  return json_reply(200, body);
}

HttpReply HttpApi::frame_jpg() {
  const ShownFramePtr shown = cell_.latest_frame();
  if (!shown) return error_reply(404, "no_picture", "the camera has not taken a picture yet");
  const SharedBytes bytes = encoder_.jpeg(shown->frame.picture, kMaxShownSidePx, kStillQuality);
  std::string body(bytes->size(), '\0');
  std::transform(bytes->begin(), bytes->end(), body.begin(), [](std::byte b) { return static_cast<char>(b); });
  return {200,
          {{"Content-Type", "image/jpeg"},
           {"Cache-Control", "no-store"},
           {"X-Frame-Id", std::to_string(wire_frame_id(*shown))}},
          std::move(body)};
}

HttpReply HttpApi::post(const HttpRequest& request, const std::string& path, WallTime now) {
  if (!is_command(path)) return error_reply(404, "not_found", "there is no command " + path);
  if (!same_origin(request.origin, request.host))
    return error_reply(403, "origin", "the request comes from another site");
  if (!is_json(request.content_type)) return error_reply(415, "content_type", "send the command as application/json");
  if (const auto body = core::parse_json(request.body.empty() ? "{}" : request.body, "body");
      !body || !body->is_object())
    return error_reply(400, "body", "the body is not a JSON object");
  const std::string& key = request.idempotency_key;
  const bool keyed = !key.empty();
  if (!keyed && path != "/api/v1/stop")  // nothing may stand in the way of a stop, and stopping twice is stopping
    return error_reply(400, "idempotency_key", "the header Idempotency-Key is missing",
                       "send a new random one per command");
  if (keyed && !well_formed_key(key))
    return error_reply(400, "idempotency_key", "Idempotency-Key must be 16 to 64 characters of 0-9 A-Z a-z - _");
  if (keyed && replies_.conflicts(key, path, now))
    return error_reply(422, "idempotency_key", "this Idempotency-Key was used for another command");
  if (const HttpReply* earlier = keyed ? replies_.find(key, path, now) : nullptr) return *earlier;
  HttpReply reply = command(path);
  if (keyed) replies_.keep(key, path, reply, now);
  return reply;
}

HttpReply HttpApi::command(const std::string& path) {
  const std::string verb = path.substr(path.rfind('/') + 1);
  const core::Status done = verb == "start" ? cell_.start() : verb == "stop" ? cell_.stop_cycle() : cell_.reset();
  core::log(done ? core::LogLevel::info : core::LogLevel::warning, "server",
            verb + (done ? " asked for on the page" : " refused: " + done.error().line()));
  if (!done) return json_reply(409, error_json(done.error()));
  Json body;
  body.set("ok", true).set("data", Json::Object{{"mode", cell::name(cell_.snapshot().mode)}});
  return json_reply(200, body);
}

}  // namespace pickcell::server
