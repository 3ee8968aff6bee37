#pragma once
/// The last messages of a link, for whoever has to understand an error.

#include <cstddef>
#include <deque>
#include <string>
#include <utility>

#include "pickcell/core/result.hpp"

namespace pickcell::robot {

class Trail {
 public:
  void add(std::string message) {
    constexpr std::size_t kLength = 8;
    if (messages_.size() == kLength) messages_.pop_front();
    messages_.push_back(std::move(message));
  }
  void clear() { messages_.clear(); }
  /// The error with the messages, oldest first, unless it has some already.
  [[nodiscard]] core::Error onto(core::Error error) const {
    if (error.trail.empty()) error.trail.assign(messages_.begin(), messages_.end());
    return error;
  }

 private:
  std::deque<std::string> messages_;
};

}  // namespace pickcell::robot
