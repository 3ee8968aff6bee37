/// A search like the last one takes nothing from the heap. The operators here count for the whole test program.

#include <gtest/gtest.h>

#include <cstdlib>
#include <new>

#include "pickcell/matches/best/arena.hpp"
#include "pickcell/matches/best/engine.hpp"
#include "pickcell/matches/test_scenes.hpp"

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define PICKCELL_COUNTS_ALLOCATIONS 0
#else
#define PICKCELL_COUNTS_ALLOCATIONS 1
#endif

namespace {
thread_local long allocations = 0;  // of the calling thread

[[maybe_unused]] void* counted(std::size_t bytes, std::size_t alignment) {
  ++allocations;
  const std::size_t whole = (bytes + alignment - 1) / alignment * alignment;  // as aligned_alloc wants it
  if (void* p = std::aligned_alloc(alignment, whole)) return p;
  throw std::bad_alloc();
}
}  // namespace

#if PICKCELL_COUNTS_ALLOCATIONS
void* operator new(std::size_t bytes) { return counted(bytes, alignof(std::max_align_t)); }
void* operator new(std::size_t bytes, std::align_val_t alignment) {
  return counted(bytes, static_cast<std::size_t>(alignment));
}
void operator delete(void* p) noexcept { std::free(p); }
void operator delete(void* p, std::size_t) noexcept { std::free(p); }
void operator delete(void* p, std::align_val_t) noexcept { std::free(p); }
void operator delete(void* p, std::size_t, std::align_val_t) noexcept { std::free(p); }
#endif

namespace pickcell::matches {
namespace {

using testing::Texture;

TEST(Arena, ServesTheNextSearchFromOneBlock) {
  Arena arena;
  const auto search = [&] {
    arena.reset();
    std::pmr::vector<double> list(&arena);
    for (int i = 0; i < 1000; ++i) list.push_back(i);
    std::pmr::vector<char> other(77, 'x', &arena);
    EXPECT_EQ(list[999], 999);
    EXPECT_EQ(reinterpret_cast<std::uintptr_t>(list.data()) % alignof(double), 0u);
  };
  search();
  search();
  const long before = allocations;
  search();
  EXPECT_EQ(allocations, before);
}

/// Several parts of two models, one part, one that is not there (all passes run): each call like the one before.
TEST(BestSearch, TakesNothingFromTheHeapInTheSteadyState) {
  if (!PICKCELL_COUNTS_ALLOCATIONS) GTEST_SKIP() << "a sanitizer owns the heap";
  const Texture first_texture(70, 54, 2), second_texture(60, 60, 9), other_texture(64, 64, 77);
  const Model first = testing::texture_model(first_texture, 70, 54);
  const Model second = testing::texture_model(second_texture, 60, 60);
  const Model absent = testing::texture_model(other_texture, 64, 64);
  image::Image picture = testing::draw_ground(400, 260, 5);
  testing::draw_part(picture, first_texture, first, {80, 70, 20, 1.02});
  testing::draw_part(picture, first_texture, first, {230, 90, -130, 0.95});
  testing::draw_part(picture, second_texture, second, {240, 190, 10, 1});
  testing::add_noise(picture, 4, 1);
  image::Pyramid pyramid;
  pyramid.build(picture.view());

  const Model* both[] = {&first, &second};
  const Model* one[] = {&first};
  const Model* none[] = {&absent};
  struct Case {
    std::span<const Model* const> models;
    int most;
    bool explain;
  };
  for (const Case& c : {Case{both, 20, false}, Case{one, 1, false}, Case{none, 1, false}, Case{both, 20, true}}) {
    BestEngine engine;
    SearchOptions options;
    options.max_matches = c.most;
    options.explain = c.explain;
    FindResult result;
    for (int call = 0; call < 4; ++call) {
      const long before = allocations;
      pyramid.build(picture.view());
      ASSERT_TRUE(engine.find_into(pyramid, c.models, options, result));
      const long taken = allocations - before;
      if (call >= 2) {
        EXPECT_EQ(taken, 0) << c.models.size() << " models, explain " << c.explain << ", call " << call;
      }
    }
    EXPECT_EQ(result.matches.size(), c.most > 1 ? 3u : c.models[0] == &first ? 1u : 0u);
  }
}

}  // namespace
}  // namespace pickcell::matches
