#pragma once
/// What the pages were told and what has changed since: composes the texts of the WebSocket. One thread at a time.

#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "pickcell/cell/cell_port.hpp"
#include "pickcell/core/json.hpp"
#include "pickcell/server/log_tail.hpp"

namespace pickcell::server {

/// How far one page has been told.
struct Told {
  std::uint64_t state_rev = 0;
  std::shared_ptr<const core::Json> state;
  std::uint64_t log_number = 0;
};

/// Revisions count published changes per class. A `state` message carries the changed keys, its `rev` and the `base`
/// they are relative to; an `alarm` message carries one row and its `rev` without gaps. A page whose revision is not
/// the base asks for a resync.
class Publisher {
 public:
  explicit Publisher(std::string build) : build_(std::move(build)) {}

  struct Change {
    bool state = false;
    std::vector<std::string> alarm_texts;  ///< one message per changed row, in order
  };
  [[nodiscard]] Change update(const cell::Snapshot& snapshot);

  [[nodiscard]] std::string hello(std::int64_t unix_us) const;
  /// Everything; the page is then up to date.
  [[nodiscard]] std::string snap(Told& told, const LogTail& log) const;
  /// The keys that changed since the page was told; empty when none did.
  [[nodiscard]] std::string state(Told& told) const;
  /// New log lines; empty when there are none.
  [[nodiscard]] std::string log(Told& told, const LogTail& log) const;
  [[nodiscard]] static std::string heartbeat(std::int64_t unix_us);
  /// {"type":"video","on":false,"why"}: the subscription ended or was not granted.
  [[nodiscard]] static std::string no_video(const std::string& why);

  /// The snap as a value, for GET /api/v1/state.
  [[nodiscard]] core::Json snap_json() const;

 private:
  std::string build_;
  std::shared_ptr<const core::Json> state_ = std::make_shared<const core::Json>(core::Json::object());
  std::uint64_t state_rev_ = 0;
  std::map<std::string, core::Json> alarms_;
  core::Json::Array alarm_rows_;
  std::uint64_t alarm_rev_ = 0;
};

}  // namespace pickcell::server
