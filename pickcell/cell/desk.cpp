#include "pickcell/cell/desk.hpp"

#include <utility>

namespace pickcell::cell {

Snapshot Desk::snapshot() const {
  const std::lock_guard lock(mutex_);
  return snapshot_;
}

std::shared_ptr<const ShownFrame> Desk::frame() const {
  const std::lock_guard lock(mutex_);
  return frame_;
}

int Desk::listen(std::function<void()> listener) {
  const std::lock_guard lock(listeners_mutex_);
  listeners_.emplace(next_handle_, std::move(listener));
  return next_handle_++;
}

void Desk::remove(int handle) {
  const std::lock_guard lock(listeners_mutex_);
  listeners_.erase(handle);
}

void Desk::publish(Snapshot snapshot) {
  {
    const std::lock_guard lock(mutex_);
    snapshot.revision = snapshot_.revision + 1;
    snapshot_ = std::move(snapshot);
  }
  tell();
}

void Desk::publish(std::shared_ptr<const ShownFrame> frame) {
  {
    const std::lock_guard lock(mutex_);
    frame_ = std::move(frame);
  }
  tell();
}

void Desk::tell() {
  published_.notify_all();
  const std::lock_guard lock(listeners_mutex_);
  for (const auto& [handle, listener] : listeners_) listener();
}

void Desk::ask(Command command) {
  const std::lock_guard lock(mutex_);
  const auto asked = [this](Command c) -> bool& { return asked_[static_cast<std::size_t>(c)]; };
  // The newer wish counts: a Stop right behind a Start takes it back, and the other way round.
  if (command == Command::stop) asked(Command::start) = false;
  if (command == Command::start) asked(Command::stop) = false;
  asked(command) = true;
}

bool Desk::take(Command command) {
  const std::lock_guard lock(mutex_);
  return std::exchange(asked_[static_cast<std::size_t>(command)], false);
}

bool Desk::asked(Command command) const {
  const std::lock_guard lock(mutex_);
  return asked_[static_cast<std::size_t>(command)];
}

void Desk::wait_until(const std::function<bool(const Snapshot&)>& condition) const {
  std::unique_lock lock(mutex_);
  published_.wait(lock, [&] { return condition(snapshot_); });
}

}  // namespace pickcell::cell
