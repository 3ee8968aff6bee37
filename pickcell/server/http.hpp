#pragma once
/// One HTTP request and its reply as plain values: the API is tested without a socket.

#include <string>
#include <utility>
#include <vector>

namespace pickcell::server {

struct HttpRequest {
  std::string method;  ///< "GET", "HEAD", "POST", ...
  std::string target;  ///< path, perhaps with a query
  std::string host;
  std::string origin;  ///< empty: not from a page
  std::string content_type;
  std::string idempotency_key;
  std::string accept_encoding;
  std::string body;
};

struct HttpReply {
  int status = 200;
  std::vector<std::pair<std::string, std::string>> headers;  ///< without Content-Length
  std::string body;
};

}  // namespace pickcell::server
