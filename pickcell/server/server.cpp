#include "pickcell/server/server.hpp"

#include <utility>  // Boost 1.74's awaitable.hpp needs it and does not include it

#include <atomic>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/websocket.hpp>
#include <mutex>
#include <set>
#include <thread>

#include "pickcell/core/log.hpp"
#include "pickcell/server/assets.hpp"
#include "pickcell/server/client_message.hpp"
#include "pickcell/server/frame_encoder.hpp"
#include "pickcell/server/http_api.hpp"
#include "pickcell/server/listen_address.hpp"
#include "pickcell/server/log_tail.hpp"
#include "pickcell/server/messages.hpp"
#include "pickcell/server/publisher.hpp"

namespace pickcell::server {

namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = beast::http;
namespace websocket = beast::websocket;
using asio::ip::tcp;
using beast::error_code;

constexpr std::size_t kMaxHeaderBytes = 8 << 10;
constexpr std::size_t kMaxBodyBytes = 16 << 10;
constexpr std::size_t kMaxMessageBytes = 64 << 10;
constexpr int kSendBufferBytes = 256 << 10;  // bounds what the kernel holds for a client that does not read
constexpr auto kHttpDeadline = std::chrono::seconds(15);
constexpr auto kHandshakeDeadline = std::chrono::seconds(5);  // to open and to close a WebSocket
constexpr auto kCheckInterval = std::chrono::milliseconds(250);

std::int64_t unix_us_now() {
  using namespace std::chrono;
  return duration_cast<microseconds>(system_clock::now().time_since_epoch()).count();
}

WallTime now() { return std::chrono::steady_clock::now(); }

std::string text(beast::string_view view) { return {view.data(), view.size()}; }

}  // namespace

/// Everything here runs in the server's thread, but ring(), add_log() and statistics().
class Server::Impl : public std::enable_shared_from_this<Server::Impl> {
 public:
  Impl(ServerSettings settings, cell::CellPort& cell)
      : settings_(std::move(settings)), cell_(cell), acceptor_(io_), publish_timer_(io_), check_timer_(io_) {}

  core::Status open();
  void run();
  void close();
  void ring();
  void add_log(const core::LogEntry& entry);
  Statistics statistics() const;
  std::uint16_t port() const { return port_; }
  const std::string& host() const { return host_; }

 private:
  class HttpConnection;
  class Page;
  friend class HttpConnection;
  friend class Page;

  void accept();
  void cell_changed();
  void publish();
  void check();
  HttpReply answer(const HttpRequest& request) { return api_->answer(request, now()); }
  bool may_view(const Page& asking) const;
  void page_came(const std::shared_ptr<Page>& page);
  void page_left(const ClientQueue& queue);
  void count(std::uint64_t Statistics::* what, std::uint64_t n = 1);

  ServerSettings settings_;
  cell::CellPort& cell_;
  asio::io_context io_{1};
  tcp::acceptor acceptor_;
  asio::steady_timer publish_timer_;
  asio::steady_timer check_timer_;
  std::string host_;
  std::uint16_t port_ = 0;
  std::unique_ptr<HttpApi> api_;
  std::unique_ptr<Publisher> publisher_;
  FrameEncoder encoder_;
  LogTail log_;
  std::set<std::shared_ptr<Page>> pages_;
  std::set<HttpConnection*> connections_;
  ShownFramePtr newest_;
  bool publishing_ = false;  ///< the timer runs
  bool stopping_ = false;
  WallTime next_heartbeat_{};
  std::atomic<bool> rung_{false};
  int listener_ = -1;
  int log_sink_ = -1;
  std::thread thread_;
  mutable std::mutex statistics_mutex_;
  Statistics statistics_;
};

/// One open page: what waits for it is in its queue, this only carries it out.
class Server::Impl::Page : public std::enable_shared_from_this<Page> {
 public:
  Page(Impl& server, beast::tcp_stream&& stream)
      : server_(server),
        socket_(std::move(stream)),
        timer_(server.io_),
        queue_(server.settings_.queue),
        rate_(server.settings_.max_messages_per_s) {}

  /// request outlives the handshake by being moved in.
  void open(http::request<http::string_body> request) {
    auto timeout = websocket::stream_base::timeout::suggested(beast::role_type::server);
    timeout.handshake_timeout = kHandshakeDeadline;
    timeout.idle_timeout = std::chrono::seconds(30);
    timeout.keep_alive_pings = true;
    socket_.set_option(timeout);
    socket_.set_option(websocket::stream_base::decorator(
        [](websocket::response_type& reply) { reply.set(http::field::sec_websocket_protocol, kProtocol); }));
    socket_.read_message_max(kMaxMessageBytes);
    socket_.auto_fragment(false);
    auto kept = std::make_shared<http::request<http::string_body>>(std::move(request));
    socket_.async_accept(*kept, [self = shared_from_this(), kept](error_code e) {
      if (e) return self->leave();
      self->queue_.mark(Topic::hello);
      self->queue_.mark(Topic::snap);
      self->read();
      self->pump();
    });
  }

