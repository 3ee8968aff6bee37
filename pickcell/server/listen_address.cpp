#include "pickcell/server/listen_address.hpp"

#include <arpa/inet.h>

#include <charconv>

namespace pickcell::server {

namespace {

constexpr const char* kRemedy = "use 127.0.0.1:8080, or [::1]:8080; from another machine go through an SSH tunnel";

/// Host and port text of "host:port" or "[host]:port"; host empty when the text has neither form.
std::pair<std::string, std::string_view> split(std::string_view text) {
  const auto colon = text.rfind(':');
  if (text.starts_with('[')) {
    const auto bracket = text.find(']');
    if (bracket == std::string_view::npos || bracket + 1 != colon) return {};
    return {std::string(text.substr(1, bracket - 1)), text.substr(colon + 1)};
  }
  if (colon == std::string_view::npos || text.find(':') != colon) return {};
  return {std::string(text.substr(0, colon)), text.substr(colon + 1)};
}

bool is_loopback(const std::string& host) {
  in_addr v4{};
  if (inet_pton(AF_INET, host.c_str(), &v4) == 1) return (ntohl(v4.s_addr) >> 24) == 127;
  in6_addr v6{};
  return inet_pton(AF_INET6, host.c_str(), &v6) == 1 && IN6_IS_ADDR_LOOPBACK(&v6);
}

bool is_address(const std::string& host) {
  in6_addr any{};
  return inet_pton(AF_INET, host.c_str(), &any) == 1 || inet_pton(AF_INET6, host.c_str(), &any) == 1;
}

}  // namespace

core::Result<ListenAddress> parse_listen_address(std::string_view text) {
  const std::string what = "listen " + std::string(text);
  auto [host, port_text] = split(text);
  unsigned port = 0;
  const auto [end, error] = std::from_chars(port_text.data(), port_text.data() + port_text.size(), port);
  if (host.empty() || error != std::errc{} || end != port_text.data() + port_text.size() || port > 65535)
    return failure(core::ErrorCode::usage, what, "not ADDRESS:PORT", kRemedy);
  if (host == "localhost") host = "127.0.0.1";
  if (!is_address(host)) return failure(core::ErrorCode::usage, what, "not a numeric address", kRemedy);
  if (!is_loopback(host))
    return failure(core::ErrorCode::usage, what,
                   "only this machine may be served: other listeners need a password, which this version does not have",
                   kRemedy);
  return ListenAddress{host, static_cast<std::uint16_t>(port)};
}

bool names_loopback(std::string_view host_header) {
  std::string host(host_header);
  if (const auto parts = split(host_header); !parts.first.empty()) host = parts.first;
  if (host.starts_with('[') && host.ends_with(']')) host = host.substr(1, host.size() - 2);
  return host == "localhost" || is_loopback(host);
}

}  // namespace pickcell::server
