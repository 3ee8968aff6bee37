#pragma once
/// Remembers what was answered under an Idempotency-Key, so that a retry never acts twice.

#include <deque>
#include <map>
#include <optional>
#include <string>
#include <string_view>

#include "pickcell/server/adaptive_video.hpp"
#include "pickcell/server/http.hpp"

namespace pickcell::server {

/// 16 to 64 characters of 0-9 A-Z a-z - _ : room for 128 bits, nothing that could hide in a log.
[[nodiscard]] bool well_formed_key(std::string_view key);

class IdempotencyStore {
 public:
  static constexpr WallDuration kKept = std::chrono::minutes(10);
  static constexpr std::size_t kLimit = 1024;  ///< the oldest goes first

  /// The reply given under this key, or nothing.
  [[nodiscard]] const HttpReply* find(const std::string& key, const std::string& target, WallTime now);
  /// The key was used for another target.
  [[nodiscard]] bool conflicts(const std::string& key, const std::string& target, WallTime now);
  void keep(const std::string& key, const std::string& target, HttpReply reply, WallTime now);
  [[nodiscard]] std::size_t size() const { return replies_.size(); }

 private:
  struct Kept {
    std::string target;
    HttpReply reply;
  };
  struct Age {
    WallTime since;
    std::string key;
  };
  void forget_old(WallTime now);
  std::map<std::string, Kept> replies_;
  std::deque<Age> ages_;
};

}  // namespace pickcell::server
