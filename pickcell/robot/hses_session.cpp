#include "pickcell/robot/hses_session.hpp"

#include <poll.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <utility>

#include "pickcell/robot/controller_fault.hpp"

namespace pickcell::robot {

using core::ErrorCode;

namespace {

constexpr std::uint16_t kBusyExclusive = 0xD8FA, kBusyOther = 0xD8F1, kTooManyRequests = 0xFFF6;

void pause(std::chrono::milliseconds time) { (void)::poll(nullptr, 0, static_cast<int>(time.count())); }

bool busy(const HsesAnswer& answer) {
  return answer.status != 0 && (answer.added_status == kBusyExclusive || answer.added_status == kBusyOther ||
                                answer.added_status == kTooManyRequests);
}

std::string hex(unsigned value, int digits) {
  std::array<char, 16> text{};
  (void)std::snprintf(text.data(), text.size(), "%0*X", digits, value);
  return text.data();
}

std::string words(const HsesRequest& r) {
  return "> " + std::to_string(r.id) + ": " + hex(r.command, 2) + '/' + std::to_string(r.instance) + '/' +
         std::to_string(r.attribute) + " service " + hex(static_cast<unsigned>(r.service), 2) + ", " +
         std::to_string(r.payload.size()) + " bytes" + (r.block != 0 ? ", block " + hex(r.block, 8) : "");
}

std::string words(const HsesAnswer& a) {
  return "< " + std::to_string(a.id) + ": status " + hex(a.status, 2) + ' ' + hex(a.added_status, 4) + ", " +
         std::to_string(a.payload.size()) + " bytes" + (a.block != kHsesLastBlock ? ", block " + hex(a.block, 8) : "");
}

/// What a status says by itself; only 1F is certain to come with an added status.
std::string meaning_of(std::uint8_t status) {
  switch (status) {
    case 0x08:
      return ": the controller does not know the command";
    case 0x09:
      return ": no such element";
    case 0x28:
      return ": no such number";
    default:
      return "";
  }
}

}  // namespace

HsesSession::HsesSession(std::string host, int port, std::chrono::milliseconds timeout, int tries,
                         std::chrono::milliseconds busy_pause)
    : host_(std::move(host)), port_(port), timeout_(timeout), tries_(std::max(tries, 1)), busy_pause_(busy_pause) {}

std::string HsesSession::peer() const { return host_ + ':' + std::to_string(port_); }

core::Status HsesSession::open() {
  trail_.clear();
  link_.reset();
  auto link = DatagramLink::open(host_, port_);
  if (!link) return core::forward(link);
  link_ = std::move(*link);
  return {};
}

/// The answer that belongs to the request; whatever else arrives is dropped.
core::Result<HsesAnswer> HsesSession::await(const HsesRequest& request, WallDeadline deadline) {
  std::array<std::uint8_t, kHsesHeaderBytes + kHsesMostPayload + 1> buffer;
  for (;;) {
    auto size = link_->receive(buffer, deadline);
    if (!size) return core::forward(size);
    const core::Status early = in_time(peer(), deadline);  // of use when this is no answer
    auto answer = parse_hses_answer(HsesView(buffer).first(*size));
    if (!answer) {
      trail_.add("< dropped: " + answer.error().why);
      if (!early) return tl::unexpected(early.error());
      continue;
    }
    if (answer->id == request.id && answer->service == request.service && answer->division == request.division) {
      trail_.add(words(*answer));
      return answer;
    }
    trail_.add(words(*answer) + ", dropped: another request's");
    if (!early) return tl::unexpected(early.error());
  }
}

core::Result<HsesAnswer> HsesSession::exchange(HsesRequest& request) {
  request.id = next_id_++;
  link_->drain();
  trail_.add(words(request));
  if (auto sent = link_->send(hses_bytes(request)); !sent) return core::forward(sent);
  return await(request, from_now(timeout_));
}

core::Error HsesSession::refusal(const std::string& what, const HsesAnswer& answer) const {
  core::Error error{ErrorCode::refused, peer() + ' ' + what, {}, {}, {}};
  if (answer.added_status != 0) {
    const ControllerFault fault = controller_fault(answer.added_status);
    error.why = "refused with " + hex(answer.added_status, 4) + ": " + std::string(fault.meaning);
    error.remedy = fault.remedy;
  } else {
    error.why = "refused with status " + hex(answer.status, 2) + meaning_of(answer.status);
    error.remedy = "see the message on the pendant";
  }
  return error;
}

core::Result<HsesAnswer> HsesSession::ask(HsesRequest request, Repeat repeat, const std::string& what) {
  if (!link_) return core::failure(ErrorCode::link, peer(), "not connected", "connect first");
  const int tries = repeat == Repeat::yes ? tries_ : 1;
  for (int attempt = 1;; ++attempt) {
    auto answer = exchange(request);
    if (answer && answer->status == 0) return answer;
    const bool silent = !answer && answer.error().code == ErrorCode::timeout;
    if (attempt < tries && (silent || (answer && busy(*answer)))) {
      if (!silent) pause(busy_pause_);
      continue;
    }
    if (answer) return tl::unexpected(with_trail(refusal(what, *answer)));
    link_.reset();  // lost until it is opened again
    answer.error().what += ' ' + what;
    if (repeat == Repeat::no) answer.error().why += "; whether it was done is not known";
    return tl::unexpected(with_trail(std::move(answer.error())));
  }
}

core::Status HsesSession::tell(HsesRequest request, Repeat repeat, const std::string& what) {
  auto answer = ask(std::move(request), repeat, what);
  if (!answer) return core::forward(answer);
  return {};
}

core::Status HsesSession::send_only(HsesRequest request) {
  if (!link_) return core::failure(ErrorCode::link, peer(), "not connected", "connect first");
  request.id = next_id_++;
  trail_.add(words(request));
  return link_->send(hses_bytes(request));
}

}  // namespace pickcell::robot
