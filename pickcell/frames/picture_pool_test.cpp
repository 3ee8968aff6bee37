#include "pickcell/frames/picture_pool.hpp"

#include <gtest/gtest.h>

#include <thread>
#include <vector>

namespace pickcell::frames {
namespace {

TEST(PicturePool, UsesPicturesAgainAndNeverTwiceAtOnce) {
  PicturePool pool;
  auto a = pool.take(), b = pool.take();
  EXPECT_NE(a.get(), b.get());
  a->resize(64, 48);
  const auto* memory = a->row(0);
  a.reset();
  const auto again = pool.take();
  again->resize(64, 48);
  EXPECT_EQ(again->row(0), memory);
  EXPECT_EQ(pool.made(), 2u);
}

TEST(PicturePool, KeepsNoMoreThanItShould) {
  PicturePool pool(2);
  std::vector<std::shared_ptr<const image::Image>> held;
  for (int i = 0; i < 10; ++i) held.push_back(pool.take());
  EXPECT_EQ(pool.made(), 10u);
  held.clear();
  EXPECT_EQ(pool.made(), 2u);
}

TEST(PicturePool, FramesOutliveIt) {
  std::shared_ptr<const image::Image> frame;
  {
    PicturePool pool;
    auto picture = pool.take();
    picture->resize(8, 8);
    picture->fill(7);
    frame = std::move(picture);
  }
  EXPECT_EQ(frame->at(7, 7), 7);
}

TEST(PicturePool, ManyThreadsMayDropPictures) {
  PicturePool pool;
  std::vector<std::thread> threads;
  for (int t = 0; t < 3; ++t)
    threads.emplace_back([&pool] {
      for (int i = 0; i < 2000; ++i) {
        const auto picture = pool.take();
        picture->resize(16, 16);
        const std::shared_ptr<const image::Image> copy = picture;
      }
    });
  for (auto& thread : threads) thread.join();
  EXPECT_LE(pool.made(), 8u);
}

}  // namespace
}  // namespace pickcell::frames