  ClientQueue& queue() { return queue_; }
  [[nodiscard]] bool views() const { return queue_.video().has_value(); }
  [[nodiscard]] bool wants_log() const { return wants_log_; }

  /// Writes the next message unless one is being written.
  void pump() {
    if (closing_) return;
    const Outgoing out = queue_.next(now());
    if (out.empty()) return arm_timer();
    if (out.frame) {
      server_.count(&Statistics::frames_sent);
      bytes_ = server_.encoder_.message(out.frame->shown, out.frame->max_width_px, out.frame->quality);
      socket_.binary(true);
      return write(asio::buffer(*bytes_));
    }
    text_ = out.alarm ? *out.alarm : compose(*out.topic);
    if (text_.empty()) {  // nothing new after all
      queue_.written(now());
      return pump();
    }
    socket_.text(true);
    write(asio::buffer(text_));
  }

  void check() {
    switch (queue_.check(now())) {
      case QueueVerdict::fine:
        break;
      case QueueVerdict::video_dropped:
        no_video_why_ = "no acknowledgement for too long";
        break;
      case QueueVerdict::cut:
        return cut("does not read");
    }
    pump();
  }

  void send_alarm(const std::string& message) {
    if (!queue_.push_alarm(message)) close(websocket::close_code::try_again_later, "too many alarms wait");
  }

  void close(websocket::close_code code, const char* why) {
    if (std::exchange(closing_, true)) return;
    core::log(core::LogLevel::warning, "server", std::string("a page was closed: ") + why);
    socket_.async_close(websocket::close_reason(code, why), [self = shared_from_this()](error_code) { self->leave(); });
  }

  /// At once, without a word: for clients that take none.
  void cut(const char* why) {
    closing_ = true;
    if (*why != '\0') {
      core::log(core::LogLevel::warning, "server", std::string("a page was cut off: ") + why);
      server_.count(&Statistics::clients_cut);
    }
    beast::get_lowest_layer(socket_).close();
    leave();
  }

 private:
  void read() {
    socket_.async_read(inbox_, [self = shared_from_this()](error_code e, std::size_t) {
      if (e) return self->leave();
      self->received();
      self->inbox_.consume(self->inbox_.size());
      if (!self->closing_) self->read();
    });
  }

  void received() {
    if (!rate_.allow(now())) return close(websocket::close_code::policy_error, "too many messages");
    if (!socket_.got_text()) return close(websocket::close_code::unknown_data, "only text is understood");
    const auto data = inbox_.cdata();
    const auto message = parse_client_message({static_cast<const char*>(data.data()), data.size()});
    if (!message) return close(websocket::close_code::policy_error, "a message was not understood");
    if (const auto* acknowledge = std::get_if<Acknowledge>(&*message)) queue_.acknowledge(acknowledge->frame_id, now());
    if (std::holds_alternative<Resync>(*message)) queue_.mark(Topic::snap);
    if (const auto* subscribe = std::get_if<Subscribe>(&*message)) subscribed(*subscribe);
    pump();
  }

  void subscribed(const Subscribe& wish) {
    wants_log_ = wish.log;
    queue_.mark(Topic::log);
    if (!wish.video) return queue_.unsubscribe();
    if (!views() && !server_.may_view(*this)) {
      no_video_why_ = "too many pages show the picture";
      return queue_.mark(Topic::video);
    }
    queue_.subscribe(*wish.video);
    queue_.offer(server_.newest_);
  }

  std::string compose(Topic topic) {
    switch (topic) {
      case Topic::hello:
        return server_.publisher_->hello(unix_us_now());
      case Topic::snap:
        return server_.publisher_->snap(told_, server_.log_);
      case Topic::video:
        return Publisher::no_video(no_video_why_);
      case Topic::state:
        return server_.publisher_->state(told_);
      case Topic::log:
        return wants_log_ ? server_.publisher_->log(told_, server_.log_) : std::string();
      case Topic::heartbeat:
        return Publisher::heartbeat(unix_us_now());
    }
    return {};
  }

  void write(asio::const_buffer message) {
    socket_.async_write(message, [self = shared_from_this()](error_code e, std::size_t) {
      if (e) return self->leave();
      self->bytes_.reset();
      self->queue_.written(now());
      self->pump();
    });
  }

