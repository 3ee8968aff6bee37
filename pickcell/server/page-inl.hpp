#pragma once
/// One open page of the HMI: its WebSocket and what waits for it. A piece of server.cpp, which alone reads it.

#include <utility>  // Boost 1.74's awaitable.hpp needs it and does not include it

#include <boost/asio/io_context.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/websocket.hpp>
#include <memory>
#include <optional>
#include <string>

#include "pickcell/core/log.hpp"
#include "pickcell/server/client_message.hpp"
#include "pickcell/server/client_queue.hpp"
#include "pickcell/server/frame_encoder.hpp"
#include "pickcell/server/log_tail.hpp"
#include "pickcell/server/messages.hpp"
#include "pickcell/server/publisher.hpp"
#include "pickcell/server/server.hpp"

namespace pickcell::server {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = beast::http;
namespace websocket = beast::websocket;
using beast::error_code;

constexpr std::size_t kMaxMessageBytes = 64 << 10;
constexpr auto kHandshakeDeadline = std::chrono::seconds(5);  // to open and to close a WebSocket

inline std::int64_t unix_us_now() {
  using namespace std::chrono;
  return duration_cast<microseconds>(system_clock::now().time_since_epoch()).count();
}

inline WallTime now() { return std::chrono::steady_clock::now(); }

class Page;

/// What a page asks of the server that holds it. All in the server's thread.
class PageHost {
 public:
  virtual ~PageHost() = default;
  virtual FrameEncoder& encoder() = 0;
  virtual Publisher& publisher() = 0;
  virtual const LogTail& log() = 0;
  virtual const ShownFramePtr& newest() = 0;
  virtual bool may_view(const Page& asking) = 0;
  virtual void page_left(const std::shared_ptr<Page>& page) = 0;
  virtual void count(std::uint64_t Server::Statistics::* what) = 0;
};

/// One open page: what waits for it is in its queue, this only carries it out.
class Page : public std::enable_shared_from_this<Page> {
 public:
  Page(PageHost& host, asio::io_context& io, const ServerSettings& settings, beast::tcp_stream&& stream)
      : host_(host),
        socket_(std::move(stream)),
        timer_(io),
        queue_(settings.queue),
        rate_(settings.max_messages_per_s) {}

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
      if (e || self->closing_) return self->leave();
      self->open_ = true;
      self->queue_.mark(Topic::hello);
      self->queue_.mark(Topic::snap);
      self->read();
      self->pump();
    });
  }

  ClientQueue& queue() { return queue_; }
  [[nodiscard]] bool views() const { return queue_.video().has_value(); }
  [[nodiscard]] bool wants_log() const { return wants_log_; }

  /// Writes the next message unless one is being written. Until the WebSocket is open its own reply may be: what comes
  /// waits for that.
  void pump() {
    if (!open_ || closing_) return;
    const Outgoing out = queue_.next(now());
    if (out.empty()) return arm_timer();
    if (out.frame) {
      host_.count(&Server::Statistics::frames_sent);
      bytes_ = host_.encoder().message(out.frame->shown, out.frame->max_width_px, out.frame->quality);
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
    if (!open_) return cut(why);
    if (std::exchange(closing_, true)) return;
    core::log(core::LogLevel::warning, "server", std::string("a page was closed: ") + why);
    socket_.async_close(websocket::close_reason(code, why), [self = shared_from_this()](error_code) { self->leave(); });
  }

  /// At once, without a word: for clients that take none.
  void cut(const char* why) {
    closing_ = true;
    if (*why != '\0') {
      core::log(core::LogLevel::warning, "server", std::string("a page was cut off: ") + why);
      host_.count(&Server::Statistics::clients_cut);
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
    if (!views() && !host_.may_view(*this)) {
      no_video_why_ = "too many pages show the picture";
      return queue_.mark(Topic::video);
    }
    queue_.subscribe(*wish.video);
    queue_.offer(host_.newest());
  }

  std::string compose(Topic topic) {
    switch (topic) {
      case Topic::hello:
        return host_.publisher().hello(unix_us_now());
      case Topic::snap:
        return host_.publisher().snap(told_, host_.log());
      case Topic::video:
        return Publisher::no_video(no_video_why_);
      case Topic::state:
        return host_.publisher().state(told_);
      case Topic::log:
        return wants_log_ ? host_.publisher().log(told_, host_.log()) : std::string();
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
    host_.page_left(shared_from_this());
  }

  PageHost& host_;  ///< runs until the last page is gone
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
  bool open_ = false;  ///< the handshake is done
  bool closing_ = false;
};

}  // namespace pickcell::server
