#include "pickcell/matches/best/arena.hpp"

#include <new>

namespace pickcell::matches {
namespace {

constexpr std::size_t kRound = alignof(std::max_align_t);

std::size_t rounded(std::size_t bytes) { return (bytes + kRound - 1) / kRound * kRound; }

}  // namespace

void Arena::reset() {
  if (!beside_.empty()) {
    beside_.clear();
    size_ = wanted_ + wanted_ / 2;
    block_ = std::make_unique<std::byte[]>(size_);
  }
  used_ = wanted_ = 0;
}

void* Arena::do_allocate(std::size_t bytes, std::size_t alignment) {
  if (alignment > kRound) throw std::bad_alloc();  // nothing in a search is aligned further
  const std::size_t need = rounded(bytes);
  wanted_ += need;
  if (need <= size_ - used_) {
    std::byte* const piece = block_.get() + used_;
    used_ += need;
    return piece;
  }
  beside_.push_back(std::make_unique<std::byte[]>(need));
  return beside_.back().get();
}

void Arena::do_deallocate(void* piece, std::size_t bytes, std::size_t) {
  const std::size_t need = rounded(bytes);
  if (size_ > 0 && used_ >= need && piece == block_.get() + (used_ - need)) used_ -= need;  // the last one
}

}  // namespace pickcell::matches