  /// A frame that waits for its time only.
  void arm_timer() {
    const auto wake = queue_.wake_at();
    if (!wake) return;
    timer_.expires_at(*wake);
    timer_.async_wait([self = shared_from_this()](error_code e) {
      if (!e) self->pump();
    });
  }

  void leave() {
    closing_ = true;
    timer_.cancel();
    if (server_.pages_.erase(shared_from_this()) == 1) server_.page_left(queue_);
  }

  Impl& server_;  ///< runs until the last page is gone
  websocket::stream<beast::tcp_stream> socket_;
  asio::steady_timer timer_;
  beast::flat_buffer inbox_;
  ClientQueue queue_;
  MessageRate rate_;
  Told told_;
  SharedBytes bytes_;  ///< being written
  std::string text_;   ///< being written
  std::string no_video_why_;
  bool wants_log_ = false;
  bool closing_ = false;
};

/// One socket that speaks HTTP, until it asks to become a page.
class Server::Impl::HttpConnection : public std::enable_shared_from_this<HttpConnection> {
 public:
  HttpConnection(Impl& server, tcp::socket&& socket) : server_(server), stream_(std::move(socket)) {
    server_.connections_.insert(this);
  }
  ~HttpConnection() { server_.connections_.erase(this); }
  HttpConnection(const HttpConnection&) = delete;
  HttpConnection& operator=(const HttpConnection&) = delete;

  void close() { stream_.close(); }

  void read() {
    parser_.emplace();
    parser_->header_limit(kMaxHeaderBytes);
    parser_->body_limit(kMaxBodyBytes);
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
    write(server_.answer(request), got.keep_alive(), got.method() == http::verb::head);
  }

  void upgrade(const HttpRequest& request) {
    const auto& protocols = parser_->get()[http::field::sec_websocket_protocol];
    const auto refuse = [&](int status, const char* code, const char* why) {
      write(error_reply(status, code, why), false, false);
    };
    if (request.target != "/ws") return refuse(404, "not_found", "the WebSocket is at /ws");
    if (!server_.api_->serves_host(request.host)) return refuse(421, "host", "this server has another name");
    if (!same_origin(request.origin, request.host)) return refuse(403, "origin", "the request comes from another site");
    if (!http::token_list(protocols).exists(kProtocol)) return refuse(400, "protocol", "the sub-protocol is cell.v1");
    if (server_.pages_.size() >= server_.settings_.max_clients) return refuse(503, "busy", "too many pages are open");
    stream_.expires_never();
    auto page = std::make_shared<Page>(server_, std::move(stream_));
    server_.page_came(page);
    page->open(parser_->release());
  }

  void write(HttpReply reply, bool keep_alive, bool head_only) {
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
    inbox_.consume(inbox_.size());
    stream_.async_read_some(inbox_.prepare(4096), [self = shared_from_this()](error_code e, std::size_t) {
      if (!e) self->drain();
    });
  }

  Impl& server_;
  beast::tcp_stream stream_;
  beast::flat_buffer inbox_;
  std::optional<http::request_parser<http::string_body>> parser_;
  std::optional<http::response<http::string_body>> message_;
  std::optional<http::response_serializer<http::string_body>> head_;
};

core::Status Server::Impl::open() {
  const auto address = parse_listen_address(settings_.listen);
  if (!address) return tl::unexpected(address.error());
  auto assets = settings_.web_root ? AssetTable::from_folder(*settings_.web_root) : AssetTable::embedded();
  if (!assets) return forward(assets);
  publisher_ = std::make_unique<Publisher>(assets->build());
  api_ = std::make_unique<HttpApi>(std::move(*assets), cell_, settings_.host_names);

  const tcp::endpoint endpoint(asio::ip::make_address(address->host), address->port);
  error_code e;
  acceptor_.open(endpoint.protocol(), e);
  if (!e) acceptor_.set_option(tcp::acceptor::reuse_address(true), e);
  if (!e) acceptor_.bind(endpoint, e);
  if (!e) acceptor_.listen(asio::socket_base::max_listen_connections, e);
  if (e)
    return failure(core::ErrorCode::device, "listen " + settings_.listen, e.message(),
                   "end the program that has the port, or choose another with --listen");
  host_ = address->host;
  port_ = acceptor_.local_endpoint().port();
  (void)publisher_->update(cell_.snapshot());
  newest_ = cell_.latest_frame();
  return {};
}

void Server::Impl::run() {
  next_heartbeat_ = now() + settings_.heartbeat;
  // The bells hold this object by themselves: one may still be in another thread's hand when it is taken down.
  listener_ = cell_.on_change([self = shared_from_this()] { self->ring(); });
  log_sink_ = core::add_log_sink([self = shared_from_this()](const core::LogEntry& entry) { self->add_log(entry); });
  accept();
  check();
  thread_ = std::thread([this] { io_.run(); });
}

