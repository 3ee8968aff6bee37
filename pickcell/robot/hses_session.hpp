#pragma once
/// One request, one answer with a High Speed Ethernet Server: matching, repeating, refusals. The control port and the
/// file port each have a session. Source: docs/yaskawa-protocols.md 2.1, 2.7, 2.8.

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>

#include "pickcell/core/result.hpp"
#include "pickcell/robot/datagram_link.hpp"
#include "pickcell/robot/hses_frame_codec.hpp"
#include "pickcell/robot/trail.hpp"

namespace pickcell::robot {

struct HsesSettings {
  std::string host;
  int port = 10040;                              ///< of robot control; files are on the next one
  std::chrono::milliseconds timeout{300};        ///< for the answer to one datagram
  int tries = 3;                                 ///< of what may be repeated
  std::chrono::milliseconds busy_pause{20};      ///< between tries when the controller says that it is busy
  std::chrono::milliseconds file_timeout{2000};  ///< for an answer of the file service
};

/// One thread at a time. Errors: link, timeout, refused with the controller's number and its meaning; every error
/// carries the last requests and answers.
///
/// Answers are matched by request id, service and division; anything else (duplicates, late answers, strangers) is
/// dropped. What may be repeated is sent again when no answer comes or the controller is busy; everything else is sent
/// exactly once. After an unanswered request the session is closed until open().
class HsesSession {
 public:
  enum class Repeat { no, yes };

  HsesSession(std::string host, int port, std::chrono::milliseconds timeout, int tries,
              std::chrono::milliseconds busy_pause);

  /// Opens the socket; nothing is sent yet.
  [[nodiscard]] core::Status open();
  void close() { link_.reset(); }
  [[nodiscard]] bool is_open() const { return link_.has_value(); }
  /// host:port
  [[nodiscard]] std::string peer() const;

  /// The answer; its status is 0.
  [[nodiscard]] core::Result<HsesAnswer> ask(HsesRequest request, Repeat repeat, const std::string& what);
  [[nodiscard]] core::Status tell(HsesRequest request, Repeat repeat, const std::string& what);
  /// A read, repeated where its answer is lost, whose payload the parser understands.
  template <class Parse>
  [[nodiscard]] auto read(HsesRequest request, const std::string& what, Parse parse) -> decltype(parse(HsesView{})) {
    auto answer = ask(std::move(request), Repeat::yes, what);
    if (!answer) return core::forward(answer);
    auto value = parse(HsesView(answer->payload));
    if (value) return value;
    return tl::unexpected(trail_.onto(std::move(value.error())));
  }
  /// Sends what gets no answer: the acknowledgement of a file's last block.
  [[nodiscard]] core::Status send_only(HsesRequest request);
  [[nodiscard]] core::Error with_trail(core::Error error) const { return trail_.onto(std::move(error)); }

 private:
  [[nodiscard]] core::Result<HsesAnswer> exchange(HsesRequest& request);
  [[nodiscard]] core::Result<HsesAnswer> await(const HsesRequest& request, WallDeadline deadline);
  [[nodiscard]] core::Error refusal(const std::string& what, const HsesAnswer& answer) const;

  std::string host_;
  int port_;
  std::chrono::milliseconds timeout_;
  int tries_;
  std::chrono::milliseconds busy_pause_;
  std::optional<DatagramLink> link_;
  std::uint8_t next_id_ = 0;
  Trail trail_;
};

}  // namespace pickcell::robot
