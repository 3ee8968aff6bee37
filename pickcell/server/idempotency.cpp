#include "pickcell/server/idempotency.hpp"

#include <algorithm>
#include <utility>

namespace pickcell::server {

bool well_formed_key(std::string_view key) {
  const auto plain = [](char c) {
    return (c >= '0' && c <= '9') || (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z') || c == '-' || c == '_';
  };
  return key.size() >= 16 && key.size() <= 64 && std::all_of(key.begin(), key.end(), plain);
}

const HttpReply* IdempotencyStore::find(const std::string& key, const std::string& target, WallTime now) {
  forget_old(now);
  const auto found = replies_.find(key);
  return found != replies_.end() && found->second.target == target ? &found->second.reply : nullptr;
}

bool IdempotencyStore::conflicts(const std::string& key, const std::string& target, WallTime now) {
  forget_old(now);
  const auto found = replies_.find(key);
  return found != replies_.end() && found->second.target != target;
}

void IdempotencyStore::keep(const std::string& key, const std::string& target, HttpReply reply, WallTime now) {
  if (!replies_.emplace(key, Kept{target, std::move(reply)}).second) return;
  ages_.push_back(Age{now, key});
  forget_old(now);
}

void IdempotencyStore::forget_old(WallTime now) {
  while (!ages_.empty() && (ages_.size() > kLimit || now - ages_.front().since > kKept)) {
    replies_.erase(ages_.front().key);
    ages_.pop_front();
  }
}

}  // namespace pickcell::server
