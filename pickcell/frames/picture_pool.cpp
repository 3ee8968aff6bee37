#include "pickcell/frames/picture_pool.hpp"

#include <array>
#include <mutex>
#include <new>
#include <utility>
#include <vector>

namespace pickcell::frames {

namespace {

/// Room for the control block of a shared_ptr; larger ones go to the heap.
constexpr std::size_t kControlBytes = 128;

struct Slot {
  image::Image picture;
  alignas(std::max_align_t) std::array<std::byte, kControlBytes> control{};
};

}  // namespace

struct PicturePool::State {
  explicit State(std::size_t most) : kept(most) { free.reserve(most); }

  std::unique_ptr<Slot> take() {
    const std::lock_guard lock(mutex);
    if (free.empty()) {
      ++made;
      return std::make_unique<Slot>();
    }
    auto slot = std::move(free.back());
    free.pop_back();
    return slot;
  }
  void give_back(std::unique_ptr<Slot> slot) {
    const std::lock_guard lock(mutex);
    if (free.size() < kept)
      free.push_back(std::move(slot));
    else
      --made;
  }

  const std::size_t kept;
  std::mutex mutex;
  std::vector<std::unique_ptr<Slot>> free;
  std::size_t made = 0;
};

namespace {

/// Puts the shared_ptr's control block into the slot. The block is the last thing to go, after the picture's deleter
/// ran, so it is the allocator that returns the slot to the pool.
template <class T, class State>
struct SlotAllocator {
  using value_type = T;
  std::shared_ptr<State> pool;
  Slot* slot;

  SlotAllocator(std::shared_ptr<State> p, Slot* s) : pool(std::move(p)), slot(s) {}
  template <class U>
  SlotAllocator(const SlotAllocator<U, State>& other)  // NOLINT(google-explicit-constructor)
      : pool(other.pool), slot(other.slot) {}

  T* allocate(std::size_t n) {
    if (n * sizeof(T) > kControlBytes) return static_cast<T*>(::operator new(n * sizeof(T)));
    return reinterpret_cast<T*>(slot->control.data());
  }
  void deallocate(T* at, std::size_t n) {
    if (n * sizeof(T) > kControlBytes) ::operator delete(at);
    pool->give_back(std::unique_ptr<Slot>(slot));
  }
  template <class U>
  bool operator==(const SlotAllocator<U, State>& other) const {
    return slot == other.slot;
  }
};

}  // namespace

PicturePool::PicturePool(std::size_t kept) : state_(std::make_shared<State>(kept)) {}

std::shared_ptr<image::Image> PicturePool::take() {
  Slot* slot = state_->take().release();
  return std::shared_ptr<image::Image>(
      &slot->picture, [](image::Image*) {}, SlotAllocator<image::Image, State>(state_, slot));
}

std::size_t PicturePool::made() const {
  const std::lock_guard lock(state_->mutex);
  return state_->made;
}

}  // namespace pickcell::frames
