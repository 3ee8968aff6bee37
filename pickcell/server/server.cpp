#include "pickcell/server/server.hpp"

#include <algorithm>
#include <atomic>
#include <boost/asio/post.hpp>
#include <mutex>
#include <set>
#include <thread>

#include "pickcell/server/assets.hpp"
#include "pickcell/server/http_connection-inl.hpp"
#include "pickcell/server/listen_address.hpp"

namespace pickcell::server {

constexpr int kSendBufferBytes = 256 << 10;  // bounds what the kernel holds for a client that does not read
constexpr auto kCheckInterval = std::chrono::milliseconds(250);

/// Everything here runs in the server's thread, but ring(), add_log() and statistics().
class Server::Impl : public std::enable_shared_from_this<Server::Impl>, public PageHost, public HttpHost {
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
  void accept();
  void cell_changed();
  void publish();
  void check();
  void make_room();

  FrameEncoder& encoder() override { return encoder_; }
  Publisher& publisher() override { return *publisher_; }
  const LogTail& log() override { return log_; }
  const ShownFramePtr& newest() override { return newest_; }
  bool may_view(const Page& asking) override;
  void page_left(const std::shared_ptr<Page>& page) override;
  void count(std::uint64_t Statistics::* what) override;

  void connection_came(HttpConnection& connection) override { connections_.insert(&connection); }
  void connection_left(HttpConnection& connection) override { connections_.erase(&connection); }
  HttpReply answer(const HttpRequest& request) override { return api_->answer(request, now()); }
  std::optional<HttpReply> refuse_page(const HttpRequest& request, bool speaks_protocol) override;
  void open_page(beast::tcp_stream&& stream, http::request<http::string_body> request) override;

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
    if (!e) {
      make_room();
      error_code ignored;
      socket.set_option(tcp::no_delay(true), ignored);
      socket.set_option(asio::socket_base::send_buffer_size(kSendBufferBytes), ignored);
      std::make_shared<HttpConnection>(*this, std::move(socket))->read();
    }
    accept();
  });
}

/// A crowd of idle connections, such as browsers keep, shuts nobody out: the one that has waited longest gives way.
void Server::Impl::make_room() {
  if (connections_.size() + pages_.size() < settings_.max_connections) return;
  HttpConnection* oldest = nullptr;
  for (HttpConnection* connection : connections_) {
    if (!connection->waiting_since()) continue;
    if (oldest == nullptr || *connection->waiting_since() < *oldest->waiting_since()) oldest = connection;
  }
  if (oldest != nullptr) oldest->close();
}

std::optional<HttpReply> Server::Impl::refuse_page(const HttpRequest& request, bool speaks_protocol) {
  if (request.target != "/ws") return error_reply(404, "not_found", "the WebSocket is at /ws");
  if (!api_->serves_host(request.host)) return error_reply(421, "host", "this server has another name");
  if (!same_origin(request.origin, request.host))
    return error_reply(403, "origin", "the request comes from another site");
  if (!speaks_protocol) return error_reply(400, "protocol", "the sub-protocol is cell.v1");
  if (pages_.size() >= settings_.max_clients) return error_reply(503, "busy", "too many pages are open");
  return std::nullopt;
}

void Server::Impl::open_page(beast::tcp_stream&& stream, http::request<http::string_body> request) {
  auto page = std::make_shared<Page>(*this, io_, settings_, std::move(stream));
  pages_.insert(page);
  page->open(std::move(request));
  const std::lock_guard lock(statistics_mutex_);
  statistics_.clients = pages_.size();
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

bool Server::Impl::may_view(const Page& asking) {
  std::size_t viewers = 0;
  for (const auto& page : pages_) viewers += page.get() != &asking && page->views() ? 1 : 0;
  return viewers < settings_.max_video_clients;
}

void Server::Impl::page_left(const std::shared_ptr<Page>& page) {
  if (pages_.erase(page) == 0) return;
  const std::lock_guard lock(statistics_mutex_);
  statistics_.clients = pages_.size();
  statistics_.frames_replaced += page->queue().frames_replaced();
}

void Server::Impl::count(std::uint64_t Statistics::* what) {
  const std::lock_guard lock(statistics_mutex_);
  ++(statistics_.*what);
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