void Server::Impl::close() {
  if (!thread_.joinable()) return;
  cell_.remove_listener(listener_);
  core::remove_log_sink(log_sink_);
  asio::post(io_, [this] {  // nothing is left to run then, and run() returns
    stopping_ = true;
    acceptor_.close();
    publish_timer_.cancel();
    check_timer_.cancel();
    while (!pages_.empty()) (*pages_.begin())->cut("");
    for (HttpConnection* connection : connections_) connection->close();
  });
  thread_.join();
}

void Server::Impl::accept() {
  acceptor_.async_accept([this](error_code e, tcp::socket socket) {
    if (!acceptor_.is_open()) return;
    if (!e && connections_.size() + pages_.size() < settings_.max_connections) {
      error_code ignored;
      socket.set_option(tcp::no_delay(true), ignored);
      socket.set_option(asio::socket_base::send_buffer_size(kSendBufferBytes), ignored);
      std::make_shared<HttpConnection>(*this, std::move(socket))->read();
    }
    accept();
  });
}

void Server::Impl::ring() {
  if (rung_.exchange(true)) return;
  asio::post(io_, [this] {  // dropped with io_ when the server has stopped
    rung_ = false;
    if (!stopping_) cell_changed();
  });
}

void Server::Impl::add_log(const core::LogEntry& entry) {
  log_.add(entry);
  ring();
}

/// A new picture goes out at once; texts are gathered for a moment.
void Server::Impl::cell_changed() {
  if (ShownFramePtr shown = cell_.latest_frame(); shown != newest_) {
    newest_ = std::move(shown);
    for (const auto& page : std::set(pages_)) {
      page->queue().offer(newest_);
      page->pump();
    }
  }
  if (std::exchange(publishing_, true)) return;
  publish_timer_.expires_after(settings_.publish_interval);
  publish_timer_.async_wait([this](error_code e) {
    publishing_ = false;
    if (!e && !stopping_) publish();
  });
}

void Server::Impl::publish() {
  const Publisher::Change change = publisher_->update(cell_.snapshot());
  for (const auto& page : std::set(pages_)) {
    for (const std::string& message : change.alarm_texts) page->send_alarm(message);
    if (change.state) page->queue().mark(Topic::state);
    page->queue().mark(Topic::log);
    page->pump();
  }
}

/// Asks the cell with every beat: a cell that hangs shows as a dead page, not as a calm one.
void Server::Impl::check() {
  if (now() >= next_heartbeat_) {
    next_heartbeat_ = now() + settings_.heartbeat;
    publish();
    for (const auto& page : pages_) page->queue().mark(Topic::heartbeat);
  }
  for (const auto& page : std::set(pages_)) page->check();
  check_timer_.expires_after(std::min<WallDuration>(kCheckInterval, settings_.heartbeat));
  check_timer_.async_wait([this](error_code e) {
    if (!e && !stopping_) check();
  });
}

bool Server::Impl::may_view(const Page& asking) const {
  std::size_t viewers = 0;
  for (const auto& page : pages_) viewers += page.get() != &asking && page->views() ? 1 : 0;
  return viewers < settings_.max_video_clients;
}

void Server::Impl::page_came(const std::shared_ptr<Page>& page) {
  pages_.insert(page);
  const std::lock_guard lock(statistics_mutex_);
  statistics_.clients = pages_.size();
}

void Server::Impl::page_left(const ClientQueue& queue) {
  const std::lock_guard lock(statistics_mutex_);
  statistics_.clients = pages_.size();
  statistics_.frames_replaced += queue.frames_replaced();
}

void Server::Impl::count(std::uint64_t Statistics::* what, std::uint64_t n) {
  const std::lock_guard lock(statistics_mutex_);
  statistics_.*what += n;
}

Server::Statistics Server::Impl::statistics() const {
  const std::lock_guard lock(statistics_mutex_);
  return statistics_;
}

Server::Server(ServerSettings settings, cell::CellPort& cell)
    : impl_(std::make_shared<Impl>(std::move(settings), cell)) {}

Server::~Server() { stop(); }

core::Status Server::start() {
  if (const core::Status opened = impl_->open(); !opened) return opened;
  impl_->run();
  return {};
}

void Server::stop() { impl_->close(); }

std::uint16_t Server::port() const { return impl_->port(); }

std::string Server::url() const {
  const std::string& host = impl_->host();
  return "http://" + (host.find(':') == std::string::npos ? host : "[" + host + "]") + ":" + std::to_string(port()) +
         "/";
}

Server::Statistics Server::statistics() const { return impl_->statistics(); }

}  // namespace pickcell::server
