#pragma once
/// Answers HTTP: the page's files, state and picture to look at, and the three commands. One thread at a time.

#include <string>
#include <utility>
#include <vector>

#include "pickcell/cell/cell_port.hpp"
#include "pickcell/server/assets.hpp"
#include "pickcell/server/frame_encoder.hpp"
#include "pickcell/server/http.hpp"
#include "pickcell/server/idempotency.hpp"

namespace pickcell::server {

/// The headers that the server adds to every reply.
[[nodiscard]] const std::vector<std::pair<std::string, std::string>>& common_headers();

/// A page of this server, or no page at all: browsers send the origin of the page that asks.
[[nodiscard]] bool same_origin(const std::string& origin, const std::string& host);

/// A reply {"ok":false,"error":{...}} with this status.
[[nodiscard]] HttpReply error_reply(int status, const char* code, const std::string& text,
                                    const std::string& remedy = {});

class HttpApi {
 public:
  /// host_names: names beside the loopback ones under which this server may be called.
  HttpApi(AssetTable assets, cell::CellPort& cell, std::vector<std::string> host_names);

  /// GET and HEAD: files of the page, /api/version, /api/v1/state, /api/v1/camera/0/frame.jpg (X-Frame-Id).
  /// POST /api/v1/{start,stop,reset} with application/json: 200 {"ok":true,"data":{...}}, 409 with the cell's words
  /// when it refuses. Start and reset demand an Idempotency-Key; the same key gets the same reply for 10 minutes.
  [[nodiscard]] HttpReply answer(const HttpRequest& request, WallTime now);
  /// A request for another host's name is not answered at all (421).
  [[nodiscard]] bool serves_host(const std::string& host) const;
  [[nodiscard]] const AssetTable& assets() const { return assets_; }

 private:
  HttpReply get(const std::string& path, bool gzip);
  HttpReply frame_jpg();
  HttpReply state() const;
  HttpReply post(const HttpRequest& request, const std::string& path, WallTime now);
  HttpReply command(const std::string& path);

  AssetTable assets_;
  cell::CellPort& cell_;
  std::vector<std::string> host_names_;
  IdempotencyStore replies_;
  FrameEncoder encoder_;
};

}  // namespace pickcell::server
