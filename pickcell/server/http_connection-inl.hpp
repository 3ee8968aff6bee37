#pragma once
/// One socket that speaks HTTP. A piece of server.cpp, which alone reads it.

#include <boost/asio/ip/tcp.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/websocket.hpp>
#include <memory>
#include <optional>

#include "pickcell/server/http_api.hpp"
#include "pickcell/server/messages.hpp"
#include "pickcell/server/page-inl.hpp"

namespace pickcell::server {

using asio::ip::tcp;

constexpr std::size_t kMaxHeaderBytes = 8 << 10;
constexpr std::size_t kMaxBodyBytes = 16 << 10;
constexpr auto kHttpDeadline = std::chrono::seconds(15);

inline std::string text(beast::string_view view) { return {view.data(), view.size()}; }

class HttpConnection;

/// What a connection asks of the server that holds it. All in the server's thread.
class HttpHost {
 public:
  virtual ~HttpHost() = default;
  virtual void connection_came(HttpConnection& connection) = 0;
  virtual void connection_left(HttpConnection& connection) = 0;
  virtual HttpReply answer(const HttpRequest& request) = 0;
  /// Why this request for a WebSocket is not granted.
  virtual std::optional<HttpReply> refuse_page(const HttpRequest& request, bool speaks_protocol) = 0;
  virtual void open_page(beast::tcp_stream&& stream, http::request<http::string_body> request) = 0;
};

/// One socket that speaks HTTP, until it asks to become a page.
class HttpConnection : public std::enable_shared_from_this<HttpConnection> {
 public:
  HttpConnection(HttpHost& host, tcp::socket&& socket) : host_(host), stream_(std::move(socket)) {
    host_.connection_came(*this);
  }
  ~HttpConnection() { host_.connection_left(*this); }
  HttpConnection(const HttpConnection&) = delete;
  HttpConnection& operator=(const HttpConnection&) = delete;

  void close() {
    waiting_since_.reset();
    stream_.close();
  }

  /// Since when nothing but the client's bytes is waited for; nothing while a reply is on its way. The one that waits
  /// longest makes room for a new client.
  [[nodiscard]] std::optional<WallTime> waiting_since() const { return waiting_since_; }

  void read() {
    parser_.emplace();
    parser_->header_limit(kMaxHeaderBytes);
    parser_->body_limit(kMaxBodyBytes);
    waiting_since_ = now();
    stream_.expires_after(kHttpDeadline);
    http::async_read(stream_, inbox_, *parser_, [self = shared_from_this()](error_code e, std::size_t) {
      if (e == http::error::body_limit)
        return self->write(error_reply(413, "too_large", "the request is larger than is read here"), false, false);
      if (e == http::error::header_limit)
        return self->write(error_reply(431, "too_large", "the headers are larger than is read here"), false, false);
      if (e == http::error::end_of_stream || e == beast::error::timeout || e == asio::error::operation_aborted) return;
      if (e) return self->write(error_reply(400, "http", "this is not HTTP"), false, false);
      self->received();
    });
  }

 private:
  void received() {
    const auto& got = parser_->get();
    const HttpRequest request{text(got.method_string()),
                              text(got.target()),
                              text(got[http::field::host]),
                              text(got[http::field::origin]),
                              text(got[http::field::content_type]),
                              text(got["Idempotency-Key"]),
                              text(got[http::field::accept_encoding]),
                              got.body()};
    if (websocket::is_upgrade(got)) return upgrade(request);
    write(host_.answer(request), got.keep_alive(), got.method() == http::verb::head);
  }

  void upgrade(const HttpRequest& request) {
    const auto& protocols = parser_->get()[http::field::sec_websocket_protocol];
    const auto refusal = host_.refuse_page(request, http::token_list(protocols).exists(kProtocol));
    if (refusal) return write(*refusal, false, false);
    stream_.expires_never();
    host_.open_page(std::move(stream_), parser_->release());
  }

  void write(HttpReply reply, bool keep_alive, bool head_only) {
    waiting_since_.reset();
    message_.emplace(static_cast<http::status>(reply.status), 11);
    for (const auto& [name, value] : common_headers()) message_->set(name, value);
    for (const auto& [name, value] : reply.headers) message_->set(name, value);
    message_->keep_alive(keep_alive);
    message_->body() = std::move(reply.body);
    message_->prepare_payload();
    const auto done = [self = shared_from_this(), keep_alive](error_code e, std::size_t) {
      if (e) return;
      if (keep_alive) return self->read();
      error_code ignored;
      self->stream_.socket().shutdown(tcp::socket::shutdown_send, ignored);
      self->drain();
    };
    stream_.expires_after(kHttpDeadline);
    if (!head_only) return http::async_write(stream_, *message_, done);
    head_.emplace(*message_);
    http::async_write_header(stream_, *head_, done);
  }

  /// Takes what still comes until the other side closes: closing with unread bytes would destroy the reply on its way.
  void drain() {
    if (!waiting_since_) waiting_since_ = now();
    inbox_.consume(inbox_.size());
    stream_.async_read_some(inbox_.prepare(4096), [self = shared_from_this()](error_code e, std::size_t) {
      if (!e) self->drain();
    });
  }

  HttpHost& host_;
  beast::tcp_stream stream_;
  beast::flat_buffer inbox_;
  std::optional<http::request_parser<http::string_body>> parser_;
  std::optional<http::response<http::string_body>> message_;
  std::optional<http::response_serializer<http::string_body>> head_;
  std::optional<WallTime> waiting_since_;
};

}  // namespace pickcell::server
