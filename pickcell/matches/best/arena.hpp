#pragma once
/// Memory for what lives no longer than one search.

#include <cstddef>
#include <memory>
#include <memory_resource>
#include <vector>

namespace pickcell::matches {

/// Hands out pieces of one block, one after the other, and takes none back before reset(). What does not fit comes from
/// the heap; reset() then makes the block large enough, so that a search like the last one needs the heap no more. Not
/// thread-safe.
class Arena final : public std::pmr::memory_resource {
 public:
  /// Everything handed out becomes free; nothing of it may be in use.
  void reset();

 private:
  void* do_allocate(std::size_t bytes, std::size_t alignment) override;
  void do_deallocate(void* piece, std::size_t bytes, std::size_t alignment) override;
  [[nodiscard]] bool do_is_equal(const std::pmr::memory_resource& other) const noexcept override {
    return this == &other;
  }

  std::unique_ptr<std::byte[]> block_;
  std::size_t size_ = 0;
  std::size_t used_ = 0;    ///< of the block
  std::size_t wanted_ = 0;  ///< in all since reset()
  std::vector<std::unique_ptr<std::byte[]>> beside_;
};

}  // namespace pickcell::matches
